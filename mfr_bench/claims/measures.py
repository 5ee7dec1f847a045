"""The quantities that rules compare: times, and exact counts."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from ..report.data import Point, time_ratio
from ..stats import Interval, ratio_interval
from ..store.columns import VALUES
from .evidence import NOTHING


@dataclass(frozen=True)
class Quantity:
    """A quantity of a cell: samples of a time in ms, a factor that is counted, or the product or quotient of both."""

    words: str
    samples: Callable[[Point], Sequence[float]] | None = None
    factor: Callable[[Point], float | None] | None = None
    divides: bool = False  # the time is divided by the factor

    @property
    def exact(self) -> bool:
        return self.samples is None

    def ratio(self, over: Point, under: Point, confidence: float = 0.95) -> Interval:
        """The quantity of one cell over that of another, with its interval; nothing where either lacks it."""
        scale = 1.0
        if self.factor:
            above, below = self.factor(over), self.factor(under)
            if not above or not below:
                return NOTHING
            scale = below / above if self.divides else above / below
        if not self.samples:
            return scale, scale, scale
        low, value, high = (time_ratio(over.cell, under.cell, confidence) if self.samples is frame_ms
                            else ratio_interval(self.samples(over), self.samples(under), confidence))
        return tuple(None if end is None else end * scale for end in (low, value, high))


def frame_ms(point: Point) -> Sequence[float]:
    return point.cell.get("samples_ms") or []


def pass_ms(point: Point, *names: str) -> Sequence[float]:
    """Samples of the first of these passes that the cell has."""
    passes = point.cell.get("passes") or {}
    return next((passes[name] for name in names if passes.get(name)), [])


def column(name: str) -> Callable[[Point], float | None]:
    """A value of the cell, or one that follows from its values."""
    return lambda point: point.cell["values"].get(name) if name in VALUES else point.measure(name)[1]


TIME = Quantity("time", samples=frame_ms)
# Fig. 8 of kplus_2015 says ms per MB; read as a cost, as the fps per MB of kplus_2014 has it: dividing by the memory
# would reward a method for using more.
COST = Quantity("ms × MB", samples=frame_ms, factor=column("memory_bytes"))
PRINTED_COST = Quantity("ms / MB", samples=frame_ms, factor=column("memory_bytes"), divides=True)
MEMORY = Quantity("memory", factor=column("memory_bytes"))


def pass_time(*names: str) -> Quantity:
    return Quantity(f"time of the {' pass, else '.join(names)} pass", samples=lambda point: pass_ms(point, *names))


def counted(name: str) -> Quantity:
    return Quantity(name.replace("_", " "), factor=column(name))
