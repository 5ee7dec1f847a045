"""The loop over groups: has a worker measure them, and goes on with another worker where one fails.

Knows no device but by what the worker says of it.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Mapping, Sequence

from ..environment import MIB
from ..errors import DeviceError
from .events import (
    CHECK,
    Begun,
    Calibrate,
    Calibrated,
    Ended,
    Failed,
    Finished,
    Go,
    Group,
    Ready,
    Sampled,
    Share,
    Stop,
    Synced,
)
from .jobs import Job
from .ledger import Ledger
from .memory import FREE_SHARE, free_bytes
from .process import Died, Worker

LOOK_S = 0.1  # between looks at the worker's memory and the time
START_S = 120.0  # for a worker to open the device and to choose its timer
STARTS = 3  # of a new worker, before the device counts as gone
PAUSE_S = 1.0  # before the next of them
SUSPENDED_S = 5.0  # between two looks: it was not the worker that took it


class Hand:
    """What the worker is at, and how long each cell has taken of its time so far."""

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
        if self.phase != CHECK:
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

    def overdue_s(self) -> float | None:
        """The limit that the cell in hand, or the scene, has passed, or None.

        Time during which nobody looked does not count, nor does that in which the harness compares images.
        """
        now = time.monotonic()
        if self.phase == CHECK:
            self._looked = now
            return None
        if now - self._looked > SUSPENDED_S:
            self._since += now - self._looked
        self._looked = now
        concerned = self.blamed or self.jobs.values()
        limit_s = max((job.cell.measure.longest_s for job in concerned), default=START_S)
        return limit_s if self._spent_s.get(self.key, 0.0) + now - self._since > limit_s else None


class Supervisor:
    """Starts a worker at once, which opens the device while the run is still being planned.

    `want`: kind of device; `asked`: whether the user wants the run to stop. A context: leaving it ends the worker.
    """

    def __init__(self, want: str, asked: Callable[[], bool] = lambda: False):
        self.want, self.asked = want, asked
        self.free_bytes = free_bytes()
        self._worker: Worker | None = Worker(want)
        self._ready: Ready | None = None
        self._deadline = float("inf")

    def __enter__(self):
        return self

    def __exit__(self, kind, *_: object) -> None:
        if self._worker:
            if kind is not None:
                self._worker.kill(("crashed", "the run has ended"))
            self._worker.close()

    def ready(self) -> Ready:
        """The device. Raises DeviceError where there is none."""
        if self._ready is None:
            self._ready = self._opened(self._worker)
        return self._ready

    def _opened(self, worker: Worker) -> Ready:
        start = time.monotonic()
        while time.monotonic() - start < START_S:
            try:
                event = worker.receive(LOOK_S)
            except Died as death:
                raise DeviceError(f"the OpenGL device cannot be opened: {death}") from None
            if isinstance(event, Failed):
                raise DeviceError(event.reason)
            if isinstance(event, Ready):
                return event
            if self.asked():
                raise KeyboardInterrupt
        raise DeviceError(f"the OpenGL device cannot be opened: no answer within {START_S:g} s")

    def calibrate_again(self) -> Mapping[str, object] | None:
        """The worker's calibration now; None where it dies of it, does not answer, or the user asks to stop."""
        if self._worker is None:
            return None
        self._worker.send(Calibrate())
        start = time.monotonic()
        while time.monotonic() - start < START_S and not self.asked():
            try:
                event = self._worker.receive(LOOK_S)
            except Died:
                return None
            if isinstance(event, Calibrated):
                return event.calibration
        return None

    def measure(self, groups: Iterable[Sequence[Job]], ledger: Ledger, share: Callable[[float], None] = lambda _: None,
                try_hopeless: bool = False, deadline: float = float("inf")) -> None:
        """Measure the cells of each group; every one ends as a row, but for those left at the `deadline`.

        The deadline is a time of `time.monotonic`: what is in hand then stops at its next frame, and its samples are
        kept. Raises KeyboardInterrupt where the user asked for it, and DeviceError where the device does not come back;
        what was measured is kept.
        """
        self.ready()
        self._deadline = deadline
        for group in groups:
            if self._late:
                return
            left = {job.key: job for job in group}
            deaths = 0  # in a row that no cell is to blame for
            while left:
                if not try_hopeless:
                    _skip_predicted(left, ledger)
                if not left or self._group(left, ledger, share):
                    break
                if self.asked():
                    raise KeyboardInterrupt
                if self._late:
                    break
                deaths = 0 if self._progressed else deaths + 1
                self._replace(deaths)
                ledger.next_session()

    def _group(self, left: dict[str, Job], ledger: Ledger, share: Callable[[float], None]) -> bool:
        """Follow the worker through a group, taking what is done from `left`. Whether the group came to its end."""
        hand = Hand(left)
        self._worker.send(Group(tuple(left.values()), ledger.partials(left.values()), ledger.without_floor(left),
                                self._limit_bytes(hand)))
        self._stopping = self._progressed = False
        try:
            while not (ended := self._event(hand, ledger, share)):
                self._look(hand)
        except Died as death:
            status, reason = death.cause
            for job in hand.blamed:
                del left[job.key]
                ledger.write(job, Finished(job.key, status, f"{hand.phase}: {reason}", {}))
                self._progressed = True
            return False
        ledger.add_split(ended.split_s)
        if ended.interrupted and not self._late:
            raise KeyboardInterrupt
        return True

    @property
    def _late(self) -> bool:
        """Whether the time is up, and the user has not asked to stop, which is an end of another kind."""
        return time.monotonic() >= self._deadline and not self.asked()

    def _event(self, hand: Hand, ledger: Ledger, share: Callable[[float], None]) -> Ended | None:
        """Take in the next event, if one comes soon. Raises Died."""
        match event := self._worker.receive(LOOK_S):
            case Begun(key, phase):
                hand.take(key, phase)
            case Sampled():
                ledger.sampled(event)
                self._progressed = True
            case Finished(key):
                hand.drop()
                ledger.write(hand.jobs.pop(key), event)
                self._progressed = True
            case Synced():
                ledger.sync()
                self._worker.send(Go())
            case Share(cells):
                share(cells)
            case Ended():
                return event
        return None

    def _look(self, hand: Hand) -> None:
        """Tell the worker to stop where the user asked; end it where it takes more time or memory than it may."""
        if (self.asked() or self._late) and not self._stopping:
            self._stopping = True
            self._worker.send(Stop())
        if limit_s := hand.overdue_s():
            self._end(hand, "timeout", f"no end within {limit_s:g} s (measure.hard_limit_s)")
        held, limit = self._worker.resident_bytes(), self._limit_bytes(hand)
        if held > limit:
            what = f"the process that measures took {held / MIB:,.0f} MiB, allowed: {limit / MIB:,.0f} MiB"
            self._end(hand, "out_of_memory", f"{what} (measure.hard_limit_mb)")

    def _end(self, hand: Hand, status: str, reason: str) -> None:
        hand.accuse()
        self._worker.kill((status, reason))

    def _limit_bytes(self, hand: Hand) -> float:
        given = [job.cell.measure.hard_limit_mb for job in hand.blamed or hand.jobs.values()]
        return max((FREE_SHARE * self.free_bytes if mb is None else mb * MIB for mb in given), default=float("inf"))

    def _replace(self, deaths: int) -> None:
        """Start another worker on the same device. Raises DeviceError if none starts, or if it dies between cells."""
        self._worker.close()
        reason = "the process that measures died again and again, with no cell in hand"
        for start in range(STARTS if deaths < STARTS else 0):
            time.sleep(PAUSE_S * bool(start))
            self._worker = Worker(self.want, self._ready.timer)
            try:
                opened = self._opened(self._worker)
            except DeviceError as error:
                reason = str(error)
                self._worker.kill(("crashed", reason))
                self._worker.close()
                continue
            if opened.device == self._ready.device:
                return
            reason = f"it is now {opened.device['renderer']}, {opened.device['version']}"
            self._worker.close()
        self._worker = None
        raise DeviceError(f"the OpenGL device {self._ready.device['renderer']} is gone: {reason}")


def _skip_predicted(left: dict[str, Job], ledger: Ledger) -> None:
    """Write the rows of the cells that cannot be measured, by what smaller ones took."""
    for job in list(left.values()):
        if reason := ledger.predicted_timeout(job):
            ledger.write(left.pop(job.key), Finished(job.key, "timeout", reason, {}))
