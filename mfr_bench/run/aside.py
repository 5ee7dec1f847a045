"""Does work of the host that no frame waits for beside the device, in a process of its own."""

from __future__ import annotations

import os
import signal
from collections.abc import Callable, Iterator
from concurrent.futures import Future, ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager, suppress
from multiprocessing import get_context
from typing import Protocol, TypeVar

from .parent import live_for

T = TypeVar("T")


class Aside(Protocol):
    """Does such work, in this process or in another."""

    def begin(self, work: Callable[[], T]) -> Callable[[], T]:
        """Begin the work, which pickles; the function that is returned waits for its value."""

    @contextmanager
    def paused(self) -> Iterator[None]:
        """Let it take no core while frames are timed, where the device draws with the same cores."""


class AtOnce:
    """Does the work in this process, when it is begun."""

    def begin(self, work: Callable[[], T]) -> Callable[[], T]:
        """Do the work now; the function that is returned has its value."""
        value = work()
        return lambda: value

    @contextmanager
    def paused(self) -> Iterator[None]:
        """Pause nothing: no work goes on."""
        yield


class OtherProcess:
    """One more process, which is started when there is work. `pauses`: it is stopped while frames are timed."""

    def __init__(self, pauses: bool):
        self._pauses = pauses
        self._pool: ProcessPoolExecutor | None = None
        self._pid: Future[int] | None = None

    @property
    def pid(self) -> int | None:
        """The process's number; None where there is none."""
        with suppress(BrokenProcessPool):
            return self._pid.result() if self._pid else None

    def begin(self, work: Callable[[], T]) -> Callable[[], T]:
        """Begin the work there; the function that is returned waits for its value, or works here if that died."""
        if self._pool is None:
            self._pool = ProcessPoolExecutor(1, get_context("spawn"), live_for, (os.getpid(),))
            self._pid = self._pool.submit(os.getpid)
        pool = self._pool
        try:
            future = pool.submit(work)
        except BrokenProcessPool:
            return lambda: self._instead_of(pool, work)

        def wait() -> T:
            try:
                return future.result()
            except BrokenProcessPool:
                return self._instead_of(pool, work)

        return wait

    @contextmanager
    def paused(self) -> Iterator[None]:
        """Stop the process meanwhile, if it `pauses`."""
        self._signal(signal.SIGSTOP)
        try:
            yield
        finally:
            self._signal(signal.SIGCONT)

    def close(self) -> None:
        """End the process once it has done what was begun."""
        if self._pool:
            self._pool.shutdown()
        self._pool = self._pid = None

    def _signal(self, number: int) -> None:
        if self._pauses and (pid := self.pid):
            with suppress(ProcessLookupError):
                os.kill(pid, number)

    def _instead_of(self, pool: ProcessPoolExecutor, work: Callable[[], T]) -> T:
        """Do here what the process did not live to end; work that is begun from now on gets a new one."""
        if self._pool is pool:
            self.close()
        return work()
