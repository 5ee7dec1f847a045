"""Does work of the host that no frame waits for beside the device, in a process of its own."""

from __future__ import annotations

import os
import signal
import time
from collections import deque
from collections.abc import Callable, Iterator
from concurrent.futures import Future, ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager, suppress
from multiprocessing import get_context
from typing import Protocol, TypeVar

import numpy as np

from ..measure.split import Split
from .answers import Answers
from .parent import live_for
from .shared import Array, Held, Shared

T = TypeVar("T")
Work = Callable[[Answers], T]
DEATHS = 3  # of such a process, after which this one does all work itself
IN_FLIGHT_BYTES = 256 * 2**20  # of images that wait to be compared; the next one waits until there is room


class Pending(Protocol[T]):
    """Work that was begun. ready: whether its value is there."""

    @property
    def ready(self) -> bool: ...

    def __call__(self) -> T:
        """Wait for the value, or for what the work raised."""


class Aside(Protocol):
    """Does such work, in this process or in another."""

    another: bool  # whether it is another process

    def share(self, array: np.ndarray) -> Array:
        """The array, for such work to read. The caller, or the work that it is given to, releases it."""

    def begin(self, work: Work[T], *arrays: Array) -> Pending[T]:
        """Begin the work, which pickles; the arrays are released once it is done."""

    @contextmanager
    def paused(self) -> Iterator[None]:
        """Let it take no core while frames are timed, where the device draws with the same cores."""


class Done:
    """Work that this process has done."""

    ready = True

    def __init__(self, value: T):
        self._value = value

    def __call__(self) -> T:
        return self._value


class AtOnce:
    """Does the work in this process, when it is begun."""

    another = False

    def __init__(self, answers: Answers):
        self._answers = answers

    def share(self, array: np.ndarray) -> Array:
        return Held(array)

    def begin(self, work: Work[T], *arrays: Array) -> Pending[T]:
        """Do the work now."""
        try:
            return Done(work(self._answers))
        finally:
            for array in arrays:
                array.release()

    @contextmanager
    def paused(self) -> Iterator[None]:
        """Pause nothing: no work goes on."""
        yield


class OtherProcess:
    """One more process, which is started when there is work. `pauses`: it is stopped while frames are timed.

    answers: of this process, which does what the other does not live to end, or fails at. spent_s: processor time of
    the other, by kind of work.
    """

    another = True

    def __init__(self, pauses: bool, answers: Answers):
        self._pauses, self.answers = pauses, answers
        self._pool: ProcessPoolExecutor | None = None
        self._pid: Future[int] | None = None
        self._deaths = 0
        self._in_flight: deque[_Elsewhere] = deque()
        self.spent_s: dict[str, float] = {}

    @property
    def pid(self) -> int | None:
        """The process's number; None where there is none."""
        with suppress(BrokenProcessPool):
            return self._pid.result() if self._pid else None

    def share(self, array: np.ndarray) -> Array:
        """A copy that both processes see; without memory for one the array itself, which then goes with the work."""
        try:
            return Shared(array)
        except MemoryError:
            return Held(array)

    def begin(self, work: Work[T], *arrays: Array) -> Pending[T]:
        """Begin the work there; its value comes from there, or from this process if the other died."""
        self._make_room(sum(array.bytes for array in arrays))
        pending = _Elsewhere(self, work, arrays, *self._submitted(work))
        self._in_flight.append(pending)
        return pending

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

    def taken_s(self) -> dict[str, float]:
        """`spent_s` since the last call."""
        for pending in self._in_flight:
            if pending.ready:
                pending.settle()
        found, self.spent_s = {kind: round(seconds, 3) for kind, seconds in self.spent_s.items()}, {}
        return found

    def retire(self, pool: ProcessPoolExecutor | None) -> None:
        """Let a process that died be; work that is begun from now on gets a new one, as long as few have died."""
        if pool is not None and self._pool is pool:
            self._deaths += 1
            self.close()

    def _submitted(self, work: Work) -> tuple[ProcessPoolExecutor | None, Future]:
        """The work in a process that lives, as far as is known; a future that has failed where none does any more."""
        if self._pool is None and self._deaths < DEATHS:
            self._pool = ProcessPoolExecutor(1, get_context("spawn"), _begin, (os.getpid(),))
            self._pid = self._pool.submit(os.getpid)
        if self._pool is not None:
            try:
                return self._pool, self._pool.submit(_worked, work)
            except BrokenProcessPool:
                self.retire(self._pool)
                return self._submitted(work)
        gone: Future = Future()
        gone.set_exception(BrokenProcessPool("it has died too often"))
        return None, gone

    def _make_room(self, wanted: int) -> None:
        while self._in_flight and wanted + sum(each.bytes for each in self._in_flight) > IN_FLIGHT_BYTES:
            self._in_flight.popleft().settle()
        while self._in_flight and self._in_flight[0].settled:
            self._in_flight.popleft()

    def _signal(self, number: int) -> None:
        if self._pauses and (pid := self.pid):
            with suppress(ProcessLookupError):
                os.kill(pid, number)


class _Elsewhere:
    """Work that was begun in the other process."""

    def __init__(self, aside: OtherProcess, work: Work, arrays: tuple[Array, ...],
                 pool: ProcessPoolExecutor | None, future: Future):
        self._aside, self._work, self._arrays, self._pool, self._future = aside, work, arrays, pool, future
        self._value, self._error, self.settled = None, None, False

    @property
    def bytes(self) -> int:
        """Memory of the arrays that it still needs."""
        return sum(array.bytes for array in self._arrays)

    @property
    def ready(self) -> bool:
        return self.settled or self._future.done()

    def __call__(self):
        self.settle()
        if self._error is not None:
            raise self._error
        return self._value

    def settle(self) -> None:
        """Wait for its value or its error."""
        if self.settled:
            return
        try:
            self._value, spent_s = self._future.result()
            for kind, seconds in spent_s.items():
                self._aside.spent_s[kind] = self._aside.spent_s.get(kind, 0.0) + seconds
        except Exception as failed:  # noqa: BLE001 - whatever became of the process or its memory, the work is done here
            self._do_here(failed)
        for array in self._arrays:
            array.release()
        self.settled, self._arrays = True, ()

    def _do_here(self, failed: Exception) -> None:
        if isinstance(failed, BrokenProcessPool):
            self._aside.retire(self._pool)
        try:
            self._value = self._work(self._aside.answers)
        except Exception as error:  # noqa: BLE001 - it is raised where the value is asked for
            self._error = error


# --- in the other process ------------------------------------------------------------------------

_here: Answers | None = None


def _begin(parent: int) -> None:
    global _here  # noqa: PLW0603 - what the process knows from one work to the next
    live_for(parent)
    _here = Answers(Split(time.process_time))


def _worked(work: Work[T]) -> tuple[T, dict[str, float]]:
    """The value, and the processor time that it took, by kind of work."""
    return work(_here), _here.split.taken()
