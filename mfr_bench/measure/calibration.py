"""Compares a device and its timer at the end of a run with what they were at its start."""

from __future__ import annotations

from collections.abc import Mapping
from statistics import median
from typing import Any

from ..stats import LONG_ENOUGH_MS

TOLERANCE = 0.15  # of the time that work of known size took


def disagreement(start: Mapping[str, Any], end: Mapping[str, Any]) -> str | None:
    """The difference between two calibrations (timer, wall_ms, gpu_ms) in words, or None."""
    if start.get("timer") != end.get("timer"):
        return f"at the start the {start.get('timer')} timer was to be trusted, at the end the {end.get('timer')} timer"
    times = f"{end.get('timer')}_ms"
    pairs = [(a, b) for a, b, wall in zip(start[times], end[times], start["wall_ms"], strict=False)
             if wall >= LONG_ENOUGH_MS and a]
    if not pairs:
        return None
    ratio = median(b / a for a, b in pairs)
    if abs(ratio - 1) <= TOLERANCE:
        return None
    return f"the same work took {ratio:.3g} times as long at the end of the run as at its start"
