"""How far the median of a cell's samples may be from the cell's own, however few they are.

An order-statistic interval needs 6 samples. Below that the noise is pooled: the samples of all cells of both runs,
each over its cell's median, show how far single frames lie apart on this machine, tails included.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from statistics import NormalDist, median, stdev

from ..stats import ratio_interval, sampled_interval

MEDIAN_EFFICIENCY = 1.2533  # standard error of a median over that of a mean, of normal samples
POOLED_SHARES = (0.683, 0.9, 0.95, 0.99)  # quantiles of the pooled distances; a normal tail covers the widest of them
PRIOR_DEVIATION = 0.25  # of a frame time, logarithm, on a machine of which nothing is known: llvmpipe under load
PRIOR_SAMPLES = 1  # samples' worth of evidence that the prior is
CONFIDENCE = 0.95


def frame_deviation(cells: Iterable[Sequence[float]]) -> float:
    """Deviation of the logarithm of one frame time, from the samples of many cells (ms, positive).

    Of several quantiles of the samples' distances from their cell's median the widest counts, each over that of a
    normal distribution: long tails make the deviation larger, never a slow frame significant.
    """
    distances = sorted(distance for samples in cells for distance in _distances(samples))
    if not distances:
        return PRIOR_DEVIATION
    normal = NormalDist()
    own = max(distances[math.ceil(share * len(distances)) - 1] / normal.inv_cdf((1 + share) / 2)
              for share in POOLED_SHARES)
    return math.sqrt((len(distances) * own**2 + PRIOR_SAMPLES * PRIOR_DEVIATION**2) / (len(distances) + PRIOR_SAMPLES))


def _distances(samples: Sequence[float]) -> list[float]:
    """Logarithmic distances from the median, made longer by what a median of so few lies too near to them."""
    middle = median(samples) if len(samples) > 1 else 0
    if not middle or min(samples) <= 0:
        return []
    scale = math.sqrt(len(samples) / (len(samples) - 1))
    return [scale * abs(math.log(sample / middle)) for sample in samples]


def log_ratio(over: Sequence[float], under: Sequence[float], deviation: float) -> tuple[float, float] | None:
    """Logarithm of the ratio of two medians, and its standard error; None where either has no time.

    `deviation`: of one frame, from `frame_deviation`; it serves the sides whose samples are too few for an interval.
    """
    low, ratio, high = ratio_interval(over, under, CONFIDENCE)
    if not ratio:
        return None
    if low and high:
        return math.log(ratio), _error(low, high)
    return math.log(ratio), math.hypot(_median_error(over, deviation), _median_error(under, deviation))


def _error(low: float, high: float) -> float:
    return math.log(high / low) / 2 / NormalDist().inv_cdf((1 + CONFIDENCE) / 2)


def _median_error(samples: Sequence[float], deviation: float) -> float:
    """Standard error of the logarithm of the median: by its interval, else by the pooled deviation or its own."""
    low, _, high = sampled_interval(samples, CONFIDENCE)
    if low and high:
        return _error(low, high)
    logs = [math.log(sample) for sample in samples if sample > 0]
    own = stdev(logs) if len(logs) > 1 else 0.0
    efficiency = MEDIAN_EFFICIENCY if len(samples) > 2 else 1.0  # the median of one or two is their mean
    return efficiency * max(deviation, own) / math.sqrt(len(samples))
