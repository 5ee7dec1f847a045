"""Finds the fastest of several methods by rounds of one frame each, in which the clearly slower leave early.

In a round every method that is left draws one frame, in random order. Two methods are compared within rounds only, so
that what slows a round down hits both. A method leaves when another one is better by a test that may be looked at
after every round: the mixture likelihood ratio of a binomial share, a supermartingale under its hypothesis (Robbins
1970; Ville's inequality bounds the chance that it ever passes 1/p by p). Three hypotheses are tested, which the
fastest method fulfils:

    its frame is the longer one in at most 1/2 of the rounds
    its frame takes more than 2 times the other's in at most 1/8 of them
    its frame takes more than 4 times the other's in at most 1/64 of them

The first is what "fastest" means, by the median of the ratio; the others are assumptions about noise, by which a
method that takes several times as long leaves after three to five frames (docs/measurement.md has what was measured
of them). They are used only as long as the frames bear them out: while, of the frames of all methods, no larger share
takes more than 2 or 4 times the lower quartile of its method's.

The rounds end before one method is left if those that are left are no better than the leader: an indifference zone, as
in Paulson's procedure (Annals of Mathematical Statistics 35, 1964) and that of Kim and Nelson (ACM TOMACS 11, 2001),
but by a test that assumes no normal noise. A fourth hypothesis is tested of each of them:

    it is better by the zone: 1 + `indifference` times its frame is the longer one in at most 1/2 of the rounds

Each hypothesis takes a fourth of the chance. So the chance of dropping the fastest method, or of ending with a leader
that takes more than 1 + `indifference` times as long, is at most `chance`, all comparisons and rounds together.
"""

from __future__ import annotations

import math
import random
from bisect import bisect_right, insort
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from statistics import median

CHANCE = 0.01  # of dropping the fastest method
INDIFFERENCE = 0.02  # methods whose times differ by less are as good as each other
RESAMPLES = 400  # of the rounds, for the chance that a method is the best
HYPOTHESES = ((1.0, 1 / 2), (2.0, 1 / 8), (4.0, 1 / 64))  # factor, and share of the rounds at most
LATE = "the pooled time of the elimination left none to prepare it; a longer measure.time_limit_s does"
LEAST_ROUNDS = 6  # before they end: the fewest whose median has an interval
QUARTILE = 0.25  # of a method's frames: those that nothing held up


@dataclass(frozen=True)
class Dropped:
    """A method that left: after which round, to whom, and the median of the ratio of their times."""

    method: str
    after_round: int
    to: str
    ratio: float


@cache
def evidence(hits: int, rounds: int, share: float) -> float:
    """Logarithm of the likelihood ratio against "at most `share` of the rounds are hits".

    The alternatives are all larger shares, each as likely as another. Never above log(1/p) with a chance above p where
    the hypothesis is true, however often it is looked at.
    """
    steps = 64  # of the midpoint rule over the larger shares: a finite mixture is a supermartingale as well
    width = (1 - share) / steps
    logs = []
    for step in range(steps):
        larger = share + (step + 0.5) * width
        logs.append(hits * math.log(larger / share) + (rounds - hits) * math.log((1 - larger) / (1 - share)))
    most = max(logs)
    return most + math.log(sum(math.exp(value - most) for value in logs) / steps)


class Elimination:
    """Rounds of frame times, and who is left of the methods.

    may_drop: whether a method that is faster, the first, may make one that is slower leave, the second.
    """

    def __init__(self, methods: Sequence[str], may_drop: Callable[[str, str], bool] = lambda faster, slower: True,
                 chance: float = CHANCE, indifference: float = INDIFFERENCE):
        if len(set(methods)) < len(methods) or not methods:
            raise ValueError("methods: allowed: one or more, each once")
        self.left = list(methods)
        self.rounds: list[dict[str, float]] = []
        self.dropped: list[Dropped] = []
        self._zone = 1 / (1 + indifference)
        self._may_drop = may_drop
        self._limit = math.log((len(HYPOTHESES) + 1) * max(1, len(methods) - 1) / chance)
        self._hits: dict[tuple[str, str, float], int] = {}
        self._frames: dict[str, list[float]] = {method: [] for method in methods}  # of each, ascending

    def add(self, times_ms: Mapping[str, float]) -> list[Dropped]:
        """Take the times of a round, one for each method that is left. Returns who leaves after it."""
        if set(times_ms) != set(self.left):
            raise ValueError(f"a round has a time for each of {', '.join(self.left)}")
        self.rounds.append(dict(times_ms))
        for method, time_ms in times_ms.items():
            insort(self._frames[method], time_ms)
        factors = [self._zone, *(factor for factor, _ in HYPOTHESES)]
        for method in self.left:
            for other in self.left:
                for factor in factors:
                    if times_ms[method] > factor * times_ms[other]:
                        key = method, other, factor
                        self._hits[key] = self._hits.get(key, 0) + 1
        return self._leaving()

    def remove(self, method: str) -> None:
        """Take out a method that can draw no more."""
        self.left.remove(method)

    def _leaving(self) -> list[Dropped]:
        leaving: dict[str, Dropped] = {}
        tested = [(factor, share) for factor, share in HYPOTHESES if self._borne_out(factor, share)]
        for method in sorted(self.left, key=self.time_ms, reverse=True):  # nobody leaves to one that leaves
            beaten = next((other for other in (self.leader, *self.left) if other != method and other not in leaving
                           and self._may_drop(other, method) and self._slower(method, other, tested)), None)
            if beaten:
                leaving[method] = Dropped(method, len(self.rounds), beaten, self.ratio(method, beaten))
        self.left = [method for method in self.left if method not in leaving]
        self.dropped += leaving.values()
        return list(leaving.values())

    def _borne_out(self, factor: float, share: float) -> bool:
        """Whether the noise of the frames so far is such that the hypothesis may hold."""
        if factor == 1.0:
            return True  # what "fastest" means, whatever the noise
        slow = (len(frames) - bisect_right(frames, factor * frames[int(QUARTILE * len(frames))])
                for frames in self._frames.values() if frames)
        return sum(slow) <= share * sum(map(len, self._frames.values()))

    def _slower(self, method: str, other: str, tested: Sequence[tuple[float, float]]) -> bool:
        return any(self._refuted(method, other, factor, share) for factor, share in tested)

    def _refuted(self, method: str, other: str, factor: float, share: float) -> bool:
        """Whether its frame is longer than `factor` times the other's in more than that share of the rounds."""
        return evidence(self._hits.get((method, other, factor), 0), len(self.rounds), share) > self._limit

    @property
    def leader(self) -> str:
        """The method that is left with the lowest median time."""
        return min(self.left, key=self.time_ms)

    def time_ms(self, method: str) -> float:
        """The median of the method's times."""
        return median(times[method] for times in self.rounds if method in times)

    def ratio(self, method: str, other: str) -> float:
        """The median, over the rounds of both, of the method's time over the other's."""
        return median(times[method] / times[other] for times in self.rounds if method in times and other in times)

    @property
    def decided(self) -> bool:
        """Whether more rounds change nothing that matters: one method is left, or none is better than the leader.

        None is better where the rounds refute, of each, that the leader takes more than 1 + `indifference` times as
        long. A method that the leader may not drop does not keep it undecided.
        """
        if len(self.rounds) < LEAST_ROUNDS:
            return False
        leader = self.leader
        return all(self._refuted(method, leader, self._zone, 1 / 2) for method in self.left
                   if method != leader and self._may_drop(leader, method))

    def chances(self, seed: int = 0) -> dict[str, float]:
        """The chance of each method that is left to be the fastest, by resampling the rounds.

        What a round's times have in common is divided out. Before any round all have the same chance, which counts as
        much as one round does: a few rounds, resampled, know nothing of what they did not see. Methods that left share
        what `chance` allows; it is not in these numbers.
        """
        pick = random.Random(seed)  # noqa: S311 - resampling, no secret
        rounds = [{method: times[method] / common for method in self.left}
                  for times in self.rounds for common in [median(times[method] for method in self.left)]]
        best = dict.fromkeys(self.left, 0)
        for _ in range(RESAMPLES):
            drawn = pick.choices(rounds, k=len(rounds))
            best[min(self.left, key=lambda method: median(times[method] for times in drawn))] += 1
        seen = len(rounds) / (len(rounds) + 1)
        return {method: seen * count / RESAMPLES + (1 - seen) / len(best) for method, count in best.items()}
