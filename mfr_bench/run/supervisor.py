"""The loop over groups: has a worker measure them, and goes on with another worker where one fails.

Knows no device but by what the worker says of it.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from itertools import zip_longest

from ..environment import MIB
from .device_process import DeviceProcess
from .events import BETWEEN, Begun, Ended, Finished, Go, Group, Needs, Ready, Sampled, Stop, Synced
from .hand import Hand
from .jobs import Job
from .ledger import Ledger
from .memory import free_bytes
from .process import Died, Worker
from .trust import Trust

GRACE_S = 0.5  # for the worker to end between two frames where the user asked for it

Watch = Callable[[Begun | Sampled], None]  # receives the phases that begin and the samples


class Supervisor:
    """Starts a worker at once, which opens the device while the run is still being planned.

    `want`: kind of device; `asked`: whether the user wants the run to stop; worker: the one of this device, where it
    was started before. A context: leaving it ends the worker.
    The first cell whose image is wrong, or which crashes, has the device tested: one that fails a self-test without
    which any result may be wrong measures nothing any more.
    """

    def __init__(self, want: str, asked: Callable[[], bool] = lambda: False, worker: Worker | None = None):
        self.asked = asked
        self.free_bytes = free_bytes()
        self._process = DeviceProcess(want, asked, worker=worker)
        self._trust = Trust(want, lambda: asked() or self._over)
        self._deadline = self._last = self._asked_at = float("inf")
        self._then: tuple[Job, ...] = ()  # the group after the one that is measured

    def __enter__(self):
        return self

    def __exit__(self, kind, *_: object) -> None:
        self._process.close(early=kind is not None)

    def expect(self, needs: Needs) -> None:
        """Tell the worker what the run needs of the device; `ready` tells one that has not been told to try all."""
        self._process.expect(needs)

    def ready(self) -> Ready:
        """The device. Raises DeviceError where there is none."""
        return self._process.ready()

    def calibrate_again(self) -> Mapping[str, object] | None:
        """The worker's calibration now; None where it dies of it, does not answer, or the user asks to stop."""
        return self._process.calibrate_again()

    def measure(self, groups: Iterable[Sequence[Job]], ledger: Ledger, watch: Watch = lambda _: None,
                try_hopeless: bool = False, deadline: float = float("inf"), last: float = float("inf"),
                tell: Callable[[str], None] = lambda line: None) -> None:
        """Measure the cells of each group; every one ends as a row, but for those left at the `deadline`.

        The deadline is a time of `time.monotonic`: what is in hand then stops at its next frame, and its samples are
        kept. At `last` the worker is ended, whatever it is at; what it has in hand then has no row, like what was not
        begun. tell: receives a line where the device fails its self-tests. Raises KeyboardInterrupt where the user
        asked for it, and DeviceError where the device does not come back; what was measured is kept.
        """
        self.ready()
        self._deadline, self._last, self._trust.tell = deadline, last, tell
        groups = list(groups)
        try:
            for group, following in zip_longest(groups, groups[1:]):
                if self._late:
                    return
                self._then = tuple(following or ())
                self._measure_group(group, ledger, watch, try_hopeless)
        finally:
            ledger.wait()

    def _measure_group(self, group: Sequence[Job], ledger: Ledger, watch: Watch,
                       try_hopeless: bool) -> None:
        """Measure the cells of one group, with as many workers as it takes."""
        left = {job.key: job for job in group}
        deaths = 0  # of workers one after another, for which no cell is to blame
        while left:
            if self._refused(left, ledger):
                return
            if not try_hopeless:
                _skip_predicted(left, ledger)
            if not left or self._follow(left, ledger, watch):
                return
            if self.asked():
                raise KeyboardInterrupt
            if self._late:
                return
            deaths = 0 if self._progressed else deaths + 1
            self._process.replace(deaths)
            ledger.next_session()

    def _follow(self, left: dict[str, Job], ledger: Ledger, watch: Watch) -> bool:
        """Follow the worker through a group, taking what is done from `left`. Whether the group came to its end."""
        hand = Hand(left)
        self._process.send(Group(tuple(left.values()), ledger.partials(left.values()), ledger.without_floor(left),
                                 hand.limit_bytes(self.free_bytes), self._deadline, self._then))
        self._stopping = self._progressed = False
        try:
            while not (ended := self._event(hand, ledger, watch)):
                if self._refused(left, ledger):
                    self._process.kill("crashed", "the device fails its self-tests")
                    return True
                self._look(hand)
        except Died as death:
            if self._overstayed:
                raise KeyboardInterrupt from None
            return self._over or self._blame(hand, death, ledger)
        ledger.add_split(ended.split_s, ended.beside_s)
        if (ended.interrupted or (left and self.asked())) and not self._late:
            raise KeyboardInterrupt
        return True

    def _blame(self, hand: Hand, death: Died, ledger: Ledger) -> bool:
        """Write the rows of the cells that a death costs. Whether the group is at its end by that."""
        status, reason = death.cause
        for job in hand.blamed:
            row = self._held(Finished(job.key, status, f"{hand.phase}: {reason}", {}))
            if row is None:
                return self._over
            ledger.write(hand.jobs.pop(job.key), row)
            self._progressed = True
        return self._refused(hand.jobs, ledger)

    @property
    def _late(self) -> bool:
        """Whether the time is up, and the user has not asked to stop, which is an end of another kind."""
        return time.monotonic() >= self._deadline and not self.asked()

    def _event(self, hand: Hand, ledger: Ledger, watch: Watch) -> Ended | None:
        """Take in the next event, if one comes soon. Raises Died."""
        match event := self._process.receive():
            case Begun(key, phase):
                hand.take(key, phase)
                if phase != BETWEEN:
                    watch(event)
            case Sampled():
                ledger.sampled(event)
                watch(event)
                self._progressed = True
            case Finished(key):
                hand.drop()
                if row := self._held(event):
                    ledger.write(hand.jobs.pop(key), row)
                    self._progressed = True
            case Synced():
                ledger.sync()
                self._process.send(Go())
            case Ended():
                return event
            case None:
                ledger.catch_up()
        return None

    @property
    def _overstayed(self) -> bool:
        """Whether the user asked to stop so long ago that what the worker is at is given up, such as a compilation."""
        return time.monotonic() >= self._asked_at + GRACE_S

    @property
    def _over(self) -> bool:
        """Whether the time is up for the worker, too."""
        return time.monotonic() >= self._last

    def _held(self, finished: Finished) -> Finished | None:
        """The row of a cell, unsupported where the fault is the device's; None where the run ends before that is known.
        """
        return self._trust.held(finished, self.ready())

    def _refused(self, left: dict[str, Job], ledger: Ledger) -> bool:
        """Whether the device fails its self-tests; the rows of the cells that are left are then written."""
        if not self._trust.failed:
            return False
        for key in list(left):
            ledger.write(left.pop(key), self._trust.refused(key))
        return True

    def _look(self, hand: Hand) -> None:
        """Tell the worker to stop where the user asked; end it where it takes more time or memory than it may."""
        if self.asked():
            self._asked_at = min(self._asked_at, time.monotonic())
        if (self.asked() or self._late) and not self._stopping:
            self._stopping = True
            self._process.send(Stop())
        if self._overstayed:
            self._process.abandon()
        elif self._over:
            self._end(hand, "timeout", "the time is up")
        elif limit_s := hand.overdue_s():
            self._end(hand, "timeout", f"no end within {limit_s:g} s{hand.limited_by}")
        resident, limit = self._process.resident_bytes(), hand.limit_bytes(self.free_bytes)
        if resident > limit:
            what = f"the process that measures took {resident / MIB:,.0f} MiB, allowed: {limit / MIB:,.0f} MiB"
            self._end(hand, "out_of_memory", f"{what} (measure.hard_limit_mb)")

    def _end(self, hand: Hand, status: str, reason: str) -> None:
        hand.accuse()
        self._process.kill(status, reason)


def _skip_predicted(left: dict[str, Job], ledger: Ledger) -> None:
    """Write the rows of the cells that cannot be measured, by what smaller ones took."""
    for job in list(left.values()):
        if reason := ledger.predicted_timeout(job):
            ledger.write(left.pop(job.key), Finished(job.key, "timeout", reason, {}))
