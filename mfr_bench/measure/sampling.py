"""Decides from the samples so far whether a cell needs more: warm-up, growing batches in three turns each, stop.

A `Sampler` is fed one time after another and says what it wants next, so that the caller can interleave the
frames of several methods.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator
from dataclasses import dataclass, field
from statistics import median

from ..config.settings import Measure
from ..plan.forecast import SETTLED_MS, WARMUP_SHARE
from ..stats import TURNS, Interval, goals, sampled_interval

WARMUP_FRAMES = (2, 4, 8, 16, 32)  # looked at after so many
CONFIRMED = 3  # samples, at least, where the first that reached the time limit is not like the fastest frame
LONE_FRAMES = 3  # to warm up, at most, where one sample follows: slow ones may be stalls, or compile
STALLED = 2.0  # times the fastest frame, from which on a sample may be a stall
HALVES_AGREE = 0.05  # of the later half's fastest frame, by which that of the earlier may be slower


def halves_agree(times_ms: list[float]) -> bool:
    """Whether the later half of the times is no faster than the earlier, within 5 %.

    The fastest frame of each half tells: other load makes frames slower, never faster, and is no sign of a warm-up.
    """
    middle = len(times_ms) // 2
    early, late = min(times_ms[:middle]), min(times_ms[middle:])
    return early - late <= HALVES_AGREE * late


@dataclass
class Sampler:
    """Samples of one cell, in ms. `wanted` frames are asked for next; 0 when it is done."""

    measure: Measure
    warmup_ms: list[float] = field(default_factory=list)
    samples_ms: list[float] = field(default_factory=list)
    aside_ms: list[float] = field(default_factory=list)  # samples that were taken back
    stop_reason: str | None = None
    warm: bool = False
    spent_s: float = 0.0  # in frames, warm-up included
    _settling: bool = False  # whether the next frame is drawn for the caches alone

    def __post_init__(self) -> None:
        self._goals = goals(self.measure.min_samples, self.measure.max_samples)
        self._goal = next(self._goals)
        self._begun = 0  # samples before this batch

    @property
    def interval(self) -> Interval:
        """Low, median, high of the frame time in ms."""
        return sampled_interval(self.samples_ms)

    @property
    def rel_half_width(self) -> float | None:
        """Half the interval's width over the median; None while there is no interval."""
        low, middle, high = self.interval
        return (high - low) / 2 / middle if low is not None and high is not None and middle else None

    @property
    def precise(self) -> bool:
        width = self.rel_half_width
        return width is not None and width <= self.measure.target_rel_ci

    @property
    def noisy(self) -> bool:
        """Whether it stopped with a wider interval than was asked for."""
        return self.stop_reason is not None and not self.precise

    @property
    def wanted(self) -> int:
        """Frames to time next."""
        if self.stop_reason:
            return 0
        if not self.warm:
            return next(n for n in WARMUP_FRAMES if n > len(self.warmup_ms)) - len(self.warmup_ms)
        left = self._goal - len(self.samples_ms)
        return min(left, math.ceil((self._goal - self._begun) / TURNS))

    def turn(self) -> Iterator[None]:
        """A frame at a time of one turn: a third of a batch, the first one with all of the warm-up before it.

        So the batches of methods that take turns are drawn close to each other, however long each took to warm up, and
        samples do not all fall into one burst of load. A short frame that follows those of another method is slower
        than the next, and does not count.
        """
        self._settling = self.warm and bool(self.wanted) and median(self.samples_ms or self.warmup_ms) < SETTLED_MS
        if self._settling:
            yield
        while not self.warm and not self.stop_reason:
            yield
        for _ in range(self.wanted):
            if not self.stop_reason:
                yield

    def resume(self, samples_ms: list[float]) -> None:
        """Go on from samples of an earlier process; this one warms up first, unless they are enough."""
        self.samples_ms = list(samples_ms)
        self.spent_s = sum(samples_ms) / 1e3
        if samples_ms and self.spent_s >= self.measure.time_limit_s:
            self.stop_reason = "precise" if self.precise else "time limit"
        while not self.stop_reason and len(self.samples_ms) >= self._goal:
            self._next_batch()

    def take(self, time_ms: float) -> None:
        """Take one frame's time of a round, whose end another decides."""
        self.warm = True
        self.spent_s += time_ms / 1e3
        self.samples_ms.append(time_ms)

    def set_aside(self, numbers: Collection[int]) -> None:
        """Take back the samples of these numbers: something slowed the device down meanwhile.

        Where samples of earlier batches are among them, the batch begins anew from what is left, in three turns again.
        """
        taken_ms = [self.samples_ms[number] for number in numbers]
        self.samples_ms = [ms for number, ms in enumerate(self.samples_ms) if number not in numbers]
        self.aside_ms += taken_ms
        self.spent_s -= sum(taken_ms) / 1e3
        self._begun = min(self._begun, len(self.samples_ms))
        self.stop_reason = None

    def interrupt(self) -> bool:
        """Stop here. Whether there are samples enough to keep."""
        self.stop_reason = self.stop_reason or "interrupted"
        return len(self.samples_ms) >= min(self.measure.min_samples, self.measure.max_samples)

    def add(self, time_ms: float) -> None:
        """Take one frame's time and decide what follows."""
        self.spent_s += time_ms / 1e3
        if self._settling:
            self._settling = False
            self.warmup_ms.append(time_ms)
            return
        if not self.warm:
            self.warmup_ms.append(time_ms)
            self.warm = self._warmed_up()
            return
        self.samples_ms.append(time_ms)
        if self.spent_s >= self.measure.time_limit_s and self._confirmed():
            self.stop_reason = "precise" if self.precise else "time limit"
        elif len(self.samples_ms) >= self._goal:
            self._next_batch()

    def _confirmed(self) -> bool:
        """Whether so few samples may stand for the cell: one stalled frame must not, however long it took."""
        if len(self.samples_ms) >= min(CONFIRMED, self.measure.max_samples):
            return True
        return max(self.samples_ms) <= STALLED * min(self.samples_ms + self.warmup_ms)

    def _warmed_up(self) -> bool:
        count = len(self.warmup_ms)
        if self.measure.single:
            return self.warmup_ms[-1] / 1e3 <= self.measure.time_limit_s or count >= LONE_FRAMES
        if sum(self.warmup_ms) / 1e3 >= WARMUP_SHARE * self.measure.time_limit_s or count >= WARMUP_FRAMES[-1]:
            return True
        return count in WARMUP_FRAMES and halves_agree(self.warmup_ms)

    def _next_batch(self) -> None:
        if self.precise:
            self.stop_reason = "precise"
        elif len(self.samples_ms) >= self.measure.max_samples:
            self.stop_reason = "most samples"
        else:
            self._begun, self._goal = self._goal, next(self._goals)
