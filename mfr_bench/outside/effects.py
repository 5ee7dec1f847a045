"""The effects that a package or folder from outside declares: an EFFECT in the module of its model, and its GLSL."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import fields
from typing import get_args, get_type_hints

from ..effects import Case, Effect, Settings
from ..errors import ShaderError
from ..glsl import includes
from ..glsl.code import code_of
from .entries import Declared

FUNCTIONS = ("effect_begin", "effect_add", "effect_end")  # of the GLSL of an effect
KEYS = tuple(key.name for key in fields(Settings) if key.name not in ("name", "msaa", "coverage"))
NEEDS = get_args(get_type_hints(Effect)["needs"])


def _mistakes(effect: Effect, name: str) -> Iterator[str]:
    """The reasons why an effect cannot be drawn or checked."""
    if not isinstance(effect.what, str) or effect.needs not in NEEDS:
        yield f"effect {name} needs {effect.needs!r}; allowed: what in words, and needs {' | '.join(NEEDS)}"
    if not isinstance(effect.keys, tuple) or not set(effect.keys) <= set(KEYS):
        yield f"effect {name} reads the keys {effect.keys!r}; allowed: a tuple of {', '.join(KEYS)}"
    if not isinstance(effect.cases, tuple) or not all(isinstance(case, Case) for case in effect.cases):
        yield f"effect {name} has the cases {effect.cases!r}; allowed: a tuple of Case(fragments, shows)"
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


EFFECTS = Declared("EFFECT", Effect, "effect", "model",
                   "model(rays, settings), which gives float64 (pixels, 4)", _mistakes)
