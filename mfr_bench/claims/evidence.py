"""A comparison of measurements with a bound, and how it is decided: the whole interval must be on one side."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import Enum
from typing import Any

from ..report.data import Point, percent
from ..report.data import number as digits
from ..stats import Interval

NOTHING: Interval = (None, None, None)


class Outcome(Enum):
    FAILS = "does not hold"
    UNCLEAR = "unclear"
    HOLDS = "holds"
    LEFT_OUT = "left out"  # the device or the memory budget refuses one side


@dataclass(frozen=True)
class Bound:
    """Values from `low` to `high`, both included; None is no limit."""

    words: str
    low: float | None = None
    high: float | None = None

    @property
    def limits(self) -> list[float]:
        return [limit for limit in (self.low, self.high) if limit is not None]

    def contains(self, value: float) -> bool:
        return (self.low is None or value >= self.low) and (self.high is None or value <= self.high)

    def excludes(self, low: float, high: float) -> bool:
        """Whether no value from `low` to `high` is within the bound."""
        return (self.low is not None and high < self.low) or (self.high is not None and low > self.high)

    def margin(self, value: float) -> float:
        """The distance of a positive value from the bound's nearest limit, relative to the limits; negative outside."""
        inside = [value / self.low - 1] if self.low else []
        outside = [self.high / value - 1] if self.high and value else []
        return min([*inside, *outside], default=0.0)


@dataclass(frozen=True)
class BoundByMaker:
    """A bound for each maker that a paper measured, and one for all others."""

    of: Mapping[str, Bound]
    others: Bound

    @property
    def words(self) -> str:
        return ", ".join([*(f"{b.words} on {maker}" for maker, b in self.of.items()), f"{self.others.words} elsewhere"])


def bound_on(makers: str, bound: Bound | BoundByMaker) -> Bound:
    """The bound for a device of these makers."""
    if isinstance(bound, Bound):
        return bound
    return next((b for maker, b in bound.of.items() if maker.lower() in makers.lower()), bound.others)


def at_least(limit: float) -> Bound:
    return Bound(f"at least {limit:g}", low=limit)


def at_most(limit: float) -> Bound:
    return Bound(f"at most {limit:g}", high=limit)


def between(low: float, high: float, printed: str) -> Bound:
    """A range that a paper prints, to half a unit of what it is rounded to."""
    return Bound(f"{low:g} to {high:g} (printed: {printed})", low, high)


MORE = Bound("above 1", low=1.0)
LESS = Bound("below 1", high=1.0)
NEAR = 1.5  # "about N times" is from N / 1.5 to N * 1.5


def about(times: float) -> Bound:
    """A factor that a paper prints as approximate, and as neither good nor bad."""
    return Bound(f"{times / NEAR:.3g} to {times * NEAR:.3g} (about {times:g})", times / NEAR, times * NEAR)


def speedup(times: float) -> Bound:
    """A speed-up that a paper prints: two thirds of it on another device count, and so does more."""
    return Bound(f"at least {times / NEAR:.3g} (two thirds of {times:g})", low=times / NEAR)


def margin(share: float) -> Bound:
    """More than the other by a share that the text does not print."""
    return Bound(f"at least {1 + share:g} (the limit is ours)", low=1 + share)


def gain(percent: float) -> Bound:
    """A small gain or cost that a paper prints: from half of it to twice as much."""
    low, high = 1 + percent / 200, 1 + percent / 50
    return Bound(f"{low:.4g} to {high:.4g} (half to twice {percent:g} %)", low, high)


@dataclass(frozen=True)
class Evidence:
    """One measured value against its bound. `at` has the coordinates, `reason` says why it is not decided."""

    what: str
    at: Mapping[str, Any]
    interval: Interval
    outcome: Outcome
    reason: str = ""
    folder: str = ""
    margin: float = 0.0
    exact: bool = field(default=False)  # counted, not timed: the interval is the value

    @property
    def value(self) -> float | None:
        return self.interval[1]

    @property
    def text(self) -> str:
        """3.12 [3.01, 3.20]; a value that is counted has no interval."""
        low, value, high = (digits(v) for v in map(_real, self.interval))
        return value if self.exact or not (low and high) else f"{value} [{low}, {high}]"


def _real(value: float | None) -> float | None:
    return None if value is None else float(value)


def decided(interval: Interval, bound: Bound, noise: float) -> tuple[Outcome, str]:
    """The outcome of a measured interval, and the reason where it is unclear.

    noise: largest relative difference between two measurements of the same thing, 0 for what is counted.
    """
    low, value, high = interval
    if value is None:
        return Outcome.UNCLEAR, "not measured"
    if low is None or high is None:
        return Outcome.UNCLEAR, "too few samples for an interval"
    inside = bound.contains(low) and bound.contains(high)
    if not inside and not bound.excludes(low, high):
        return Outcome.UNCLEAR, "the interval reaches over the limit"
    if any(abs(value - limit) < noise * limit for limit in bound.limits):
        return Outcome.UNCLEAR, f"no further from the limit than the run's noise floor of {percent(noise)}"
    return (Outcome.HOLDS if inside else Outcome.FAILS), ""


def refusal(*points: Point) -> tuple[Outcome, str] | None:
    """The reason why cells cannot be compared: refused by the device or the budget, or not measured to the end."""
    for point in points:
        if point.status != "ok":
            outcome = Outcome.LEFT_OUT if point.ending.refused else Outcome.UNCLEAR
            return outcome, ": ".join(filter(None, (f"{point.method} is {point.sign}", point.cell.get("reason"))))
    return None
