"""The parent's hold on the process that measures: its start, messages, what it takes of memory, its end."""

from __future__ import annotations

import os
import signal
import socket
import subprocess
import sys
import time
from contextlib import suppress
from multiprocessing.connection import Connection
from typing import Any

from ..environment import MIB
from .memory import kernel_kills, resident_bytes

PROGRAM = "import sys; sys.path[:] = sys.argv.pop().split(':'); from mfr_bench.run.worker import main; main()"
LOOK_S = 0.01  # between two looks at the memory of a process
END_S = 5.0  # for a worker that was asked to end, then for one that was killed: a driver may hold it in the kernel

Cause = tuple[str, str]  # status of the cell that was in hand, and what became of the process


class Died(Exception):  # noqa: N818 - what happened, not what is wrong
    """The process has ended; every message that it sent has been received."""

    def __init__(self, cause: Cause):
        super().__init__(cause[1])
        self.cause = cause


class Worker:
    """A process with an OpenGL context of its own. `want`: kind of device; `timer`: None lets it choose.

    It has a session of its own, so that Ctrl-C reaches the parent alone, and dies with the parent.
    """

    def __init__(self, want: str, timer: str | None = None):
        ours, theirs = socket.socketpair()
        self._log = os.memfd_create("worker")  # what drivers print; its last line tells of a crash
        self._kills, self._held, self._held_at = kernel_kills(), 0, -LOOK_S
        self._cause: Cause | None = None
        self._killed, self._abandoned = float("inf"), False  # when
        with theirs:
            arguments = [str(theirs.fileno()), str(os.getpid()), want, timer or "", ":".join(sys.path)]
            self.process = subprocess.Popen(
                [sys.executable, "-c", PROGRAM, *arguments], stdin=subprocess.DEVNULL, stdout=self._log,
                stderr=self._log, pass_fds=[theirs.fileno()], start_new_session=True)
        self._link = Connection(ours.detach())

    def send(self, request: Any) -> None:
        with suppress(OSError):  # that it is dead is met when receiving
            self._link.send(request)

    def receive(self, timeout_s: float) -> Any:
        """The next event, or None where none comes in time. Raises Died."""
        try:
            event = self._link.recv() if self._link.poll(timeout_s) else None
        except Exception:  # noqa: BLE001 - a process that crashes may leave half a message, or any other
            raise Died(self._end()) from None
        if event is None and self._gone:
            raise Died(self._end())
        return event

    @property
    def _gone(self) -> bool:
        """Whether it was killed and has ended, or does not end. Processes that it started may hold its link longer."""
        if self._killed == float("inf"):
            return False
        return self._abandoned or self.process.poll() is not None or time.monotonic() > self._killed + END_S

    def resident_bytes(self) -> int:
        """Main memory that it uses now, as far as it was looked at just before."""
        if time.monotonic() >= self._held_at + LOOK_S:
            self._held, self._held_at = resident_bytes(self.process.pid), time.monotonic()
        return self._held

    def kill(self, cause: Cause) -> None:
        """End it at once, whatever it does; what it has sent can still be received."""
        if self._cause is None:
            self._cause, self._killed, self._held_at = cause, time.monotonic(), -LOOK_S
        self.process.kill()

    def abandon(self) -> None:
        """Kill it, and wait no more for its end, which the kernel may take seconds for where the machine is busy."""
        self.kill(("crashed", "the run has ended"))
        self._abandoned = True

    def close(self) -> None:
        """Let it end, or end it."""
        self._link.close()
        self._wait()
        with suppress(OSError):
            os.close(self._log)

    def _wait(self) -> int | None:
        """Its status, with or without its will; None where even killing it does not end it."""
        for _ in range(2):
            with suppress(subprocess.TimeoutExpired):
                return self.process.wait(0 if self._abandoned else END_S)
            self.process.kill()
        return self.process.poll()

    def _end(self) -> Cause:
        """The status and reason for which the process ended."""
        status = self._wait()
        if self._cause or status is None:
            return self._cause or ("crashed", "it does not end")
        if status == -signal.SIGKILL and kernel_kills() > self._kills:
            return "out_of_memory", f"the kernel ended it for lack of memory when it had {self._held / MIB:,.0f} MiB"
        what = f"killed by {signal.Signals(-status).name}" if status < 0 else f"ended with exit status {status}"
        return "crashed", ": ".join(filter(None, [what, self._last_line()]))

    def _last_line(self) -> str:
        """The last that it printed, for instance by a driver that gives up."""
        size = os.fstat(self._log).st_size
        lines = os.pread(self._log, 4096, max(0, size - 4096)).decode(errors="replace").split("\n")
        return next((" ".join(line.split()) for line in reversed(lines) if line.strip()), "")
