"""The parent's end of the process of one tree: requests, answers, and what becomes of it."""

from __future__ import annotations

import json
import os
import select
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any

from ..errors import UsageError
from .tree import Tree

PROGRAM = ("import runpy, sys; sys.path[:] = sys.argv.pop().split(':'); "
           "runpy.run_path(sys.argv.pop(), run_name='__main__')")
SIDE = Path(__file__).with_name("side.py")
OPENING_S = 120.0  # for a device to be opened and calibrated
END_S = 5.0  # for a process to end by itself
LOOK_S = 0.1  # between two looks whether the user wants the work to stop


class SideError(Exception):
    """The failure of a side, in one line; `dead` where its process is gone, too."""

    def __init__(self, text: str, dead: bool = False):
        super().__init__(text)
        self.dead = dead


class Link:
    """A process that runs the code of a tree. asked: whether the user wants the work to stop."""

    def __init__(self, tree: Tree, asked: Callable[[], bool] = lambda: False):
        self.tree, self._asked = tree, asked
        self._log = tempfile.TemporaryFile()  # noqa: SIM115 - open as long as the process
        path = [*([str(tree.program)] if tree.program else []), *sys.path]
        environment = {**os.environ, **tree.environment}
        self._process = subprocess.Popen([sys.executable, "-c", PROGRAM, str(SIDE), ":".join(path)], cwd=tree.folder,
                                         stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=self._log,
                                         env=environment, start_new_session=True)
        os.set_blocking(self._process.stdout.fileno(), False)
        self._half = b""

    def ask(self, do: str, limit_s: float, **more: Any) -> Mapping[str, Any]:
        """The answer to a request. Raises SideError where it is an error, where the process ends, or takes longer.

        Raises KeyboardInterrupt once the user asks to stop; the process is ended then, whatever it is at.
        """
        try:
            self._process.stdin.write(json.dumps({"do": do, **more}).encode() + b"\n")
            self._process.stdin.flush()
        except OSError:
            raise SideError(self._last_words(), dead=True) from None
        answer = json.loads(self._line(do, limit_s))
        if "error" in answer:
            if answer.get("unfit"):
                raise UsageError(f"versus: {self.tree.name}: its code is too old, or too new, to be measured from here "
                                 f"({answer['error']}); allowed: revisions nearer to this version")
            raise SideError(str(answer["error"]))
        return answer

    def _line(self, do: str, limit_s: float) -> bytes:
        until = time.monotonic() + limit_s
        while b"\n" not in self._half:
            ready, _, _ = select.select([self._process.stdout], [], [], min(limit_s, LOOK_S))
            if self._asked():
                self.close(at_once=True)
                raise KeyboardInterrupt
            if not ready:
                if time.monotonic() < until:
                    continue
                self.close(at_once=True)
                raise SideError(f"no answer to {do} within {limit_s:g} s", dead=True)
            part = self._process.stdout.read()
            if not part:
                raise SideError(self._last_words(), dead=True)
            self._half += part
        line, _, self._half = self._half.partition(b"\n")
        return line

    def _last_words(self) -> str:
        """The way that the process ended, and the last line that it printed."""
        with suppress(subprocess.TimeoutExpired):
            self._process.wait(END_S)
        self._log.seek(0)
        said = [line for line in self._log.read().decode(errors="replace").splitlines() if line.strip()]
        return f"its process ended (status {self._process.returncode}){f': {said[-1]}' if said else ''}"

    def close(self, at_once: bool = False) -> None:
        """End the process."""
        for pipe in (self._process.stdin, self._process.stdout):
            with suppress(OSError):
                pipe.close()
        if at_once:
            self._process.kill()
        try:
            self._process.wait(END_S)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()
        self._log.close()
