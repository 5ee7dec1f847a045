"""Medians and their order-statistic intervals. Nothing is assumed of the distribution of the samples."""

from __future__ import annotations

import math
from collections.abc import Sequence
from fractions import Fraction
from functools import cache

Interval = tuple[float | None, float | None, float | None]  # low, median, high


@cache
def interval_rank(count: int, confidence: float = 0.95) -> int | None:
    """Largest rank r (1 is the least sample) for which [x_(r), x_(count+1-r)] holds the median.

    It does so with a probability of at least `confidence`: the number of samples below the median is
    binomial with p = 1/2, and each tail, P(fewer than r), may weigh (1 - confidence)/2. None where even
    the two extreme samples do not reach it (fewer than 6 samples for 0.95).
    """
    tail = (1 - Fraction(str(confidence))) / 2 * 2**count
    below, term, rank = 0, 1, 0
    while 2 * rank < count and below + term <= tail:
        below += term
        term = term * (count - rank) // (rank + 1)
        rank += 1
    return rank or None


def median_interval(samples: Sequence[float], confidence: float = 0.95) -> Interval:
    """Median of `samples` between the ends of its order-statistic interval, in the samples' unit.

    The ends are None where there are too few samples for the confidence; all three are None without
    samples. Raises ValueError for a sample that is not finite.
    """
    ordered = sorted(float(s) for s in samples)
    if not all(map(math.isfinite, ordered)):
        raise ValueError("a sample is not finite")
    if not ordered:
        return None, None, None
    count = len(ordered)
    median = (ordered[(count - 1) // 2] + ordered[count // 2]) / 2
    rank = interval_rank(count, confidence)
    if rank is None:
        return None, median, None
    return ordered[rank - 1], median, ordered[count - rank]


def ratio_interval(over: Sequence[float], under: Sequence[float], confidence: float = 0.95) -> Interval:
    """Ratio of the medians of two sample sets, with an interval of at least the given confidence.

    Two 97.5 % intervals hold both medians at once in at least 95 % of cases (Bonferroni), whether or
    not the sets depend on each other. Samples are positive. The ends are None where either set has too
    few samples (below 7 for 95 %), and all three are None where either is empty or the lower median is 0.
    """
    each = (1 + confidence) / 2
    over_low, over_median, over_high = median_interval(over, each)
    under_low, under_median, under_high = median_interval(under, each)
    if over_median is None or not under_median:
        return None, None, None
    if over_low is None or not under_low or under_high is None:
        return None, over_median / under_median, None
    return over_low / under_high, over_median / under_median, over_high / under_low
