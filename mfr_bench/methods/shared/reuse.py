"""REUSE_COUNT: what one frame of a scene counts stands for the frames that follow."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

from ..spec import Loop, Params, Pass, when
from .clearing import Expand, expanded


def once(*steps: Pass | Loop) -> tuple[Pass | Loop, ...]:
    """The steps with REUSE_COUNT as their parameter: with it on, only the first frame of a scene runs them.

    Later frames use what they left, so no later pass may change it, or a pass made by `again` restores it.
    """
    return tuple(replace(s, passes=once(*s.passes)) if isinstance(s, Loop)
                 else replace(s, expand=partial(_once, expand=s.expand)) for s in steps)


def _once(step: Pass, scope: Params, expand: Expand | None) -> tuple[Pass, ...]:
    static = False if scope.get("reuse_count") == "on" else None
    return tuple(replace(p, static=static) for p in expanded(step, scope, expand))


def again(name: str, shader: str, *writes: str, **more) -> Pass:
    """The pass that restores results of `once` which the previous frame has changed."""
    return Pass(name, "fullscreen", shader, writes=writes, static=True, when=when("reuse_count", "on"), **more)
