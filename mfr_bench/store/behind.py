"""Writes to the disk behind the caller, who need not wait for it."""

from __future__ import annotations

import threading
from collections.abc import Callable
from queue import Empty, Queue, SimpleQueue

Step = Callable[[], None]
WAITING = 16  # writes at most: a disk that is slower than its caller holds it up, rather than what follows at its end


class Behind:
    """A thread that writes in the order in which it is told to; it is there from the first write until `wait`.

    Where the system has no thread left, the caller writes. What follows on a write is done by the caller's thread,
    within `catch_up` and `wait`. After a write that fails none is done any more, and both raise what it raised.
    """

    def __init__(self) -> None:
        self._thread: threading.Thread | None = None
        self._told: Queue[tuple[Step, Step] | None] = Queue(WAITING)
        self._done: SimpleQueue[Step] = SimpleQueue()
        self._failed: Exception | None = None

    def write(self, write: Step, then: Step) -> None:
        """Have it written behind all that it was told before. Waits while `WAITING` writes are not begun."""
        if self._thread is None:
            thread = threading.Thread(target=self._work, daemon=True)
            try:
                thread.start()
            except RuntimeError:  # no processes left, or no memory for one
                self._do(write, then)
                return
            self._thread = thread
        self._told.put((write, then))

    def catch_up(self) -> None:
        """Do what follows on the writes that are done."""
        try:
            while True:
                self._done.get_nowait()()
        except Empty:
            if self._failed:
                raise self._failed from None

    def wait(self) -> None:
        """Wait until everything is written."""
        if self._thread is not None:
            self._told.put(None)
            self._thread.join()
            self._thread = None
        self.catch_up()

    def _work(self) -> None:
        while task := self._told.get():
            self._do(*task)

    def _do(self, write: Step, then: Step) -> None:
        if self._failed is None:
            try:
                write()
                self._done.put(then)
            except Exception as error:  # noqa: BLE001 - raised again where the caller is
                self._failed = error
