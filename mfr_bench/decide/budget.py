"""The time that an answer may take, counted from the start of the process, and what is set aside of it for its end."""

from __future__ import annotations

import time
from dataclasses import dataclass

from ..environment import slowness, started

STOPPING_S, STOPPING_SHARE = 4.0, 0.3  # of a quiet machine, and of the budget at most: last images, rows, the answer
ENDING_S, ENDING_SHARE = 1.5, 0.1  # the same, to read the rows and give the answer
COMPILING_SHARE = 0.4  # of the budget that one candidate may take, before it is ended


@dataclass(frozen=True)
class Budget:
    """A time budget that began with the process. `begun`: on the monotonic clock.

    slowness: how many times as long the machine takes as a quiet one.
    """

    begun: float
    seconds: float
    slowness: float = 1.0

    @property
    def stop(self) -> float:
        """The time at which measuring has to stop, on the monotonic clock."""
        return self.begun + self.seconds - min(STOPPING_SHARE * self.seconds, STOPPING_S * self.slowness)

    @property
    def last(self) -> float:
        """The time at which the process that measures is ended, whatever it is at."""
        return self.begun + self.seconds - min(ENDING_SHARE * self.seconds, ENDING_S * self.slowness)

    def left_s(self) -> float:
        """Seconds until measuring has to stop."""
        return max(0.0, self.stop - time.monotonic())

    def room_for(self, quiet_s: float) -> bool:
        """Whether work that takes so long on a quiet machine ends within the budget, with time for the answer."""
        return time.monotonic() + self.slowness * quiet_s <= self.last


def budget(seconds: float) -> Budget:
    """The budget of this process. The start tells how loaded the machine is: it is work of this process alone."""
    return Budget(started(), seconds, slowness())
