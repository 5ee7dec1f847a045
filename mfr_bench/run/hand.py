"""The work that the worker has in hand: the cell and its phase, the time of each cell, and the limits that hold."""

from __future__ import annotations

import time
from collections.abc import Mapping

from ..environment import MIB
from .events import BETWEEN, CHECK, WAIT
from .jobs import Job
from .memory import FREE_SHARE

START_S = 120.0  # for a worker to open the device, to choose its timer, to make a scene, or between two steps
UNLIMITED = (CHECK, WAIT)  # phases that may take any time
APART = (*UNLIMITED, BETWEEN)  # phases within none of a cell's limits
SUSPENDED_S = 5.0  # between two looks: it was not the worker that took it


class Hand:
    """The current cell and phase of the worker, and the time that each cell has taken so far."""

    def __init__(self, jobs: Mapping[str, Job]):
        self.jobs = jobs
        self.key: str | None = None
        self.phase = ""
        self._accused = False
        self._spent_s: dict[str | None, float] = {}
        self._since = self._looked = time.monotonic()

    def accuse(self) -> None:
        """Note that the worker is killed for its current cell; whatever it sends later does not change the blame."""
        self._accused = True

    def take(self, key: str | None, phase: str) -> None:
        if self._accused:
            return
        now = time.monotonic()
        if self.phase not in APART:
            self._spent_s[self.key] = self._spent_s.get(self.key, 0.0) + now - self._since
        self.key, self.phase, self._since, self._looked = key, phase, now, now

    def drop(self) -> None:
        self.take(None, "")
        self._spent_s.pop(None, None)

    @property
    def blamed(self) -> list[Job]:
        """The cells that an end of the worker costs now; none between two cells."""
        if self.key is None:
            return list(self.jobs.values()) if self.phase else []
        return [self.jobs[self.key]] if self.key in self.jobs else []

    @property
    def _concerned(self) -> list[Job]:
        """The cells whose limits hold now: all of the group between two cells."""
        return self.blamed or list(self.jobs.values())

    def overdue_s(self) -> float | None:
        """The limit that the cell in hand, or the scene, has passed, or None.

        Time during which nobody looked does not count, nor for a cell that in which the harness compares images, waits,
        or is between two steps. Making a scene is no cell's time: a cell's limit shortens it no more than START_S.
        """
        now = time.monotonic()
        if now - self._looked > SUSPENDED_S:
            self._since += now - self._looked
        self._looked = now
        if self.phase in UNLIMITED:
            return None
        taken_s = now - self._since
        if self.phase == BETWEEN:
            return START_S if taken_s > START_S else None
        limits_s = [job.cell.measure.longest_s for job in self._concerned]
        limit_s = max(limits_s if self.key else [START_S, *limits_s], default=START_S)
        return limit_s if self._spent_s.get(self.key, 0.0) + taken_s > limit_s else None

    @property
    def limited_by(self) -> str:
        """The setting that the limit of `overdue_s` comes from, in brackets; nothing where it is no cell's."""
        return " (measure.hard_limit_s)" if self.key and self.phase not in APART else ""

    def limit_bytes(self, free_bytes: float) -> float:
        """The memory that the worker may take: measure.hard_limit_mb, else a share of what was free at the start."""
        given = [job.cell.measure.hard_limit_mb for job in self._concerned]
        return max((FREE_SHARE * free_bytes if mb is None else mb * MIB for mb in given), default=float("inf"))
