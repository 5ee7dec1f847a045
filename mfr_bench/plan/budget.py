"""Order of cells where time is short: of every series its ends, then its middle, then what lies between. Pure.

A budget covers the whole command: what it needs for reports at its end is set aside from the start.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from . import Cell
from .ending import SAFE


@dataclass(frozen=True)
class TimeBudget:
    """Seconds that a command may take in all, from `begun` on the clock that is asked later."""

    seconds: float
    begun: float

    def deadline(self, end_s: float) -> float:
        """The time to stop measuring, so that what follows the last cell, and should take end_s, is in time.

        SAFE times as much is set aside for it, but at most half of the budget.
        """
        return self.begun + self.seconds - min(self.seconds / 2, SAFE * end_s)


def coarseness(cells: Sequence[Cell]) -> list[int]:
    """The look at the axes, coarse to fine, that each cell of an experiment belongs to: 0 for the ends of every axis.

    1 adds the middle of each, 2 the quarters, and so on. A cell is as fine as the finest of its places.
    """
    depths = _depths(cells)
    return [max((depths[axis][_hashable(value)] for axis, value in cell.point.items()), default=0) for cell in cells]


def _depths(cells: Sequence[Cell]) -> dict[str, dict[Any, int]]:
    """The depth of each value of each axis, in the order in which cells bring them."""
    values: Mapping[str, dict[Any, None]] = defaultdict(dict)
    for cell in cells:
        for axis, value in cell.point.items():
            values[axis][_hashable(value)] = None
    return {axis: dict(zip(found, bisection(len(found)), strict=True)) for axis, found in values.items()}


def _hashable(value: Any) -> Any:
    return tuple(value) if isinstance(value, list) else value


def bisection(count: int) -> list[int]:
    """Depth of each of `count` places in a row: both ends 0, the middle 1, the middles of what is left 2, …"""
    depths = [0] * count
    spans, depth = [(0, count - 1)], 0
    while spans:
        depth += 1
        halves = []
        for first, last in spans:
            if last - first > 1:
                middle = (first + last) // 2
                depths[middle] = depth
                halves += [(first, middle), (middle, last)]
        spans = halves
    return depths
