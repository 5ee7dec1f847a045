"""The scenes that a package or folder from outside declares: a SCENE in the module of the function that makes it."""

from __future__ import annotations

from collections.abc import Iterator

from ..methods.spec.maker import Maker, Number
from .entries import Declared

GIVEN = ("size", "seed")  # to every function that makes a scene


def _mistakes(maker: Maker, name: str) -> Iterator[str]:
    """The reasons why a scene cannot be made."""
    for key, number in maker.keys.items():
        if not str(key).isidentifier() or key in GIVEN:
            yield f"scene {name} has the key {key!r}; allowed: a name other than {' and '.join(GIVEN)}"
        elif not (isinstance(number, Number) and number.least <= number.default <= number.most):
            yield f"scene {name}: {key} is {number!r}; allowed: Number(default, least, most), the default between"


SCENES = Declared("SCENE", Maker, "scene", "fragments",
                  "fragments(size, seed, ...), which gives arrays by name", _mistakes)
