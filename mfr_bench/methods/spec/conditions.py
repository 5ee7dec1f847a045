"""The one condition that says whether a frame runs a pass, with its five reasons as data."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from .capacity import Plan
from .fitted import Fitted
from .passes import Pass


@dataclass(frozen=True)
class FrameState:
    """The state of a frame that is known before its first pass.

    plan: of a planned method. static: the frame before was of the same scene, and what it left is in place. probing:
    the frame is drawn to count fragments, outside any measurement.
    """

    plan: Plan | None = None
    static: bool = False
    probing: bool = False


# Each reason for which a pass may be left out, and what has to hold for it not to be.
REASONS: Mapping[str, Callable[[Pass, Fitted, FrameState], bool]] = {
    "parameters": lambda step, fitted, frame: step.when is None or step.when.holds(fitted.scope),
    "scene": lambda step, fitted, frame: fitted.needed(step),
    "plan": lambda step, fitted, frame: step.runs_in is None or (frame.plan is not None and step.runs_in(frame.plan)),
    "static frame": lambda step, fitted, frame: step.static is None or step.static == frame.static,
    "probe": lambda step, fitted, frame: not step.probes or frame.probing,
}


def left_out(step: Pass, fitted: Fitted, frame: FrameState) -> str | None:
    """The first reason for which a frame leaves the pass out, or None where it runs."""
    return next((reason for reason, holds in REASONS.items() if not holds(step, fitted, frame)), None)
