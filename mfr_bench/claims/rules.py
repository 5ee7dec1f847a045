"""Rules about measurements. A rule gives comparisons for each run; it knows no claim.

Every rule has `text`, which is printed beside the verdict; `needs`, what it looks for in a run; and `each`, the
methods of which every one must be found there.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from typing import Protocol

from ..report.data import Point, plain, short
from ..stats import Interval, median_interval
from .evidence import (
    LESS,
    MORE,
    NOTHING,
    Bound,
    BoundByMaker,
    Evidence,
    at_least,
    at_most,
    bound_on,
    decided,
    refusal,
)
from .measures import TIME, Quantity, column, frame_ms, pass_ms
from .picks import Pick, Where, at, coordinates, fixed_by, is_number, meets, pairs, words
from .runs import Run


class Rule(Protocol):
    @property
    def text(self) -> str: ...

    @property
    def needs(self) -> str: ...

    @property
    def each(self) -> tuple[str, ...]: ...

    def compare(self, run: Run) -> list[Evidence]: ...


class OfOnePick:
    """Base of rules over the cells of one pick."""

    cells: Pick

    @property
    def needs(self) -> str:
        return self.cells.names

    @property
    def each(self) -> tuple[str, ...]:
        return self.cells.each


def compared(run: Run, what: str, points: Sequence[Point], interval: Callable[[], Interval], bound: Bound,
             exact: bool = False) -> Evidence:
    """The comparison of these cells, which is made only where all of them were measured with a right image."""
    refused = _refused(run, what, points)
    if refused:
        return refused
    found = interval()
    outcome, reason = decided(found, bound, 0.0 if exact else run.noise or 0.0)
    margin = bound.margin(found[1]) if found[1] else 0.0
    return Evidence(what, coordinates(*points), found, outcome, reason, run.folder, margin, exact)


def _refused(run: Run, what: str, points: Sequence[Point]) -> Evidence | None:
    """The comparison that cannot be made, where one of the cells was not measured."""
    refused = refusal(*points)
    return Evidence(what, coordinates(*points), NOTHING, *refused, run.folder) if refused else None


def _sifted(run: Run, found: Iterable, what: Callable[..., str]) -> tuple[list[Evidence], list]:
    """Comparisons for those items (tuples of cells) that cannot be compared, and the other items."""
    items = [(item, _refused(run, what(*item), item)) for item in found]
    return [refused for _, refused in items if refused], [item for item, refused in items if not refused]


def _there(where: Where) -> str:
    return f", where {words(where)}" if where else ""


@dataclass(frozen=True)
class Ratio:
    """A measure of one method over that of another, in every scene and with all parameters that both have."""

    over: Pick
    under: Pick
    bound: Bound | BoundByMaker = MORE
    where: Where = field(default_factory=dict)
    measure: Quantity = TIME

    @property
    def text(self) -> str:
        return f"{self.quantity}: {self.bound.words}"

    @property
    def quantity(self) -> str:
        return f"{self.measure.words}, {self.over.text} / {self.under.text}{_there(self.where)}"

    @property
    def needs(self) -> str:
        return f"{self.over.names} beside {self.under.names}{_there(self.where)}"

    @property
    def each(self) -> tuple[str, ...]:
        return self.over.each + self.under.each

    def named(self, over: Point, under: Point) -> str:
        """The two sides of a comparison, by the values in which they differ."""
        if over.method != under.method:
            return f"{over.method} / {under.method}"
        return f"{over.method} ({words(self.over.where)} / {words(self.under.where)})"

    def compare(self, run: Run) -> list[Evidence]:
        bound = bound_on(run.makers, self.bound)
        return [compared(run, self.named(over, under), (over, under),
                          lambda over=over, under=under: self.measure.ratio(over, under), bound, self.measure.exact)
                for over, under in pairs(run, self.over, self.under, self.where)]


@dataclass(frozen=True)
class RatioChange:
    """A ratio at the largest value of a coordinate over the same ratio at the smallest."""

    ratio: Ratio
    along: str
    bound: Bound
    same: tuple[str, ...] = ()  # coordinates that both ends share, besides methods and parameters

    @property
    def text(self) -> str:
        return f"({self.ratio.quantity}) at the largest {short(self.along)} / at the smallest: {self.bound.words}"

    @property
    def needs(self) -> str:
        return f"{self.ratio.needs}, at two values of {short(self.along)}"

    @property
    def each(self) -> tuple[str, ...]:
        return self.ratio.each

    def compare(self, run: Run) -> list[Evidence]:
        refused, found = _sifted(run, pairs(run, self.ratio.over, self.ratio.under, self.ratio.where), self.ratio.named)
        groups = _grouped(found, lambda pair: (*(fixed_by(p, [self.along]) for p in pair), _shared(pair[0], self.same)))
        return refused + [self.compared(run, ends) for group in groups
                          if (ends := _ends(group, lambda pair: at(pair[0], self.along)))]

    def compared(self, run: Run, ends: tuple[tuple[Point, Point], tuple[Point, Point]]) -> Evidence:
        (first_over, first_under), (last_over, last_under) = ends

        def interval() -> Interval:
            return _quotient(self.ratio.measure.ratio(last_over, last_under, 0.975),
                             self.ratio.measure.ratio(first_over, first_under, 0.975))

        last, first = (plain(at(p, self.along)) for p in (last_over, first_over))
        what = f"{self.ratio.named(last_over, last_under)}, {short(self.along)} {last} against {first}"
        return compared(run, what, (last_over, last_under, first_over, first_under), interval, self.bound,
                         self.ratio.measure.exact)


def _quotient(over: Interval, under: Interval) -> Interval:
    """One interval over another; both at 97.5 % hold at once in at least 95 % of cases."""
    if over[1] is None or not under[1]:
        return NOTHING
    ends = over[0], over[2], under[0], under[2]
    if None in ends or not under[0]:
        return None, over[1] / under[1], None
    return over[0] / under[2], over[1] / under[1], over[2] / under[0]


def _shared(point: Point, names: Iterable[str]) -> tuple:
    return tuple(at(point, name) for name in names)


def _grouped(items: Iterable, key: Callable) -> list[list]:
    groups: dict = {}
    for item in items:
        groups.setdefault(key(item), []).append(item)
    return list(groups.values())


def _ends(items: Sequence, coordinate: Callable) -> tuple | None:
    """The items of the smallest and the largest coordinate, or None where there is one coordinate only."""
    known = sorted((item for item in items if is_number(coordinate(item))), key=coordinate)
    if not known or coordinate(known[0]) == coordinate(known[-1]):
        return None
    return known[0], known[-1]


@dataclass(frozen=True)
class Straight(OfOnePick):
    """Time on a straight line over a power of a coordinate: inner points against the chord between the ends.

    A constant cost per frame does not matter, but that the largest takes `grows` times as long as the smallest does.
    The coordinate must span a factor of `span`, or any curve is straight.
    """

    cells: Pick
    along: str
    power: int = 1
    tolerance: float = 0.1
    span: float = 3.0
    same: tuple[str, ...] = ()
    grows: float = 1.0
    below: bool = False  # a curve that grows ever faster: its inner points lie below the chord
    cut: Where = field(default_factory=dict)  # which inner points are compared, all where empty

    @property
    def bound(self) -> Bound:
        if self.below:
            return LESS
        return Bound(f"within {100 * self.tolerance:g} % of 1", 1 - self.tolerance, 1 + self.tolerance)

    @property
    def text(self) -> str:
        axis = short(self.along) + ("²" if self.power == 2 else "")
        return (f"time, {self.cells.text}{_there(self.cut)} / the straight line over {axis} from the smallest to the "
                f"largest {short(self.along)}: {self.bound.words}{self._grows_words}")

    @property
    def _grows_words(self) -> str:
        return f", and the largest takes at least {self.grows:g} times the smallest" if self.grows > 1 else ""

    @property
    def needs(self) -> str:
        return f"{self.cells.names} at three values of {short(self.along)} over a factor of {self.span:g}"

    def compare(self, run: Run) -> list[Evidence]:
        refused, found = _sifted(run, ((p,) for p in run.points if self.cells.takes(p)), lambda p: f"{p.method} / line")
        series = _grouped((p for p, in found if is_number(at(p, self.along))),
                          lambda p: (fixed_by(p, [self.along]), _shared(p, self.same)))
        return refused + [comparison for points in series for comparison in self._inner(run, points)]

    def _inner(self, run: Run, points: list[Point]) -> Iterable[Evidence]:
        ends = _ends(points, lambda p: at(p, self.along))
        if ends is None or at(ends[1], self.along) < self.span * at(ends[0], self.along):
            return
        limits = [at(end, self.along) for end in ends]
        if self.grows > 1:
            yield compared(run, f"{ends[1].method}, largest / smallest", (ends[1], ends[0]),
                            lambda: TIME.ratio(ends[1], ends[0]), at_least(self.grows))
        for point in points:
            if limits[0] < at(point, self.along) < limits[1] and meets(point, self.cut):
                yield compared(run, f"{point.method} / line", (point, *ends),
                                lambda point=point: self._against_chord(point, *ends), self.bound)

    def _against_chord(self, point: Point, first: Point, last: Point) -> Interval:
        """Three medians at once: each interval is taken at 1 - 0.05 / 3."""
        place, start, end = (at(p, self.along) ** self.power for p in (point, first, last))
        share = (place - start) / (end - start)
        inner, low, high = (median_interval(frame_ms(p), 1 - 0.05 / 3) for p in (point, first, last))
        chord = tuple(None if None in (a, b) else (1 - share) * a + share * b for a, b in zip(low, high, strict=True))
        return _quotient(inner, chord)


@dataclass(frozen=True)
class PassShare(OfOnePick):
    """The part of a frame that one pass takes, of the sum of its passes."""

    cells: Pick
    part: str
    bound: Bound

    @property
    def text(self) -> str:
        return f"share of the {self.part} pass, {self.cells.text}: {self.bound.words}"

    def compare(self, run: Run) -> list[Evidence]:
        return [compared(run, f"{self.part} of {p.method}", (p,), lambda p=p: self._share(p), self.bound)
                for p in run.points if self.cells.takes(p)]

    def _share(self, point: Point) -> Interval:
        """All medians of the passes at once: each interval is taken at 1 - 0.05 / passes."""
        passes = [name for name, samples in (point.cell.get("passes") or {}).items() if samples]
        if self.part not in passes:
            return NOTHING
        each = {name: median_interval(pass_ms(point, name), 1 - round(0.05 / len(passes), 4)) for name in passes}
        part = each.pop(self.part)
        rest = tuple(None if any(other[end] is None for other in each.values()) else sum(o[end] for o in each.values())
                     for end in range(3))
        return tuple(_part_of(part[end], rest[2 - end]) for end in range(3))


def _part_of(part: float | None, rest: float | None) -> float | None:
    return None if part is None or rest is None or not part + rest else part / (part + rest)


@dataclass(frozen=True)
class CountedValue(OfOnePick):
    """A value of a cell that is counted, not timed."""

    cells: Pick
    column: str
    bound: Bound

    @property
    def text(self) -> str:
        return f"{self.column.replace('_', ' ')}, {self.cells.text}: {self.bound.words}"

    @property
    def needs(self) -> str:
        return f"{self.cells.names} with a value {self.column}"

    def compare(self, run: Run) -> list[Evidence]:
        value = column(self.column)
        return [compared(run, p.method, (p,), lambda p=p: (value(p),) * 3, self.bound, exact=True)
                for p in run.points if self.cells.takes(p)]


def no_faster_than(others: Pick, best: Pick, slack: float, where: Where | None = None) -> Ratio:
    """The best is beaten by none of the others by more than `slack`."""
    return Ratio(others, best, Bound(f"at least {1 - slack:g}", low=1 - slack), where or {})


def no_slower_than(one: Pick, other: Pick, slack: float, where: Where | None = None) -> Ratio:
    """One takes at most `slack` more than the other."""
    return Ratio(one, other, at_most(1 + slack), where or {})
