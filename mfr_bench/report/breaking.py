"""Finds where each method breaks along a stressor: the first level at which a cell is not as promised, and how."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from ..store.status import EXACT_ERROR
from . import data
from .data import Point, Result, number

HOLDS = "holds"
FAULTS = {  # in the order in which they are looked for
    "crashed": "the cell crashed or ran out of memory",
    "hung": "the cell ran out of time",
    "refused": "the method, the device or the budget forbids the cell",
    "lost": "fragments are lost, by the method's own count",
    "ties": "the image is right, and fragments of equal depth show in another order than that of submission",
    "image": "an exact method's image is wrong, or differs from frame to frame",
    "bound": "an exact method's error exceeds what rounding explains",
    "differs": "an approximate method's image differs from the one that it aims at",
    HOLDS: "the image is the promised one",
}


def state(point: Point) -> str:
    """A key of FAULTS: what the point says of its level."""
    if point.ending.breaks:
        return point.ending.breaks
    row, bound = point.row, point.row["error_bound"]
    if row["lost_fragments"]:
        return "lost"
    if point.ending.image == "wrong":
        return "image"
    error = row["max_abs_error"]
    if bound is not None and error is not None and error > bound:
        return "bound"
    if error is not None and error > EXACT_ERROR:
        return "differs"
    return "ties" if (row["order_error"] or 0) > EXACT_ERROR else HOLDS


def detail(point: Point) -> str:
    """The number or the reason behind the state."""
    row, found = point.row, state(point)
    if point.ending.breaks:
        return str(point.cell.get("reason") or point.sign)
    if found == "lost":
        return f"{row['lost_fragments']} fragments"
    if found == "ties":
        return f"{number(row['order_error'], 2)} from the order of submission"
    repeated = f", {row['distinct_images']} images" if (row["distinct_images"] or 1) > 1 else ""
    return f"error {number(row['max_abs_error'], 2)}{repeated}"


@dataclass(frozen=True)
class Ladder:
    """One method's points along the stressor in one panel, from the mildest level to the harshest.

    planned: the levels that the config has there, where some planned cells have no record; else none.
    """

    label: str
    method: str
    panel: Any
    points: Mapping[Any, Point]
    planned: tuple[Any, ...] = ()

    @property
    def first(self) -> tuple[Any, Point] | None:
        """The first level that breaks the method, with its point."""
        return next(((level, p) for level, p in self.points.items() if state(p) != HOLDS), None)

    @property
    def unknown(self) -> int:
        """How many planned levels have no record; those harsher than one that breaks the method do not count."""
        until = self.planned.index(self.first[0]) if self.first and self.first[0] in self.planned else None
        return sum(level not in self.points for level in self.planned[:until])

    @property
    def worst(self) -> Point | None:
        """The point nearest to its bound, of the exact points with a right image."""
        bounded = [p for p in self.points.values() if state(p) in (HOLDS, "ties") and p.row["error_bound"]]
        return max(bounded, key=lambda p: p.row["max_abs_error"] / p.row["error_bound"], default=None)


def levels(result: Result, axis: str) -> list[Any]:
    """The levels of the stressor in the order of the config, which goes from mild to harsh."""
    order, found = _swept(result, axis), data.values(result.points, axis)
    return list(dict.fromkeys([*(v for v in order if v in found), *(v for v in found if v not in order)]))


def _swept(result: Result, axis: str) -> list[Any]:
    """The values of an axis as the config lists them."""
    swept = {**(result.manifest.get("sweep") or {}), **(result.manifest.get("zip") or {})}
    listed = next((v for name, v in swept.items() if data.bare(name) == data.bare(axis)), [])
    return [tuple(v) if isinstance(v, list) else v for v in listed]


def _planned(result: Result, axis: str, panels: str | None, panel: Any) -> tuple[Any, ...]:
    """The levels of a panel by the config, where some planned cells have no record; else none."""
    order = _swept(result, axis) if result.unmeasured else []
    zipped = {data.bare(name) for name in result.manifest.get("zip") or {}}
    if panels and {data.bare(axis), data.bare(panels)} <= zipped:
        order = [level for level, of in zip(order, _swept(result, panels), strict=False) if of == panel]
    return tuple(dict.fromkeys(order))


def ladders(result: Result, points: Sequence[Point], axis: str, panels: str | None) -> list[Ladder]:
    """A ladder for each label and panel; methods that the stressor does not touch are left out."""
    order = levels(result, axis)
    found: dict[tuple[str, Any], dict[Any, Point]] = {}
    for p in points:
        if p.at(axis) is not None:
            found.setdefault((p.label, p.at(panels) if panels else None), {})[p.at(axis)] = p
    return [Ladder(label, next(iter(members.values())).method, panel,
                   {level: members[level] for level in order if level in members},
                   _planned(result, axis, panels, panel))
            for (label, panel), members in found.items()]


def first_break(ladder: Ladder) -> str:
    """Name the first level that breaks the method, and how; and how many levels that may change this have no record."""
    if ladder.first is None:
        unknown = f" (of {len(ladder.planned)} levels {ladder.unknown} not measured)" if ladder.unknown else ""
        return f"holds up to {data.plain(list(ladder.points)[-1])}{unknown}"
    level, point = ladder.first
    unknown = f" ({ladder.unknown} milder not measured)" if ladder.unknown else ""
    return f"{data.plain(level)}: {state(point)}, {detail(point)}{unknown}"
