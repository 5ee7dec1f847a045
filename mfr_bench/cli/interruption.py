"""Ctrl-C while a device is at work."""

from __future__ import annotations

import os
import signal
from collections.abc import Iterator
from contextlib import contextmanager

from ..errors import Interrupted
from .output import note


class Interruption:
    """Within this, Ctrl-C is a request: `asked()` turns true, and the work stops where it can.

    An exception in the midst of moderngl's C code would be lost, or end the process with a crash. A second Ctrl-C is
    raised at once where another process has the device; with `device_here`, where nothing is kept that it could
    harm, it ends the process. Within `at_once` the first is raised already. `kill` and a lost connection count as
    Ctrl-C; signals that are ignored, or that another handler has, are left to it. Leaving raises KeyboardInterrupt for
    a wish that the work did not notice.
    """

    def __init__(self, device_here: bool = False) -> None:
        self._asked, self._device_here, self._at_once = False, device_here, False

    def asked(self) -> bool:
        return self._asked

    @contextmanager
    def at_once(self) -> Iterator[None]:
        """Within this the first Ctrl-C ends the work wherever it is, such as planning and drawing.

        Raises KeyboardInterrupt also for a wish of before.
        """
        before, self._at_once = self._at_once, True
        try:
            self._obey()
            yield
        finally:
            self._at_once = before

    @contextmanager
    def in_its_time(self) -> Iterator[None]:
        """Within this, in work that ends at once, the first Ctrl-C is a wish all the same.

        Raises KeyboardInterrupt in the end for one that the work did not notice.
        """
        before, self._at_once = self._at_once, False
        try:
            yield
        finally:
            self._at_once = before
        if before:
            self._obey()

    def _obey(self) -> None:
        if self._asked:
            raise KeyboardInterrupt

    def __enter__(self):
        usual = {signal.SIGINT: signal.default_int_handler, signal.SIGTERM: signal.SIG_DFL,
                 signal.SIGHUP: signal.SIG_DFL}
        self._former = {number: handler for number, handler in usual.items() if signal.getsignal(number) is handler}
        for number in self._former:
            signal.signal(number, self._ask)
        return self

    def _ask(self, number, frame) -> None:
        if self._asked and self._device_here:
            note("interrupted")
            os._exit(Interrupted.exit_status)
        if self._asked:
            raise KeyboardInterrupt
        self._asked = True
        if self._at_once:
            raise KeyboardInterrupt

    def __exit__(self, kind, error, trace) -> None:
        for number, handler in self._former.items():
            signal.signal(number, handler)
        if kind is None and self._asked:
            raise KeyboardInterrupt
