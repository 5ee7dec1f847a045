"""Compiles programs before their turn: another process draws the first frames of cells that come later.

A software driver of Mesa compiles a program when it is first drawn with, in one thread, and keeps it in a cache on
disk, where the process that measures then finds it.
"""

from __future__ import annotations

import os
import signal
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from multiprocessing import get_context
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

from ..environment import MIB, usable_cores
from ..methods.spec import Fitted
from .jobs import Job
from .memory import free_bytes

DRIVERS = ("llvmpipe", "zink-llvmpipe")  # slugs of those that compile in the process that draws
SLOW_S = 0.15  # processor time of a first frame for which something was compiled; others take 0.04 s
FEW = 4  # cells, for which a process is not worth its start
ASKED = 3  # cells at once: so few that writing to the process never waits for it
FRAGMENTS = 2**21  # of a frame, above which drawing it takes longer than compiling
CELL_BYTES = 256 * MIB  # of a method's memory, which this process needs as well
FREE_BYTES = 2048 * MIB  # of memory that must be free before one more process takes some
STOP_S = 1.0  # until it stands still, or is killed
TRIED, SHARE = 3, 0.5  # cells drawn ahead, of whose compiling this one may be left with so much
LOCKS = Path("/proc/locks")  # Linux: the locks of files, by process

Serve = Callable[..., None]  # in the other process: takes its end of the link, the parent's id, and what is given


def drawable(job: Job, fitted: Fitted) -> bool:
    """Whether a second process may draw the cell: it is not large, and nothing of it comes from outside."""
    foreign = job.package or job.effect_package or job.scene_package
    return not foreign and fitted.stats.F <= FRAGMENTS and sum(fitted.memory_bytes().values()) <= CELL_BYTES


def helps(slug: str) -> bool:
    """Whether a driver, by its slug, compiles where another core is free, and locks of files can be seen."""
    return slug.startswith(DRIVERS) and (usable_cores() or 1) > 1 and LOCKS.exists() and free_bytes() > FREE_BYTES


class Precompiler:
    """The other process. It starts once a cell has been compiled for, and is given up where its cache is of no use.

    Nothing that becomes of it changes what is measured. serve: what it runs; None where it would not help. given: of
    its arguments those behind the link and the parent's id. asked: keys of the cells that it has not answered for.
    drawn_s: processor time of the cells that it has drawn, by key.
    """

    def __init__(self, serve: Serve | None, *given: object):
        self._serve, self._given = serve, given
        self._left: dict[str, Job] = {}  # whose turn has not come, in the order of their turns
        self.asked: dict[str, None] = {}
        self.drawn_s: dict[str, float] = {}
        self._tried: list[tuple[float, float]] = []  # of a cell that it compiled for: its time, that of this process
        self._process: Any = None
        self._link: Connection | None = None
        self._spent_s = 0.0

    @property
    def pid(self) -> int | None:
        """The process's number; None where there is none."""
        return self._process.pid if self._process else None

    def begin(self, jobs: Sequence[Job]) -> None:
        """The cells of a scene whose turns come next, in this order."""
        self._left = {job.key: job for job in jobs}
        self._ask()

    def reached(self, job: Job) -> None:
        """The cell's turn has come: it is not drawn ahead any more."""
        self._left.pop(job.key, None)
        self._ask()

    def drew(self, job: Job, spent_s: float) -> None:
        """Take in what the first frame took of this process's processor time."""
        if self._link is None:
            if self._serve and spent_s > SLOW_S and len(self._left) >= FEW:
                self._start()
        elif job.key in self.drawn_s and self.drawn_s[job.key] > SLOW_S:
            self._tried.append((self.drawn_s[job.key], spent_s))
            there_s, here_s = map(sum, zip(*self._tried, strict=True))
            if len(self._tried) >= TRIED and here_s > SHARE * there_s:
                self._give_up()
        self._ask()

    @contextmanager
    def paused(self) -> Iterator[None]:
        """Let it stand still meanwhile, and hold no lock of a file, for which the driver of this process might wait."""
        pid = self.pid
        if pid and not self._stopped(pid):
            self._give_up()
        try:
            yield
        finally:
            if self.pid:
                _signal(pid, signal.SIGCONT)

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
        context = get_context("spawn")
        try:
            ours, theirs = context.Pipe()
            self._process = context.Process(target=self._serve, args=(theirs, os.getpid(), *self._given), daemon=True)
            self._process.start()
        except OSError:  # no memory or no processes left
            self._process = self._serve = None
            return
        theirs.close()
        self._link = ours

    def _give_up(self) -> None:
        self.close()
        self._serve = None

    def _ask(self) -> None:
        """Have it draw the last of the cells that are left, as far as it is not asked for enough."""
        self._hear()
        for key in reversed(self._left):
            if self._link is None or len(self.asked) >= ASKED:
                return
            if key not in self.asked and key not in self.drawn_s:
                self.asked[key] = None
                try:
                    self._link.send(self._left[key])
                except OSError:
                    self._give_up()

    def _hear(self) -> None:
        """Take in what it has answered."""
        try:
            while self._link and self._link.poll(0):
                key, self.drawn_s[key] = (answer := self._link.recv())
                self._spent_s += answer[1]
                self.asked.pop(key, None)
        except (OSError, EOFError):
            self._give_up()

    @staticmethod
    def _stopped(pid: int) -> bool:
        """Stop it between two locks of files. Whether that was possible in time."""
        until = time.monotonic() + STOP_S
        while time.monotonic() < until:
            _signal(pid, signal.SIGSTOP)
            while not (still := _stands_still(pid)) and time.monotonic() < until:
                time.sleep(1e-4)
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
