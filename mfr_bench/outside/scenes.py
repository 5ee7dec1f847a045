"""The scenes that a package or folder from outside declares: a SCENE in the module of the function that makes it."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace
from types import ModuleType

from ..methods.loading import line_of
from ..methods.spec.maker import Maker, Number

GIVEN = ("size", "seed")  # to every function that makes a scene


def declared(modules: Iterable[ModuleType], place: str, mistakes: list[str]) -> Iterator[tuple[str, Maker]]:
    """The scenes of modules that have a SCENE, by the modules' names; each mistake costs the scene that has it."""
    for module in modules:
        name = module.__name__.rpartition(".")[2]
        if mistake := next(_mistakes(module, name), None):
            mistakes.append(f"{line_of(module, 'SCENE')}: {mistake}")
        else:
            yield name, replace(module.SCENE, place=place)


def _mistakes(module: ModuleType, name: str) -> Iterator[str]:
    """The reasons why a scene cannot be made."""
    maker = module.SCENE
    if not isinstance(maker, Maker):
        yield f"SCENE is a {type(maker).__name__}; allowed: SCENE = Maker(...)"
        return
    if hasattr(module, "__path__"):
        yield "SCENE of a whole package; allowed: in a file of its own, which has the scene's name"
    if not callable(getattr(module, "fragments", None)):
        yield f"scene {name} has no fragments; allowed: def fragments(size, seed, ...), which gives arrays by name"
    for key, number in maker.keys.items():
        if not str(key).isidentifier() or key in GIVEN:
            yield f"scene {name} has the key {key!r}; allowed: a name other than {' and '.join(GIVEN)}"
        elif not (isinstance(number, Number) and number.least <= number.default <= number.most):
            yield f"scene {name}: {key} is {number!r}; allowed: Number(default, least, most), the default between"
