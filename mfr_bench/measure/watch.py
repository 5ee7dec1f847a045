"""Tells whether the device was slower while samples were taken than in the best of times, and waits until it is not."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass

from ..stats import SLOWER_REFERENCE

SHARE = 0.1  # of the time of all turns, that a run may spend to take turns again, and to wait
PAUSE_S = 0.05  # between two looks while waiting
RECENT_S = 0.02  # for so long a look tells of the moment: one after a turn is that before the next


@dataclass
class Turn:
    """What the reference frame showed around one turn: its longer time, and whether that is slower than usual."""

    reference_ms: float | None = None
    slower: bool = False
    took_s: float = 0.0


class Watch:
    """Times a reference frame before and after each turn of samples.

    draw_ms: draws the reference frame, as often as the best time so far asks for, and returns its time in ms. clock,
    sleep: in seconds.
    """

    def __init__(self, draw_ms: Callable[[float], float], clock: Callable[[], float] = time.monotonic,
                 sleep: Callable[[float], None] = time.sleep):
        self._draw_ms, self._clock, self._sleep = draw_ms, clock, sleep
        self.best_ms = math.inf  # of the reference so far
        self._last = -math.inf, math.inf  # when it was looked at, and what that showed
        self._turns_s = self._spent_s = 0.0

    def look(self) -> float:
        """The time of the reference now, in ms; the more often it is looked at, the surer is its best."""
        now_ms = self._draw_ms(self.best_ms)
        self._last = self._clock(), now_ms
        self.best_ms = min(self.best_ms, now_ms)
        return now_ms

    def _recent(self) -> float:
        """What the last look showed, or another one where that is long ago."""
        at_s, last_ms = self._last
        return last_ms if self._clock() - at_s <= RECENT_S else self.look()

    @contextmanager
    def turn(self) -> Iterator[Turn]:
        """Watch a turn; what is yielded tells of it when the turn has ended."""
        seen, before_ms, begun_s = Turn(), self._recent(), self._clock()
        yield seen
        seen.took_s = self._clock() - begun_s
        self._turns_s += seen.took_s
        seen.reference_ms = max(before_ms, self.look())
        seen.slower = self.slower(seen.reference_ms)

    def slower(self, reference_ms: float) -> bool:
        """Whether the device was slower when the reference took so long, by the best of it until now."""
        return reference_ms > SLOWER_REFERENCE * self.best_ms

    def again(self, took_s: float, wait_s: float) -> bool:
        """Whether samples that took so long, while the device was slower, are to be taken again.

        wait_s: what a run may spend on this and on waiting, beside SHARE of the time of all turns.
        """
        if took_s > self._left_s(wait_s):
            return False
        self._spent_s += took_s
        return True

    def wait(self, wait_s: float, look_around: Callable[[], None]) -> None:
        """Wait until the reference is as fast as usual, or nothing is left to spend; look_around: called meanwhile."""
        while (left_s := self._left_s(wait_s)) > 0:
            begun_s = self._clock()
            if not self.slower(self.look()):
                return
            look_around()
            self._sleep(min(PAUSE_S, left_s))
            self._spent_s += self._clock() - begun_s

    def _left_s(self, wait_s: float) -> float:
        return SHARE * self._turns_s + wait_s - self._spent_s


class Unwatched:
    """Looks at nothing: no turn is taken again."""

    @contextmanager
    def turn(self) -> Iterator[Turn]:
        """A turn of which nothing is known."""
        yield Turn()

    def look(self) -> None:
        """See nothing."""

    def slower(self, reference_ms: float) -> bool:
        """Know of no time that it is slower."""
        return False

    def again(self, took_s: float, wait_s: float) -> bool:
        """Take nothing again."""
        return False

    def wait(self, wait_s: float, look_around: Callable[[], None]) -> None:
        """Go on at once."""
