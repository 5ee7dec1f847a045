"""The frontier of cells that none beats in both cost and error, scene by scene, and tables of it.

An error below that of ROUNDING comes from float32 arithmetic: such errors count as equal, so that of exact methods only
the cheapest stands on a frontier.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Any

from . import data
from .data import Point, Result, number

ROUNDING = {"rmse": 1e-6, "flip": 1e-4, "max_error_all": 1e-5}  # a few pixels that round to another step of 8 bits
ERROR_LEVELS = (0.1, 0.03, 0.01, 0.003, 0.001, 1e-4, 1e-5, 1e-6)
ALIKE = " ≈"
COSTS = ("time_ms", "memory_mib")
ERRORS = ("rmse", "flip", "max_error_all")

# Title, note, header, rows, and how many columns stand flush left: the fields of a `tables.Grid`.
Table = tuple[str, str, tuple[str, ...], tuple[tuple[str, ...], ...], int]


@dataclass(frozen=True)
class ScenePoints:
    """A scene on a device, and all points measured in it, labelled by method and parameters."""

    name: str
    points: tuple[Point, ...]

    def frontier(self, cost: str, error: str) -> list[Point]:
        """The points that no other equals in one of cost and error and beats in the other, from the cheapest on."""
        ordered = sorted(self._with(cost, error), key=lambda p: (p.measure(cost)[1], p.measure(error)[1]))
        found: list[Point] = []
        for p in ordered:
            if not found or rounded(p, error) < rounded(found[-1], error):
                found.append(p)
        return found

    def _with(self, cost: str, error: str) -> list[Point]:
        return [p for p in self.points if p.measure(cost)[1] is not None and p.measure(error)[1] is not None]

    def ordered(self, key: Callable[[Point], Any], allowed: Callable[[Point], bool], cost: str,
                error: str) -> list[Point]:
        """The allowed points in the order of the key."""
        return sorted(filter(allowed, self._with(cost, error)), key=key)


def equal(error: str) -> str:
    """The errors that count as equal, in words."""
    return f"errors below {ROUNDING[error]:g} count as equal" if error in ROUNDING else "errors as they are"


def rounded(point: Point, error: str) -> float:
    return max(ROUNDING.get(error, 0), point.measure(error)[1])


def places(result: Result, points: Iterable[Point] | None = None) -> list[ScenePoints]:
    """The scenes of a result in its order, of these of its points; what is not ok, or was never an image, is left out.

    points: all of the result, unless they are given.
    """
    axes = [a for a in result.axes if a == "device" or a.startswith("scene.")
            or data.bare(a) in result.points[0].cell["scene"]]
    measured = [p for p in (result.points if points is None else points) if p.status == "ok" and not data.is_floor(p)]
    found: dict[tuple, list[Point]] = {}
    for p in data.series(result, measured, axes):
        found.setdefault(tuple(p.at(a) for a in axes), []).append(p)
    return [ScenePoints(", ".join(_coordinate(a, v) for a, v in zip(axes, where, strict=True)), tuple(members))
            for where, members in found.items()]


def _coordinate(axis: str, value: Any) -> str:
    if data.bare(axis) == "alpha" and isinstance(value, tuple):
        return f"opacity {value[0]:g}–{value[1]:g}"
    return value if axis == "device" else data.heading(axis, value)


def tables(result: Result, error: str) -> list[Table]:
    """The frontier of each scene; for a given error the fastest, for a given time the most accurate."""
    found = places(result) if result.points else []
    return [*(_frontier_table(place, error) for place in found), *_best_tables(found, error)]


def _frontier_table(place: ScenePoints, error: str) -> Table:
    on = {cost: place.frontier(cost, error) for cost in COSTS}
    keys = {cost: {p.cell["key"] for p in points} for cost, points in on.items()}
    members = {p.cell["key"]: p for points in on.values() for p in points}
    rows = tuple((p.label, " and ".join(cost.split("_")[0] for cost in COSTS if key in keys[cost]),
                  *(number(p.measure(name)[1]) for name in (*COSTS, *ERRORS)))
                 for key, p in sorted(members.items(), key=lambda member: member[1].row["time_ms"]))
    title = f"Frontier of cost and {error}" + (f" ({place.name})" if place.name else "")
    note = f"no measured cell is both cheaper and more accurate; {equal(error)}"
    return title, note, ("method", "frontier of", "time (ms)", "memory (MiB)", *ERRORS), rows, 2


def _best_tables(found: Sequence[ScenePoints], error: str) -> Iterable[Table]:
    def fastest(place: ScenePoints, level: float) -> str:
        kept = place.ordered(lambda p: p.row["time_ms"], lambda p: p.measure(error)[1] <= level, "time_ms", error)
        alike = len(kept) > 1 and not kept[1].apart(kept[1].over(kept[0]))
        return _told(kept, "time_ms") + ALIKE * alike

    def closest(place: ScenePoints, level: float) -> str:
        return _told(place.ordered(lambda p: (rounded(p, error), p.row["time_ms"]), lambda p: p.row["time_ms"] <= level,
                                   "time_ms", error), error)

    names = tuple(place.name or "all" for place in found)
    levels = [level for level in ERROR_LEVELS if level >= ROUNDING.get(error, 0)]
    if not found:
        return
    note = f"of those with {error} at most that of the row, and the time in ms;{ALIKE} not told apart from the next"
    yield ("Fastest for a given error", note, (error, *names), _rows(found, levels, fastest), 1)
    yield ("Most accurate for a given time", f"of those with a time at most that of the row, and {error}",
           ("time (ms)", *names), _rows(found, _levels(found), closest), 1)


def _told(ordered: Sequence[Point], measure: str) -> str:
    return f"{ordered[0].label}: {number(ordered[0].measure(measure)[1])}" if ordered else "–"


def _rows(found: Sequence[ScenePoints], levels: Iterable[float],
          choose: Callable[[ScenePoints, float], str]) -> tuple[tuple[str, ...], ...]:
    rows = [(f"{level:g}", *(choose(place, level) for place in found)) for level in levels]
    while len(rows) > 1 and rows[-1][1:] == rows[-2][1:]:
        rows.pop()
    return tuple(rows)


def _levels(found: Sequence[ScenePoints]) -> list[float]:
    """1, 2, 5, 10, … ms, from the fastest cell's time to beyond the slowest's."""
    times = [p.row["time_ms"] for place in found for p in place.points if p.row["time_ms"]]
    levels = [m * 10.0**e for e in range(-4, 6) for m in (1, 2, 5)]
    return [v for v in levels if times and min(times) <= v <= 2.5 * max(times)]
