"""The methods whose place changes along the axis of a figure, where noise does not explain it."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import combinations

from .. import data
from ..data import Point, Result
from .blocks import Block
from .grid import Grid, cut

NOTE = ("place by the median time, 1 the fastest; those are listed that are faster than another method at one value "
        "and slower at another, beyond the noise at both")


def places_grids(result: Result, blocks: Sequence[Block]) -> list[Grid]:
    """A table for each block, where a figure of the config asks for it by `places` along the block's axis."""
    axes = {data.bare(str(figure["x"])) for figure in result.figures if figure.get("places")}
    return [_grid(block) for block in blocks if block.axis and data.bare(block.axis) in axes]


def _grid(block: Block) -> Grid:
    columns = [_timed(block, value) for value in block.columns()]
    partners = _changing(columns)
    entries = [(cut(point.label), point, str(place)) for points in columns
               for place, point in enumerate(points, start=1) if point.label in partners]
    grid = block.pivot("Places that change", NOTE, entries)
    against = {cut(label): ", ".join(map(cut, others)) for label, others in partners.items()}
    return Grid(grid.title, grid.note, (*grid.header, "changes places with"),
                tuple((*row, against[row[0]]) for row in grid.rows))


def _timed(block: Block, value: object) -> list[Point]:
    """The points at a value of the axis that have a time, from the fastest to the slowest."""
    points = [p for p in block.points
              if p.at(block.axis) == value and p.status == "ok" and p.row["time_ms"] is not None]
    return sorted(points, key=lambda p: p.row["time_ms"])


def _changing(columns: Iterable[Sequence[Point]]) -> dict[str, list[str]]:
    """Labels that change places, each with those it does so with."""
    orders: dict[tuple[str, str], set[bool]] = {}
    for points in columns:
        for one, other in combinations(sorted(points, key=lambda p: p.label), 2):
            ratio = one.over(other)
            if one.apart(ratio):
                orders.setdefault((one.label, other.label), set()).add(ratio[1] < 1)
    found: dict[str, list[str]] = {}
    for (one, other), faster in orders.items():
        if len(faster) > 1:
            found.setdefault(one, []).append(other)
            found.setdefault(other, []).append(one)
    return found
