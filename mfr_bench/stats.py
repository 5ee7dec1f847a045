"""Medians, ratios and their order-statistic intervals. Nothing is assumed of the distribution of the samples.

docs/measurement.md states what each promises, and what was measured of it.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from fractions import Fraction
from functools import cache
from itertools import pairwise, takewhile
from operator import mul
from statistics import median

Interval = tuple[float | None, float | None, float | None]  # low, median, high

GROWTH = 1.5  # of the number of samples from look to look
LOOK_SHARE = 0.8  # of the error allowed: what one look may err, so that stopping at any of them stays within it
LONG_ENOUGH_MS = 2.0  # of work of known size: below this the wall clock sees mostly the round trip to the device
SLOWER_REFERENCE = 1.2  # times the least time of the reference frame, from which on the device was slower than usual
CHANCE = 1.0  # standard errors of a correlation of 0 that count as chance


@cache
def interval_position(count: int, confidence: float = 0.95) -> float | None:
    """Rank p (1 is the least sample, between two ranks interpolated) for which [x_(p), x_(count+1-p)] holds the median.

    The number of samples below the median is binomial with p = 1/2. Between the last whole rank that reaches the
    confidence and the next, which does not, the ends are interpolated as Hettmansperger & Sheather (1986, Eq. 2)
    do, so that the coverage is close to `confidence` for any smooth distribution and not up to 3 % above it.
    None where even the two extreme samples do not reach it (fewer than 6 samples for 0.95).
    """
    wanted, whole = Fraction(str(confidence)), 2**count
    below, term, rank, reached = 0, 1, 0, Fraction(1)  # samples in fewer than `rank` places below, of 2**count
    while 2 * (rank + 1) <= count:
        below += term
        term = term * (count - rank) // (rank + 1)
        covered = 1 - Fraction(2 * below, whole)
        if covered < wanted:
            break
        rank, reached = rank + 1, covered
    else:
        return float(rank) or None
    if not rank:
        return None
    share = (reached - wanted) / (reached - covered)
    return rank + float((count - rank) * share / (rank + (count - 2 * rank) * share))


def whole_percents(shares: Sequence[float]) -> list[int]:
    """Shares of a whole, together 1, in whole percents that add up to 100, by the largest remainders.

    What is not certain is 99 % at most.
    """
    exact = [100 * share for share in shares]
    found = [math.floor(value + 1e-9) for value in exact]
    missing = 100 - sum(found)
    for at in sorted(range(len(found)), key=lambda at: found[at] - exact[at])[:missing]:
        found[at] += 1
    others = [at for at, share in enumerate(shares) if share > 0 and found[at] < 100]
    if others and 100 in found:
        found[found.index(100)] -= 1
        found[max(others, key=shares.__getitem__)] += 1
    return found


def median_interval(samples: Sequence[float], confidence: float = 0.95) -> Interval:
    """Median of `samples` between the ends of its order-statistic interval, in the samples' unit.

    The ends are None where there are too few samples for the confidence; all three are None without
    samples. Raises ValueError for a sample that is not finite.
    """
    return _interval(_ordered(samples), confidence, widened=1.0)


def sampled_interval(samples: Sequence[float], confidence: float = 0.95) -> Interval:
    """`median_interval` of samples in the order in which they were taken, until it was narrow enough.

    Two things would make it hold the median too rarely, and are made good. Who stops when an interval is narrow stops
    at lucky ones: each look errs in a share of LOOK_SHARE of what is allowed. And frames that follow one another are
    alike: the interval is that of as many independent samples as these are worth.
    """
    ordered = _ordered(samples)
    worth = _worth(samples, _middle(ordered)) if len(ordered) > 1 else 1.0
    return _interval(ordered, 1 - LOOK_SHARE * (1 - confidence), math.sqrt(1 / worth))


def _ordered(samples: Sequence[float]) -> list[float]:
    """The samples, sorted. Raises ValueError where one is not finite."""
    ordered = sorted(map(float, samples))
    if not all(map(math.isfinite, ordered)):
        raise ValueError("a sample is not finite")
    return ordered


def _middle(ordered: Sequence[float]) -> float:
    """The median of sorted samples."""
    half = len(ordered) // 2
    return ordered[half] if len(ordered) % 2 else (ordered[half - 1] + ordered[half]) / 2


def _interval(ordered: Sequence[float], confidence: float, widened: float) -> Interval:
    if not ordered:
        return None, None, None
    position = interval_position(len(ordered), round(confidence, 6))
    if position is None:
        return None, _middle(ordered), None
    middle = (len(ordered) + 1) / 2
    position = max(1.0, middle - (middle - position) * widened)
    return _at(ordered, position), _middle(ordered), _at(ordered, len(ordered) + 1 - position)


def _at(ordered: Sequence[float], position: float) -> float:
    """The value at a rank, from 1, of sorted samples; between two ranks interpolated, never outside of both."""
    rank = math.floor(position)
    low, high = ordered[rank - 1], ordered[min(rank, len(ordered) - 1)]
    return low if low == high else min(high, max(low, low + (position - rank) * (high - low)))


def _worth(samples: Sequence[float], middle: float) -> float:
    """Independent samples that each of these is worth: (1 - r)/(1 + r), r the correlation of neighbours' signs.

    A sample's sign is its side of the median, `middle`. What is within CHANCE of no correlation counts as none, and so
    does a negative one.
    """
    signs = [(s > middle) - (s < middle) for s in samples]
    mean = (sum(map(mul, signs, signs[1:])) + 1) / len(signs)  # -1/n is what independent samples come to
    r = min(0.9, max(0.0, mean - CHANCE / math.sqrt(len(signs))))
    return (1 - r) / (1 + r)


def ratio_interval(over: Sequence[float], under: Sequence[float], confidence: float = 0.95) -> Interval:
    """Ratio of the medians of two sets of samples in the order in which they were taken, with its interval.

    The distances of the ends from the medians are combined as those of independent estimates are (MOVER: Zou & Donner
    2008), on a logarithmic scale; where both sets drift alike, the interval is wider than need be. Samples are
    positive. The ends are None where either set has too few samples (below 6 for 95 %), and all three are None where
    either is empty or has a median of 0.
    """
    above, below = sampled_interval(over, confidence), sampled_interval(under, confidence)
    if not above[1] or not below[1]:
        return None, None, None
    ratio = above[1] / below[1]
    if not (above[0] and below[0]):
        return None, ratio, None
    (down, up), (down_below, up_below) = _log_distances(above), _log_distances(below)
    return ratio * math.exp(-math.hypot(down, up_below)), ratio, ratio * math.exp(math.hypot(up, down_below))


def _log_distances(interval: Interval) -> tuple[float, float]:
    low, middle, high = interval
    return math.log(middle / low), math.log(high / middle)


def goals(least: int, most: int) -> Iterator[int]:
    """Numbers of samples after which a sampler looks at them: 10, 15, 22, 33, … up to `most`."""
    goal = min(least, most)
    while goal < most:
        yield goal
        goal = min(most, max(goal + 1, int(goal * GROWTH)))
    yield most


def interleaved_ratio(over: Sequence[float], under: Sequence[float], least: int, most: int,
                      confidence: float = 0.95) -> Interval:
    """`ratio_interval` of samples that were taken in turns, batch by batch as `goals(least, most)` has it.

    Each batch of both is divided by what they have in common, the geometric mean of their medians: what slows both
    down alike leaves the interval. Samples without a counterpart are left out, for they are of another time.
    """
    shared = min(len(over), len(under))
    ends = [*takewhile(shared.__gt__, goals(least, most)), shared]
    above: list[float] = []
    below: list[float] = []
    for start, end in pairwise([0, *ends] if shared else []):
        common = math.sqrt(median(over[start:end]) * median(under[start:end]))
        if not common:
            return None, None, None
        above += [sample / common for sample in over[start:end]]
        below += [sample / common for sample in under[start:end]]
    return ratio_interval(above, below, confidence)


def real(ratio: Interval, noise: float) -> bool:
    """Whether a ratio tells two things apart: its interval leaves out 1, by no less than one thing measured twice
    differs from itself (`noise`, relative)."""
    low, middle, high = ratio
    return None not in ratio and not low <= 1 <= high and abs(middle - 1) > noise
