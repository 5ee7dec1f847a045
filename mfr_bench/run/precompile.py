"""Compiles programs before their turn: another process draws the first frames of cells that come later.

A software driver of Mesa compiles a program when it is first drawn with, in one thread, and keeps it in a cache on
disk, where the process that measures then finds it.
"""

from __future__ import annotations

import math
import os
import signal
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from multiprocessing.connection import Connection
from multiprocessing.process import BaseProcess
from pathlib import Path

from ..environment import MIB, usable_cores
from ..methods.spec import Fitted
from .jobs import Job
from .memory import free_bytes
from .standby import Serve, new

DRIVERS = ("llvmpipe", "zink-llvmpipe")  # slugs of those that compile in the process that draws
SLOW_S = 0.15  # processor time of a first frame for which something was compiled; others take 0.04 s
FEW = 4  # cells, for which a process is not worth its start
COLD_S = 0.04  # processor time of trials that were compiled, which tells that the cache has no programs; else 0.02 s
AT_ONCE = 12  # cells of a run, from which on it is then worth its start before any of them was drawn
ASKED = 8  # cells at once: so few that writing to the process never waits for it
FRAGMENTS = 2**21  # of a frame, above which drawing it takes longer than compiling
CELL_BYTES = 256 * MIB  # of a method's memory, which this process needs as well
FREE_BYTES = 2048 * MIB  # of memory that must be free before one more process takes some
IDLE_S = 0.5  # after its last answer the driver has written what it compiled
YIELDS = 50  # of the processor while it is about to stop, before each further look is a sleep
STOP_S = 1.0  # until it stands still, or is killed
TRIED, SHARE = 3, 0.5  # cells drawn ahead, of whose compiling this one may be left with so much
LOCKS = Path("/proc/locks")  # Linux: the locks of files, by process

Begin = Callable[..., tuple[BaseProcess, Connection]]  # takes what is to be served, and what that is given


def drawable(job: Job, fitted: Fitted) -> bool:
    """Whether a second process may draw the cell: it is not large, and nothing of it comes from outside."""
    foreign = job.package or job.effect_package or job.scene_package
    return not foreign and fitted.stats.F <= FRAGMENTS and sum(fitted.memory_bytes().values()) <= CELL_BYTES


def helps(slug: str) -> bool:
    """Whether a driver, by its slug, compiles where another core is free, and locks of files can be seen."""
    return slug.startswith(DRIVERS) and (usable_cores() or 1) > 1 and LOCKS.exists() and free_bytes() > FREE_BYTES


class Precompiler:
    """The other process. It starts when it is told to, or once a cell has been compiled for.

    It is given up where its cache is of no use.

    Nothing that becomes of it changes what is measured. serve: what it runs; None where it would not help. given: of
    its arguments those behind the link and the parent's id. begin: how it begins. asked: keys of the cells that it has
    not answered for. drawn_s: processor time of the cells that it has drawn, by key.
    """

    def __init__(self, serve: Serve | None, *given: object, begin: Begin = new):
        self._serve, self._given, self._begin = serve, given, begin
        self._left: dict[str, Job] = {}  # whose turn has not come, in the order of their turns
        self._later: dict[str, Job] = {}  # of the scene that follows
        self._met: set[str] = set()  # cells whose turn came before they were drawn
        self.asked: dict[str, None] = {}
        self.drawn_s: dict[str, float] = {}
        self._tried: list[tuple[float, float]] = []  # of a cell that it compiled for: its time, that of this process
        self._process: BaseProcess | None = None
        self._link: Connection | None = None
        self._spent_s = 0.0
        self._heard_at = 0.0  # by the monotonic clock
        self._pausing = False

    @property
    def pid(self) -> int | None:
        """The process's number; None where there is none."""
        return self._process.pid if self._process else None

    def begin(self, jobs: Sequence[Job], later: Sequence[Job] = ()) -> None:
        """The cells of a scene whose turns come next, in this order; later: those of the scene that follows."""
        self._left, self._later = ({job.key: job for job in each} for each in (jobs, later))
        self._ask()

    def start(self) -> None:
        """Start the process, unless it is there, or would not help."""
        if self._serve and self._link is None:
            self._start()
            self._ask()

    def reached(self, job: Job) -> None:
        """The cell's turn has come: it is not drawn ahead any more, unless the process is at it."""
        self._ask()
        self._left.pop(job.key, None)
        if job.key not in self.drawn_s:
            self._met.add(job.key)
        if job.key in self.asked:
            self._send(job.key)

    def drew(self, job: Job, spent_s: float) -> None:
        """Take in what the first frame took of this process's processor time."""
        if self._link is None:
            if spent_s > SLOW_S and len(self._left) >= FEW:
                self.start()
        elif job.key not in self._met and self.drawn_s.get(job.key, 0.0) > SLOW_S:
            self._tried.append((self.drawn_s[job.key], spent_s))
            there_s, here_s = map(sum, zip(*self._tried, strict=True))
            if len(self._tried) >= TRIED and here_s > SHARE * there_s:
                self._give_up()
        self._ask()

    @contextmanager
    def paused(self) -> Iterator[None]:
        """Let it stand still meanwhile, and hold no lock of a file, for which the driver of this process might wait.

        One that waits for cells has nothing to be stopped at. Within another pause nothing is left to do.
        """
        if self._pausing:
            yield
            return
        pid = None if self._idle() else self.pid
        if pid and not self._stopped(pid):
            self._give_up()
        self._pausing = True
        try:
            yield
        finally:
            self._pausing = False
            if pid and self.pid:
                _signal(pid, signal.SIGCONT)

    def _idle(self) -> bool:
        """Whether it has answered for all cells, and that not just now."""
        self._hear()
        return not self.asked and time.monotonic() > self._heard_at + IDLE_S

    def taken_s(self) -> dict[str, float]:
        """Processor time that it has spent since the last call, as a kind of work."""
        self._hear()
        found, self._spent_s = {"compile": round(self._spent_s, 3)} if self._spent_s else {}, 0.0
        return found

    def close(self) -> None:
        """End it, whatever it is at, but for writing to the driver's cache."""
        if self._process:
            self._stopped(self.pid)
            self._process.kill()
            self._process.join(STOP_S)
            self._link.close()
        self._process = self._link = None

    def _start(self) -> None:
        try:
            self._process, self._link = self._begin(self._serve, *self._given)
        except OSError:  # no memory or no processes left
            self._serve = None
            return
        self._heard_at = math.inf  # until it answers, it may still be starting

    def _give_up(self) -> None:
        self.close()
        self._serve = None

    def _ask(self) -> None:
        """Have it draw the last of the cells that are left, then those that follow, but not too many at once."""
        self._hear()
        for job in (*reversed(self._left.values()), *reversed(self._later.values())):
            if self._link is None or len(self.asked) >= ASKED:
                return
            if job.key not in self.asked and job.key not in self.drawn_s:
                self.asked[job.key] = None
                self._send(job)

    def _send(self, message: Job | str) -> None:
        try:
            if self._link:
                self._link.send(message)
        except OSError:
            self._give_up()

    def _hear(self) -> None:
        """Take in what it has answered."""
        try:
            while self._link and self._link.poll(0):
                key, spent_s = self._link.recv()
                self._heard_at = time.monotonic()
                self.asked.pop(key, None)
                if spent_s is not None:
                    self.drawn_s[key] = spent_s
                    self._spent_s += spent_s
        except (OSError, EOFError):
            self._give_up()

    @staticmethod
    def _stopped(pid: int) -> bool:
        """Stop it between two locks of files. Whether that was possible in time."""
        until = time.monotonic() + STOP_S
        while time.monotonic() < until:
            _signal(pid, signal.SIGSTOP)
            looks = 0
            while not (still := _stands_still(pid)) and time.monotonic() < until:
                looks += 1
                time.sleep(0 if looks < YIELDS else 1e-4)
            if still and not _holds_a_lock(pid):
                return True
            _signal(pid, signal.SIGCONT)
            time.sleep(1e-3)
        return False


def _signal(pid: int, number: int) -> None:
    with suppress(ProcessLookupError):
        os.kill(pid, number)


def _stands_still(pid: int) -> bool:
    """Whether all threads of a child have stopped; of one that has ended as well."""
    try:
        return os.waitid(os.P_PID, pid, os.WSTOPPED | os.WNOHANG | os.WNOWAIT) is not None
    except ChildProcessError:
        return True


def _holds_a_lock(pid: int) -> bool:
    """Whether the process has a file locked; `->` marks those that wait for a lock."""
    fields = (line.split() for line in LOCKS.read_text().splitlines())
    return any(each[1] != "->" and each[4] == str(pid) for each in fields)
