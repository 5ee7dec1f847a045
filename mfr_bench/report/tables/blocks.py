"""Tables of measures: methods down, the values of one axis across."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

from ...methods import FLOOR
from .. import data
from ..data import Point, Result, number
from .fields import (
    FASTEST_NOTE,
    MEMORY_NOTE,
    RATIO_NOTE,
    TIME_NOTE,
    memory_field,
    ratio_field,
    ratio_to_fastest,
    time_field,
)
from .grid import ABSENT, Grid, cut

PASS_NOTE = "medians of separate frames: their sum may differ from the whole frame's time"


def _column_axis(result: Result) -> str | None:
    """The axis laid out as columns: the first figure's, else the one with most values."""
    drawn = [data.bare(str(figure.get("x"))) for figure in result.figures][:1]
    preferred = [axis for axis in result.axes if data.bare(axis) in drawn]
    return next(iter(preferred), max(result.axes, key=lambda a: len(data.values(result.points, a)), default=None))


@dataclass(frozen=True)
class Block:
    """Points of one place on the scene axes that are neither columns nor named in the labels."""

    where: str
    axis: str | None
    points: tuple[Point, ...]

    def columns(self) -> list[Any]:
        if self.axis is None:
            return [None]
        unswept = [None] if any(p.at(self.axis) is None for p in self.points) else []
        return [*data.values(self.points, self.axis), *unswept]

    def pivot(self, title: str, note: str, entries: Iterable[tuple[str, Point, str]], corner: str = "method") -> Grid:
        """Entries (row name, point, text) by row name and column; rows without any text are left out."""
        found: dict[tuple[str, Any], str] = {}
        for name, point, text in entries:
            found.setdefault((name, point.at(self.axis) if self.axis else None), text)
        columns, names = self.columns(), dict.fromkeys(name for name, _ in found)
        swept = {name for name, value in found if value is not None}
        rows = tuple((name, *(found.get((name, c), ABSENT if c is not None and name in swept else "") for c in columns))
                     for name in names)
        heads = (data.heading(self.axis, c) if self.axis else "all" for c in columns)
        title = f"{title} ({self.where})" if self.where else title
        return Grid(title, note, (corner, *heads), tuple(row for row in rows if set(row[1:]) - {"", ABSENT}))

    def measure_grids(self) -> list[Grid]:
        fields = (("Time, ms", TIME_NOTE, time_field), ("Ratio to the floor", RATIO_NOTE, ratio_field),
                  ("Memory, MiB", MEMORY_NOTE, memory_field))
        points = self.points if self.axis else self._ranked()
        grids = [self.pivot(title, note, [(cut(p.label), p, field(p)) for p in points])
                 for title, note, field in fields]
        grids.insert(2, self.pivot("Ratio to the fastest", FASTEST_NOTE, self._to_the_fastest()))
        grids = [grid for grid in grids if grid.rows]
        return grids if self.axis else [_side_by_side(grids)]

    def _ranked(self) -> list[Point]:
        """The floor, then the fastest first, then what has no time, as it stands."""
        def place(point: Point) -> tuple[bool, float]:
            time_ms = point.row["time_ms"]
            return point.method != FLOOR, float("inf") if time_ms is None else time_ms
        return sorted(self.points, key=place)

    def _to_the_fastest(self) -> list[tuple[str, Point, str]]:
        """Entries for each column in which several methods show every fragment."""
        columns: dict[Any, list[Point]] = {}
        for p in self.points:
            if p.shows_all and p.method != FLOOR:
                columns.setdefault(p.at(self.axis) if self.axis else None, []).append(p)
        entries = []
        for points in columns.values():
            fastest = min(points, key=lambda p: p.row["time_ms"])
            entries += [(cut(p.label), p, ratio_to_fastest(p, fastest)) for p in points if points[1:]]
        return entries

    def pass_grid(self) -> Grid:
        entries = [(f"{cut(p.label)} · {name}", p, number(interval[1]))
                   for p in self.points if p.status == "ok" for name, interval in p.passes_ms.items()]
        return self.pivot("Pass times, ms", PASS_NOTE, entries, "method · pass")


def _side_by_side(grids: Sequence[Grid]) -> Grid:
    """One grid of several with a single column each."""
    names = dict.fromkeys(row[0] for grid in grids for row in grid.rows)
    columns = [dict(grid.rows) for grid in grids]
    rows = tuple((name, *(column.get(name, "") for column in columns)) for name in names)
    titles = [grid.title for grid in grids]
    note = "\n".join(f"{title.split(',')[0]}: {grid.note}" for title, grid in zip(titles, grids, strict=True))
    return Grid("Measured, the fastest first", note, ("method", *titles), rows)


def blocks_of(result: Result) -> list[Block]:
    """Blocks by the scene axes that are not columns; axes of parameters are named in the labels instead."""
    axis = _column_axis(result)
    used = [axis] if axis else []
    parameters = {name for p in result.points for name in p.parameters}
    rest = [a for a in result.split(result.points, used) if data.bare(a) not in parameters]
    places: dict[tuple, list[Point]] = {}
    for p in data.series(result, result.points, [*used, *rest]):
        places.setdefault(tuple(p.at(a) for a in rest), []).append(p)
    return [Block(", ".join(map(data.heading, rest, place)), axis, tuple(members))
            for place, members in places.items()]
