"""Order of cells where time is short: of every series its ends, then its middle, then what lies between. Pure.

The experiments of a command take turns, a scene each, so that all of them are begun before any is done. A budget covers
the whole command: what it needs for reports at its end is set aside from the start.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from itertools import accumulate
from typing import Any

from ..scene import Scene
from .cells import Cell
from .ending import SAFE
from .expected import expected_stats

PARTS = 4, 12  # cells of a scene before those of the next, and at its next turn, where one sample is taken of each


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


# --- the order -----------------------------------------------------------------------------------

Plan = Mapping[str, Cell]  # the cells of an experiment by key, in its order


def groups(plans: Sequence[Plan], pending: Sequence[Collection[str]], coarse_first: bool = False) -> list[list[str]]:
    """The keys to measure, each once: the cells of a scene together, small scenes before large ones.

    pending: of each experiment the keys that are to be measured. With `coarse_first` every experiment gets its coarse
    points before any gets finer ones, and within them experiments take turns, each with its smallest scene first; the
    one whose scene is the least work begins. A scene's cells of which one sample is taken, whose times nobody compares,
    then come in parts of PARTS cells and the rest, so that every experiment has some of them before any has all.
    """
    if not coarse_first:
        found: dict[Scene, dict[str, None]] = {}
        for plan, wanted in zip(plans, pending, strict=True):
            for key in wanted:
                found.setdefault(plan[key].scene, {})[key] = None
        return [list(found[scene]) for scene in sorted(found, key=lambda scene: expected_stats(scene).F)]
    return _in_turns(plans, pending)


def _in_turns(plans: Sequence[Plan], pending: Sequence[Collection[str]]) -> list[list[str]]:
    looks = _looks(plans)
    together: dict[tuple[int, Scene], dict[str, Cell]] = defaultdict(dict)
    turns: dict[tuple[int, Scene], int] = {}  # the first of any experiment
    for plan, wanted in zip(plans, pending, strict=True):
        mine: dict[int, dict[Scene, None]] = defaultdict(dict)
        for key in wanted:
            scene, look = plan[key].scene, looks[key]
            together[look, scene].setdefault(key, plan[key])
            mine[look][scene] = None
        for look, scenes in mine.items():
            for turn, scene in enumerate(sorted(scenes, key=lambda scene: expected_stats(scene).F)):
                turns[look, scene] = min(turn, turns.get((look, scene), turn))
    parts = [((look, part, turns[look, scene], _work(cells)), keys) for (look, scene), cells in together.items()
             for part, keys in enumerate(_parts(cells))]
    return [keys for _, keys in sorted(parts, key=lambda entry: entry[0])]


def _work(cells: Mapping[str, Cell]) -> int:
    """The fragments of all frames that a cell of the scene draws at least."""
    return max(expected_stats(cell.scene).F * cell.measure.repeat_images for cell in cells.values())


def _parts(cells: Mapping[str, Cell]) -> list[list[str]]:
    keys, starts = list(cells), [0, *accumulate(PARTS)] if all(c.measure.single for c in cells.values()) else [0]
    return [keys[first:end] for first, end in zip(starts, [*starts[1:], len(keys)], strict=True) if first < len(keys)]


def _looks(plans: Sequence[Plan]) -> dict[str, int]:
    """The coarsest look that needs each key in any experiment."""
    found: dict[str, int] = {}
    for plan in plans:
        for key, look in zip(plan, coarseness(list(plan.values())), strict=True):
            found[key] = min(look, found.get(key, look))
    return found
