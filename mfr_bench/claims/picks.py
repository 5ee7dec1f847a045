"""Picks of the cells that a rule compares: by method, parameters, scene and point; never by label."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from ..report.data import Point, bare, plain, short
from .runs import Run

Where = Mapping[str, Any]  # name of a coordinate -> value, or Condition


@dataclass(frozen=True)
class Condition:
    """A condition on a coordinate. `words` follow its name: 'k at least 32'."""

    words: str
    holds: Callable[[Any, Point], bool]
    optional: bool = False  # a cell without the coordinate meets it too


def if_any(wanted: Any) -> Condition:
    """The value, of cells that have the coordinate."""
    return Condition(plain(wanted), lambda value, _: _same(value, wanted), optional=True)


ANY = Condition("any", lambda value, _: True, optional=True)  # stated by both sides, it may differ between them


UNSET = Condition("unset", lambda value, _: value is None, optional=True)


def from_(low: float) -> Condition:
    return Condition(f"from {low:g}", lambda value, _: is_number(value) and value >= low)


def up_to(high: float) -> Condition:
    return Condition(f"up to {high:g}", lambda value, _: is_number(value) and value <= high)


def within(low: float, high: float) -> Condition:
    return Condition(f"{low:g} to {high:g}", lambda value, _: is_number(value) and low <= value <= high)


def other_than(refused: Any) -> Condition:
    return Condition(f"other than {plain(refused)}", lambda value, _: not _same(value, refused))


def _all_layers(value: Any, point: Point) -> bool:
    layers = point.at("depth_complexity")
    return is_number(value) and is_number(layers) and value >= layers


ALL_LAYERS = Condition("= n", _all_layers)


def is_number(value: Any) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def at(point: Point, name: str) -> Any:
    """A coordinate of a point: a parameter, a field of the scene, a column, or 'opacity', the mean alpha."""
    if name == "opacity":
        alpha = point.cell["scene"].get("alpha")
        return sum(alpha) / len(alpha) if isinstance(alpha, list) and alpha and all(map(is_number, alpha)) else None
    return point.at(name)


def meets(point: Point, where: Where) -> bool:
    return all(_meets(point, name, wanted) for name, wanted in where.items())


def _meets(point: Point, name: str, wanted: Any) -> bool:
    value = at(point, name)
    if value is None:
        return isinstance(wanted, Condition) and wanted.optional
    return wanted.holds(value, point) if isinstance(wanted, Condition) else _same(value, wanted)


def _same(value: Any, wanted: Any) -> bool:
    if is_number(value) and is_number(wanted):
        return math.isclose(value, wanted, rel_tol=1e-6)
    return value == wanted


def words(where: Where) -> str:
    """k 64, p_d up to 0.25; what only some of the cells are asked for is left to the claim's remark."""
    conditions = {name: w if isinstance(w, Condition) else Condition(plain(w), _same) for name, w in where.items()}
    return ", ".join(f"{short(name)} {c.words}" for name, c in conditions.items() if not c.optional)


@dataclass(frozen=True)
class Pick:
    """Cells of any of the methods (of every method where none is named) that meet the conditions.

    With `fastest`, of the cells that may stand on one side of a comparison the one of least time does.
    """

    methods: tuple[str, ...]
    where: Where
    fastest: bool = False

    def takes(self, point: Point) -> bool:
        return (not self.methods or point.method in self.methods) and meets(point, self.where)

    @property
    def each(self) -> tuple[str, ...]:
        """Methods of which none may be missing."""
        return () if self.fastest else self.methods

    @property
    def text(self) -> str:
        group = "the fastest of " if self.fastest else "each of " if len(self.methods) > 1 else ""
        return group + self.names

    @property
    def names(self) -> str:
        chosen = words(self.where)
        return (", ".join(self.methods) or "any method") + (f" ({chosen})" if chosen else "")


def pick(*methods: str, **where: Any) -> Pick:
    return Pick(methods, where)


def fastest_of(*methods: str, **where: Any) -> Pick:
    return Pick(methods, where, fastest=True)


def pairs(run: Run, over: Pick, under: Pick, where: Where) -> Iterator[tuple[Point, Point]]:
    """Cells of the run to compare: all that both have, scene and shared parameters, is equal.

    What both picks state is exempt. `where` is asked of the first, and so holds for what the second shares.
    """
    stated = {bare(name) for name in over.where} & {bare(name) for name in under.where}
    below = [point for point in run.points if under.takes(point)]
    for first in run.points:
        if over.takes(first) and meets(first, where):
            alike = [p for p in below if p is not first and _alike(first, p, stated)
                     and (p.method == first.method or (over.methods and under.methods))]
            yield from ((first, second) for second in (_fastest(alike) if under.fastest else alike))


def _alike(one: Point, other: Point, stated: set[str]) -> bool:
    mine, its = one.cell["params"], other.cell["params"]
    return (all(mine[name] == its[name] for name in mine.keys() & its.keys() - stated)
            and _without(one.cell["scene"], stated) == _without(other.cell["scene"], stated))


def _without(values: Mapping[str, Any], names: Iterable[str]) -> dict[str, Any]:
    return {name: value for name, value in values.items() if name not in names}


def _fastest(points: list[Point]) -> list[Point]:
    measured = [p for p in points if p.status == "ok" and p.row["time_ms"] is not None]
    return [min(measured, key=lambda p: p.row["time_ms"])] if measured else points[:1]


def coordinates(*points: Point) -> dict[str, Any]:
    """The point of a comparison: viewport, n, p_d, f_p, order, layout, opacity, and the first cell's parameters."""
    first = points[0]
    names = ("size", "depth_complexity", "pixel_density", "fragment_probability", "order", "layout", "opacity")
    own = {name: value for point in reversed(points) for name, value in point.cell["params"].items()}
    return {"methods": tuple(p.method for p in points)} | {name: at(first, name) for name in names} | own


def fixed_by(point: Point, free: Iterable[str]) -> tuple:
    """Method and parameters of a cell, apart from the free ones: what makes cells one series."""
    return point.method, tuple(sorted(_without(point.cell["params"], set(free)).items()))
