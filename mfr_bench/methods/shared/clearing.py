"""Passes that clear the image and the buffers of a method, and how a pass expands into those that run."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial

from ..spec import IMAGE, Params, Pass

Expand = Callable[[Pass, Params], tuple[Pass, ...]]

CLEARED = (0.0, 0.0, 0.0, 0.0)
CLEAR_IMAGE = Pass("clear", "clear", clears={IMAGE: CLEARED}, into=(IMAGE,))


def clear(*buffers: str, shared: tuple[str, ...] = (), **more) -> Pass:
    """A full-screen pass that gives the buffers their initial values.

    Each pixel clears its own elements; of the buffers `shared`, which belong to no pixel, it clears every P-th word.
    """
    step = Pass("clear", "fullscreen", "common/clear.frag", writes=(*shared, *buffers), **more)
    return replace(step, expand=partial(zeroed_apart, shared=shared)) if shared else step


def zeroed_apart(step: Pass, scope: Params, shared: tuple[str, ...]) -> tuple[Pass, ...]:
    """The full-screen clear; if `touched` leaves pixels out of it, the driver clears the buffers `shared` instead."""
    whole = scope.get("touched", "off") == "off"
    own = tuple(name for name in step.writes if whole or name not in shared)
    driver = () if whole else (Pass(step.name, "clear", writes=shared),)
    return (*driver, replace(step, writes=own, defines={**step.defines, "WHOLE": int(whole)}, expand=None))


def expanded(step: Pass, scope: Params, expand: Expand | None) -> tuple[Pass, ...]:
    """The passes that `expand` makes of the step; the step itself without one. Wrappers call it with the step's own."""
    return expand(step, scope) if expand else (replace(step, expand=None),)
