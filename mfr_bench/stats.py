"""Medians, ratios and their order-statistic intervals. Nothing is assumed of the distribution of the samples.

docs/measurement.md states what each promises, and what was measured of it.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from fractions import Fraction
from functools import cache
from itertools import pairwise
from operator import mul
from statistics import median

Interval = tuple[float | None, float | None, float | None]  # low, median, high

GROWTH = 1.5  # of the number of samples from look to look
TURNS = 3  # that a batch takes: frames of one turn are alike, and a burst of load that hits one leaves the median alone
FEWEST = 6  # samples of each side, below which a ratio has no interval, as a median has none
T_STEPS = 256  # of half of the range of a t, see `t_quantile`
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


@cache
def turns(count: int, least: int, most: int) -> tuple[slice, ...]:
    """The places of the first `count` samples by the turns that took them: each batch of `goals` takes TURNS of them.

    Where samples were taken again, or turns were cut short, these are stretches of about a turn.
    """
    found: list[slice] = []
    for start, end in pairwise([0, *goals(least, most)]):
        step = math.ceil((end - start) / TURNS)
        found += [slice(at, min(at + step, end, count)) for at in range(start, min(end, count), step)]
    return tuple(found)


def interleaved_ratio(over: Sequence[float], under: Sequence[float], least: int, most: int,
                      confidence: float = 0.95) -> Interval:
    """Ratio of two sets of samples that were taken in turns, as `turns` has them, with its interval.

    The turn is the independent unit: frames of one are alike. Of each turn that both sides have, the medians are
    compared, and the interval is that of the median of these ratios, which what slows both down alike leaves as they
    are. Where so few turns have no such interval (below 6 for 95 %), it is that of Welch's t of the logarithms of the
    medians, as of turns that have nothing in common. Samples without a counterpart are left out, for they are of
    another time. The ends are None below FEWEST samples or 2 turns, and all three are None where either side is empty
    or has a turn of 0.
    """
    shared = min(len(over), len(under))
    places = turns(shared, least, most)
    above, below = _turn_logs(over, places), _turn_logs(under, places)
    if not above or not below:
        return None, None, None
    ratios = [a - b for a, b in zip(above, below, strict=True)]
    logs = median_interval(ratios, confidence)
    if logs[0] is None:
        logs = _welch(above, below, confidence) if shared >= FEWEST else (None, median(above) - median(below), None)
    low, middle, high = (None if end is None else math.exp(end) for end in logs)
    return low, middle, high


def apart(over: Sequence[float], under: Sequence[float], least: int, most: int) -> float | None:
    """How far two sets of samples of one thing, taken in turns, are apart: of their ratio from 1, relative.

    It is the end of `interleaved_ratio` that is further from 1. Where turns are too few for an interval of their own,
    it is the turn whose ratio is: a distribution of two or three would tell of anything. None below FEWEST samples.
    """
    shared = min(len(over), len(under))
    places = turns(shared, least, most)
    ratios = [a - b for a, b in zip(_turn_logs(over, places), _turn_logs(under, places), strict=False)]
    if shared < FEWEST or not ratios:
        return None
    low, _, high = median_interval(ratios)
    ends = (min(ratios), max(ratios)) if low is None or high is None else (low, high)
    return max(abs(math.expm1(end)) for end in ends)


def ratio_of_all_turns(over: Sequence[float], under: Sequence[float], least: int, most: int,
                       confidence: float = 0.95) -> Interval:
    """`interleaved_ratio` of all turns of both sides, as many as each has, by Welch's t."""
    above, below = (_turn_logs(samples, turns(len(samples), least, most)) for samples in (over, under))
    if not above or not below:
        return None, None, None
    low, middle, high = (None if end is None else math.exp(end) for end in _welch(above, below, confidence))
    return low, middle, high


def _turn_logs(samples: Sequence[float], places: Iterable[slice]) -> list[float]:
    """The logarithm of each turn's median; none where one of them is 0."""
    medians = [median(samples[place]) for place in places]
    return list(map(math.log, medians)) if all(medians) else []


def _welch(above: Sequence[float], below: Sequence[float], confidence: float) -> Interval:
    """The difference of two sides' medians between the ends of Welch's t interval; ends are None below 2 of a side."""
    middle = median(above) - median(below)
    if min(len(above), len(below)) < 2:
        return None, middle, None
    parts = [_variance(side) / len(side) for side in (above, below)]
    if not sum(parts):
        return middle, middle, middle
    freedom = sum(parts) ** 2 / sum(part**2 / (len(side) - 1) for part, side in zip(parts, (above, below), strict=True))
    half = t_quantile(round(freedom, 2), confidence) * math.sqrt(sum(parts))
    return middle - half, middle, middle + half


def _variance(values: Sequence[float]) -> float:
    mean = sum(values) / len(values)
    return sum((value - mean) ** 2 for value in values) / (len(values) - 1)


@cache
def t_quantile(freedom: float, confidence: float) -> float:
    """The half-width, in standard errors, within which Student's t of so many degrees of freedom (>= 1) stays.

    With t = sqrt(freedom) tan(a), the density of a is that of cos(a)**(freedom - 1), summed up at T_STEPS angles. Up to
    a confidence of 0.99 the error is below a hundredth.
    """
    step = math.pi / 2 / T_STEPS
    weights = [math.cos((number + 0.5) * step) ** (freedom - 1) for number in range(T_STEPS)]
    left = confidence * sum(weights)
    for number, weight in enumerate(weights):
        if weight >= left:
            return math.sqrt(freedom) * math.tan((number + left / weight) * step)
        left -= weight
    raise ValueError(f"{confidence} is no confidence below 1")


def real(ratio: Interval, noise: float) -> bool:
    """Whether a ratio tells two things apart: its interval leaves out 1, by no less than one thing measured twice
    differs from itself (`noise`, relative)."""
    low, middle, high = ratio
    return None not in ratio and not low <= 1 <= high and abs(middle - 1) > noise
