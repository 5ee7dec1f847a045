"""How far the median of a cell's samples may be from the cell's own, however few they are.

An order-statistic interval needs 6 samples, and with few more one stalled frame makes it as wide as the stall. So the
noise is pooled: the samples of all cells of both runs, each over its cell's median, show how far single frames lie
apart on this machine, tails included. A stall adds its milliseconds to a frame of any length, so that only frames as
long tell of a frame.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from statistics import NormalDist, median, stdev

import numpy as np

from ..stats import ratio_interval, sampled_interval

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
        """From the samples of the cells, in ms. Cells of one sample tell nothing."""
        told = sorted((median(samples), distance) for samples in cells for distance in _distances(samples))
        self._medians_ms, self._distances = np.array(told).reshape(-1, 2).T

    def deviation(self, time_ms: float) -> float:
        """Deviation of the logarithm of one frame's time, of frames that take about so long.

        Of several quantiles the widest counts, each over that of a normal distribution: long tails make the deviation
        larger, never a slow frame significant.
        """
        near = self._near(time_ms)
        if not near.size:
            return PRIOR_DEVIATION
        own = max(_at(near, share) / _quantile(share) for share in SHARES)
        weight = near.size / (near.size + PRIOR_FRAMES)
        return math.sqrt(weight * own**2 + (1 - weight) * PRIOR_DEVIATION**2)

    def burst(self, time_ms: float) -> float:
        """How far the slowest in a hundred frames that take about so long lie from the median, logarithmic.

        A burst of load that outlasts the sampling of a cell does that to all of its frames.
        """
        near = self._near(time_ms)
        return _at(near, SLOWEST) if near.size else 0.0

    def _near(self, time_ms: float) -> np.ndarray:
        """Distances of the frames that tell of such a time, ascending."""
        shorter = np.searchsorted(self._medians_ms, AS_LONG * time_ms)
        return np.sort(self._distances[min(shorter, max(0, self._distances.size - FRAMES_LEAST)):])


def _at(ascending: np.ndarray, share: float) -> float:
    """The least value that no smaller a share of all values reaches."""
    return float(ascending[math.ceil(share * ascending.size) - 1])


def _distances(samples: Sequence[float]) -> list[float]:
    """Logarithmic distances from the median, made longer by what a median of so few lies too near to them."""
    if len(samples) < 2 or min(samples) <= 0:
        return []
    middle, scale = median(samples), math.sqrt(len(samples) / (len(samples) - 1))
    return [scale * abs(math.log(sample / middle)) for sample in samples]


def _quantile(share: float) -> float:
    """How many deviations hold this share of a normal distribution."""
    return NormalDist().inv_cdf((1 + share) / 2)


def log_ratio(over: Sequence[float], under: Sequence[float], frames: Frames) -> tuple[float, float] | None:
    """Logarithm of the ratio of two medians, and its standard error; None where either has no time."""
    ratio = ratio_interval(over, under, CONFIDENCE)[1]
    return (math.log(ratio), math.hypot(*(_error(side, frames) for side in (over, under)))) if ratio else None


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
