"""The effects that a package or folder from outside declares: an EFFECT in the module of its model, and its GLSL."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import fields, replace
from types import ModuleType
from typing import get_args, get_type_hints

from ..effects import Effect, Settings
from ..errors import ShaderError
from ..glsl import includes
from ..glsl.code import code_of
from ..methods.loading import line_of

FUNCTIONS = ("effect_begin", "effect_add", "effect_end")  # of the GLSL of an effect
KEYS = tuple(key.name for key in fields(Settings) if key.name not in ("name", "msaa", "coverage"))
NEEDS = get_args(get_type_hints(Effect)["needs"])


def declared(modules: Iterable[ModuleType], place: str, mistakes: list[str]) -> Iterator[tuple[str, Effect]]:
    """The effects of modules that have an EFFECT, by the modules' names; each mistake costs the effect that has it."""
    for module in modules:
        name = module.__name__.rpartition(".")[2]
        if mistake := next(_mistakes(module, name), None):
            mistakes.append(f"{line_of(module, 'EFFECT')}: {mistake}")
        else:
            yield name, replace(module.EFFECT, place=place)


def _mistakes(module: ModuleType, name: str) -> Iterator[str]:
    """The reasons why an effect cannot be drawn or checked."""
    effect = module.EFFECT
    if not isinstance(effect, Effect):
        yield f"EFFECT is a {type(effect).__name__}; allowed: EFFECT = Effect(...)"
        return
    if hasattr(module, "__path__"):
        yield "EFFECT of a whole package; allowed: in a file of its own, which has the effect's name"
    if not callable(getattr(module, "model", None)):
        yield f"effect {name} has no model; allowed: def model(rays, settings), which gives float64 (pixels, 4)"
    if not isinstance(effect.what, str) or effect.needs not in NEEDS:
        yield f"effect {name} needs {effect.needs!r}; allowed: what in words, and needs {' | '.join(NEEDS)}"
    if not isinstance(effect.keys, tuple) or not set(effect.keys) <= set(KEYS):
        yield f"effect {name} reads the keys {effect.keys!r}; allowed: a tuple of {', '.join(KEYS)}"
    yield from _mistakes_of_glsl(name)


def _mistakes_of_glsl(name: str) -> Iterator[str]:
    path = f"effects/{Settings(name).module}.glsl"
    try:
        text, _ = includes.expand(path, {})
    except ShaderError as error:
        yield f"effect {name}: {error}"
        return
    for function in FUNCTIONS:
        if not re.search(rf"\b{function}\s*\(", code_of(text)):
            yield f"effect {name}: {path} has no {function}; allowed: {', '.join(FUNCTIONS)}"
