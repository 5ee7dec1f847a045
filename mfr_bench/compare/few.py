"""Bounds the distance of the median of a cell's samples from the cell's own, however few they are.

An order-statistic interval needs 6 samples, and with few more one stalled frame makes it as wide as the stall. So the
noise is pooled: the samples of all cells of both runs, each over its cell's median, show how far single frames lie
apart on this machine, tails included. A stall adds its milliseconds to a frame of any length, so that only frames as
long tell of a frame.
"""

from __future__ import annotations

import math
from array import array
from collections.abc import Iterable, Sequence
from functools import cache
from statistics import NormalDist, median, stdev

import numpy as np

from ..stats import sampled_interval

MEDIAN_EFFICIENCY = 1.2533  # standard error of a median over that of a mean, of normal samples
SHARES = (0.683, 0.9, 0.95, 0.99)  # quantiles of the pooled distances; a normal tail covers the widest of them
AS_LONG = 0.5  # of a frame's time, at least: the median of the cells whose frames tell of it
FRAMES_LEAST = 50  # that tell of it; the longest there are, where too few are as long
PRIOR_DEVIATION = 0.35  # of a frame time, logarithm, on a machine of which nothing is known: llvmpipe under load
PRIOR_FRAMES = 1  # frames' worth of evidence that the prior is
SLOWEST = 0.99
CONFIDENCE = 0.95
INNER = 0.68  # confidence of an interval that a stalled frame of 7 does not widen


class Frames:
    """The frames of many cells, each with its logarithmic distance from the median of its cell."""

    def __init__(self, cells: Iterable[Sequence[float]]):
        """Pool the samples of the cells, in ms. Cells of one sample contribute nothing."""
        usable = [samples for samples in cells if len(samples) > 1 and min(samples) > 0]
        counts = np.array([len(samples) for samples in usable], dtype=np.int64)
        medians_ms = np.repeat([median(samples) for samples in usable], counts)
        times_ms = np.array([time_ms for samples in usable for time_ms in samples])
        distances = _distances(times_ms, medians_ms, np.repeat(counts, counts))
        by_median = np.lexsort((distances, medians_ms))
        self._medians_ms = medians_ms[by_median]
        self._distances = np.sort(distances)
        places = np.empty(distances.size, dtype=np.int64)  # in the order of medians, of each frame among the distances
        places[np.argsort(distances[by_median], kind="stable")] = np.arange(distances.size)
        self._last = WaveletMatrix(places)

    def deviation(self, time_ms: float) -> float:
        """Deviation of the logarithm of one frame's time, of frames that take about so long.

        Of several quantiles the widest counts, each over that of a normal distribution: long tails make the deviation
        larger, never a slow frame significant.
        """
        near = self._near(time_ms)
        if not near:
            return PRIOR_DEVIATION
        own = max(self._at(near, share) / _quantile(share) for share in SHARES)
        weight = near / (near + PRIOR_FRAMES)
        return math.sqrt(weight * own**2 + (1 - weight) * PRIOR_DEVIATION**2)

    @property
    def count(self) -> int:
        """The number of frames."""
        return self._distances.size

    def burst(self, time_ms: float) -> float:
        """The logarithmic distance from the median of the slowest in a hundred frames of about this time.

        A burst of load that outlasts the sampling of a cell does that to all of its frames.
        """
        near = self._near(time_ms)
        return self._at(near, SLOWEST) if near else 0.0

    def _near(self, time_ms: float) -> int:
        """The number of frames of about such a time: the last ones in the order of medians."""
        size = self._distances.size
        return size - min(int(np.searchsorted(self._medians_ms, AS_LONG * time_ms)), max(0, size - FRAMES_LEAST))

    def _at(self, near: int, share: float) -> float:
        """The least distance that no smaller a share of the last frames reaches, of which there are `near`."""
        return float(self._distances[self._last.least(near, math.ceil(share * near) - 1)])


class WaveletMatrix:
    """The numbers 0, 1, 2, … in some order: the k-th least of the last of them, in as many steps as they have bits.

    By Claude, Navarro & Ordóñez (2015): a level for each bit, the highest first, has the numbers in the
    order in which the level before sorts them, and at each place how many before it have no such bit.
    """

    def __init__(self, numbers: np.ndarray):
        self._size = numbers.size
        self._levels: list[tuple[int, int, array[int]]] = []  # a bit, how many lack it, how many before each place do
        for bit in reversed(range(max(0, self._size - 1).bit_length())):
            lacking = numbers >> bit & 1 == 0
            before = np.concatenate(([0], np.cumsum(lacking))).astype(np.int64)
            self._levels.append((1 << bit, int(before[-1]), array("q", before.tobytes())))
            numbers = np.concatenate((numbers[lacking], numbers[~lacking]))

    def least(self, last: int, k: int) -> int:
        """The number before which, of the last ones, just k are less."""
        start, end, found = self._size - last, self._size, 0
        for bit, lack, before in self._levels:
            first, after = before[start], before[end]
            if k < after - first:
                start, end = first, after
            else:
                k, found = k - (after - first), found | bit
                start, end = lack + start - first, lack + end - after
        return found


def _distances(times_ms: np.ndarray, medians_ms: np.ndarray, counts: np.ndarray) -> np.ndarray:
    """Logarithmic distances of frames from the medians of their cells, which have `counts` frames each.

    They are made longer by what a median of so few lies too near to them.
    """
    return np.sqrt(counts / (counts - 1)) * np.abs(np.log(times_ms / medians_ms))


@cache
def _quantile(share: float) -> float:
    """The number of deviations that hold this share of a normal distribution."""
    return NormalDist().inv_cdf((1 + share) / 2)


def log_ratio(over: Sequence[float], under: Sequence[float], frames: Frames) -> tuple[float, float] | None:
    """Logarithm of the ratio of two medians, and its standard error; None where either has no time."""
    medians_ms = [median(side) if side else 0.0 for side in (over, under)]
    if not all(medians_ms):
        return None
    return math.log(medians_ms[0] / medians_ms[1]), math.hypot(*(_error(side, frames) for side in (over, under)))


def _error(samples: Sequence[float], frames: Frames) -> float:
    """Standard error of the logarithm of the median.

    By its interval; where that is wider than its inner one and the frames of all cells explain, by these.
    """
    logs = [math.log(sample) for sample in samples if sample > 0]
    efficiency = MEDIAN_EFFICIENCY if len(logs) > 2 else 1.0  # the median of one or two is their mean
    pooled = efficiency * frames.deviation(median(samples)) / math.sqrt(len(logs))
    outer, inner = (_by_interval(samples, confidence) for confidence in (CONFIDENCE, INNER))
    if outer is None:
        return max(pooled, efficiency * stdev(logs) / math.sqrt(len(logs)) if len(logs) > 1 else 0.0)
    return min(outer, max(inner, pooled))


def _by_interval(samples: Sequence[float], confidence: float) -> float | None:
    low, _, high = sampled_interval(samples, confidence)
    return math.log(high / low) / 2 / _quantile(confidence) if low and high else None
