"""Runs on a machine that other work slows down for some milliseconds now and then: cells sampled in turns, as runs do.

Bursts are at times, so that neighbouring frames share them, which no distribution of frames has. Their share (3 % of
the time), lengths and factors are those that two shared cores showed without any load of ours.
"""

from __future__ import annotations

from bisect import bisect_right
from dataclasses import dataclass, field
from random import Random
from statistics import median

from mfr_bench.config.model import Measure
from mfr_bench.measure.sampling import Sampler
from mfr_bench.run.cell import noise_floor_rel, pair_of

from .planted import SCENES, cell, side

METHODS = 14
SHORTEST_MS, GROWTH = 0.2, 1.33  # of a method's frame at 16 layers, from method to method
CV, SHIFT, LOAD = 0.01, 0.015, 0.03  # deviations: of frames, of cells and of whole runs
GAP_MS, SHORT_MS, LONG_MS, LONG_SHARE = 900.0, 15.0, 150.0, 0.1  # between bursts, and of bursts, in the mean
SLOWED = (1.3, 1.9)  # times as long, within a burst
STALLS, STALL_MS = 0.01, 1.0  # share of the frames that are held up, and how long in the mean
MEASURE = Measure(target_rel_ci=0.05, min_samples=7, max_samples=50, time_limit_s=0.2)


@dataclass
class Clock:
    """The clock of a run, and when it is slowed."""

    random: Random
    now_ms: float = 0.0
    starts: list[float] = field(default_factory=list)
    bursts: list[tuple[float, float]] = field(default_factory=list)  # ends, and factors

    def frame(self, whole_ms: float) -> float:
        """The time of a frame that takes so long by itself."""
        self._reach(self.now_ms + 2 * whole_ms)
        own = whole_ms * self.random.lognormvariate(0, CV)
        at = bisect_right(self.starts, self.now_ms) - 1
        end, factor = self.bursts[at] if at >= 0 else (0.0, 1.0)
        slowed = min(own, max(0.0, end - self.now_ms) / factor)
        stalled = self.random.expovariate(1 / STALL_MS) if self.random.random() < STALLS else 0.0
        time_ms = own + slowed * (factor - 1) + stalled
        self.now_ms += time_ms
        return time_ms

    def _reach(self, until_ms: float) -> None:
        while not self.starts or self.starts[-1] <= until_ms:
            mean = LONG_MS if self.random.random() < LONG_SHARE else SHORT_MS
            start = (self.bursts[-1][0] if self.bursts else 0.0) + self.random.expovariate(1 / GAP_MS)
            self.starts.append(start)
            self.bursts.append((start + self.random.expovariate(1 / mean), self.random.uniform(*SLOWED)))


def run(seed: int, method: int = 0, scene: int = 0, factor: float = 1.0):
    """A run of 28 cells as a side of a comparison; the frames of one are `factor` times as long."""
    random = Random(seed)  # noqa: S311 - no secret
    clock, cells, noise = Clock(random), [], None
    load = random.lognormvariate(0, LOAD)
    for layers in SCENES:
        whole_ms = [load * SHORTEST_MS * GROWTH**m * layers / 16 * random.lognormvariate(0, SHIFT)
                    * (factor if (m, layers) == (method, scene) else 1.0) for m in range(METHODS)]
        samplers, floor = sampled(clock, whole_ms, random, floor=noise is None)
        noise = noise if floor is None else floor
        cells += [cell(f"m{m}", s.samples_ms, {"depth_complexity": layers}) for m, s in enumerate(samplers)]
    return side(cells, noise=noise)


def sampled(clock: Clock, whole_ms, random: Random, floor: bool):
    """The samplers of cells that take turns, and the noise floor, where one is asked for."""
    samplers, pair = [Sampler(MEASURE) for _ in whole_ms], ()
    entries = list(zip(samplers, whole_ms, strict=True))
    while entries:
        random.shuffle(entries)
        for sampler, frame_ms in entries:
            for _ in sampler.turn():
                sampler.add(clock.frame(frame_ms))
        if floor and not pair:
            middle = sorted(range(len(samplers)), key=lambda m: median(samplers[m].samples_ms))[len(samplers) // 2]
            pair = pair_of(MEASURE)
            entries += [(sampler, whole_ms[middle]) for sampler in pair]
        entries = [(sampler, frame_ms) for sampler, frame_ms in entries if sampler.wanted]
    return samplers, noise_floor_rel(*pair) if pair else None
