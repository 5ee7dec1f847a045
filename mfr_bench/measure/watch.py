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
SELDOM_S = 0.25  # between two looks while no samples are taken
EVERY_S = 0.03  # for so long a look tells of the moment: one is enough for the short turns that end meanwhile


@dataclass
class Turn:
    """What the reference frame showed around one turn: its longer time, so far as it was looked at."""

    reference_ms: float | None = None
    took_s: float = 0.0


class Watch:
    """Times a reference frame before and after each turn of samples, or the few that are drawn within EVERY_S.

    draw_ms: draws the reference frame, as often as the best time so far asks for, and returns its time in ms. clock,
    sleep: in seconds.
    """

    def __init__(self, draw_ms: Callable[[float], float], clock: Callable[[], float] = time.monotonic,
                 sleep: Callable[[float], None] = time.sleep):
        self._draw_ms, self._clock, self._sleep = draw_ms, clock, sleep
        self.best_ms = math.inf  # of the reference so far
        self._last = -math.inf, math.inf  # when it was looked at, and what that showed
        self._ended: list[Turn] = []  # since then
        self._turns_s = self._spent_s = 0.0

    def look(self) -> float:
        """The time of the reference now, in ms; the more often it is looked at, the surer is its best."""
        now_ms = self._draw_ms(self.best_ms)
        self._last = self._clock(), now_ms
        self.best_ms = min(self.best_ms, now_ms)
        for turn in self._ended:
            turn.reference_ms = max(now_ms, turn.reference_ms or 0.0)
        self._ended.clear()
        return now_ms

    def look_behind(self) -> None:
        """Look, if a turn has ended since the last look: all that will be known of it then is."""
        if self._ended:
            self.look()

    def look_seldom(self) -> None:
        """Look, if the last look is a while ago."""
        if not self._within(SELDOM_S):
            self.look()

    def _within(self, seconds: float) -> bool:
        """Whether the last look is no longer ago."""
        return self._clock() - self._last[0] <= seconds

    @contextmanager
    def turn(self) -> Iterator[Turn]:
        """Watch a turn. What is yielded has the look before it, and that behind it once there is one."""
        if not self._within(EVERY_S):
            self.look()
        seen, begun_s = Turn(self._last[1]), self._clock()
        yield seen
        seen.took_s = self._clock() - begun_s
        self._turns_s += seen.took_s
        self._ended.append(seen)
        if not self._within(EVERY_S):
            self.look()

    def slower(self, turn: Turn) -> bool:
        """Whether the device was slower during a turn, by the best of the reference until now."""
        return (turn.reference_ms or 0.0) > SLOWER_REFERENCE * self.best_ms

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
            if not self.slower(Turn(self.look())):
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

    def look_seldom(self) -> None:
        """See nothing."""

    def look_behind(self) -> None:
        """See nothing."""

    def slower(self, turn: Turn) -> bool:
        """Know of no turn that it was slower."""
        return False

    def again(self, took_s: float, wait_s: float) -> bool:
        """Take nothing again."""
        return False

    def wait(self, wait_s: float, look_around: Callable[[], None]) -> None:
        """Go on at once."""
