"""Runs one share of a run on a node, as a process group that is ended whole, and queued again if it was cut off."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, field

# Becomes a command that the kernel ends with its parent, also if that is killed, or was before this had begun.
ENDED_WITH_PARENT = """
import ctypes, os, sys
ctypes.CDLL(None).prctl(1, 15)  # PR_SET_PDEATHSIG, SIGTERM
if os.getppid() == int(sys.argv[1]):
    os.execv(sys.argv[2], sys.argv[2:])
"""
LOOK_S = 0.1
PATIENCE_S = 20.0  # for a run that was asked to end; Slurm's KillWait is 30 s by default


@dataclass
class Task:
    """A command, which submitit calls on the node. What it measured is in its folder, whatever ends it."""

    command: Sequence[str]
    _child: subprocess.Popen | None = field(default=None, repr=False)

    def __call__(self) -> int:
        """Run the command to its end; its exit status. SIGTERM, which submitit's worker ignores, ends it in time."""
        before = signal.signal(signal.SIGTERM, lambda number, frame: self.end())
        try:
            self._child = subprocess.Popen([sys.executable, "-c", ENDED_WITH_PARENT, str(os.getpid()), *self.command],
                                           start_new_session=True)
            return self._ended(None)
        finally:
            self.end()
            signal.signal(signal.SIGTERM, before)

    def end(self) -> None:
        """Ask the run to end, and kill its whole group where it does not."""
        for number in (signal.SIGTERM, signal.SIGKILL):
            if self._child is None or self._ended(0) is not None:
                break
            with suppress(ProcessLookupError):
                os.killpg(self._child.pid, number)
            self._ended(PATIENCE_S)
        if self._child is not None:
            with suppress(ProcessLookupError):  # what it left behind
                os.killpg(self._child.pid, signal.SIGKILL)

    def _ended(self, patience_s: float | None) -> int | None:
        """The run's exit status; None where it runs on after so long. A signal handler may ask within a call of it."""
        until = None if patience_s is None else time.monotonic() + patience_s
        while (status := self._child.poll()) is None and (until is None or time.monotonic() < until):
            time.sleep(LOOK_S)
        return status

    def checkpoint(self):
        """End the run before the engine does, and ask for another job that goes on with it."""
        from submitit.helpers import DelayedSubmission

        self.end()
        return DelayedSubmission(Task(self.command))

    def __getstate__(self) -> dict[str, object]:
        return {"command": list(self.command), "_child": None}
