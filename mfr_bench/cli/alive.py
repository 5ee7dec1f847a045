"""A sign of life: as long as a command has printed nothing, a terminal shows that it is at work, and for how long."""

from __future__ import annotations

import os
import stat
import sys
import threading
import time
from contextlib import suppress
from typing import TextIO

SILENCE_S = 1.0  # before the first sign, and between two
ERASED = "\r\x1b[K"


class SignOfLife:
    """A line on a terminal that tells a new time after each silence, until `end` erases it; prints call that first."""

    def __init__(self, name: str, stream: TextIO, silence_s: float):
        self._name, self._stream, self._silence_s = name, stream, silence_s
        self._begun_s, self._shown = time.monotonic(), False
        self._over, self._writing = threading.Event(), threading.Lock()
        threading.Thread(target=self._show, daemon=True).start()

    def _show(self) -> None:
        while not self._over.wait(self._silence_s):
            with self._writing:
                if not self._over.is_set():
                    self._write(f"{ERASED}{self._name}: at work, {time.monotonic() - self._begun_s:.0f} s")
                    self._shown = True

    def end(self) -> None:
        """Show nothing more."""
        self._over.set()
        with self._writing:
            if self._shown:
                self._write(ERASED)
            self._shown = False

    def _write(self, text: str) -> None:
        with suppress(OSError, ValueError):  # the terminal may be gone, or the stream closed
            self._stream.write(text)
            self._stream.flush()


_sign: SignOfLife | None = None


def begin(command: str) -> None:
    """Show signs of life of a command, where its user sees stderr and waits for it; asked for quiet, they see none."""
    global _sign  # noqa: PLW0603 - a process has one terminal
    if not {"--quiet", "--help", "-h"}.intersection(sys.argv) and _is_watched():
        _sign = SignOfLife(f"mfr-bench {command}", sys.stderr, SILENCE_S)


def end() -> None:
    """Show no more of them: something is printed, or the command ends."""
    if _sign:
        _sign.end()


def _is_watched() -> bool:
    """Whether stderr is a terminal that can erase a line, and stdout no pipe, whose reader may fill the terminal."""
    try:
        printed = os.fstat(1).st_mode
        return sys.stderr.isatty() and os.environ.get("TERM") != "dumb" and (os.isatty(1) or stat.S_ISREG(printed))
    except OSError:
        return False
