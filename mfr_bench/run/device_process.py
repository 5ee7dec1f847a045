"""The worker that has the device, as the run sees it: opened once, and replaced on the same device where it dies."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from typing import TypeVar

from ..errors import DeviceError, UnknownDeviceError
from .events import Calibrate, Calibrated, Failed, Needs, Ready, SelfTest, SelfTested
from .hand import START_S
from .process import Died, Worker

T = TypeVar("T")
LOOK_S = 0.1  # that one look for an event waits at most
STARTS = 3  # of a new worker, before the device counts as gone
PAUSE_S = 1.0  # before the next of them


class DeviceProcess:
    """The process that has the device of the kind `want`; it starts at once, and opens the device meanwhile.

    `asked`: whether the user wants the run to stop. timer: None lets the process choose one. worker: the process, where
    it was started before.
    """

    def __init__(self, want: str, asked: Callable[[], bool], timer: str | None = None, worker: Worker | None = None):
        self._want, self._asked = want, asked
        self._worker = worker or Worker(want, timer)  # None once the device is gone
        self._needs: Needs | None = None
        self._ready: Ready | None = None

    def expect(self, needs: Needs) -> None:
        """Tell it what is needed of the device, before `ready` tells it that all is."""
        self._needs = needs
        self._worker.send(needs)

    def ready(self) -> Ready:
        """The device. Raises DeviceError where there is none."""
        if self._needs is None:
            self.expect(Needs())
        if self._ready is None:
            self._ready = self._opened(self._worker)
        return self._ready

    def send(self, message: object) -> None:
        self._worker.send(message)

    def receive(self) -> object | None:
        """The next event, if one comes soon. Raises Died."""
        return self._worker.receive(LOOK_S)

    def resident_bytes(self) -> int:
        return self._worker.resident_bytes()

    def kill(self, status: str, reason: str) -> None:
        """End the worker; the next `receive` raises Died with this status and reason."""
        self._worker.kill((status, reason))

    def abandon(self) -> None:
        """End the worker without waiting for its end; once what it has sent is received, `receive` raises Died."""
        self._worker.abandon()

    def close(self, early: bool) -> None:
        """End the process, `early` without waiting for what it is at."""
        if self._worker is None:
            return
        if early:
            self.abandon()
        self._worker.close()

    def calibrate_again(self) -> Mapping[str, object] | None:
        """The worker's calibration now; None where it dies of it, does not answer, or the user asks to stop."""
        answer = self._answer(Calibrate(), Calibrated)
        return answer.calibration if answer else None

    def self_tests(self) -> SelfTested | None:
        """What the worker's self-tests find; None as of `calibrate_again`."""
        return self._answer(SelfTest(), SelfTested)

    def _answer(self, question: object, kind: type[T]) -> T | None:
        """The worker's answer, of this kind; None where it dies of it, does not answer, or the user asks to stop."""
        if self._worker is None:
            return None
        self.send(question)
        start = time.monotonic()
        while time.monotonic() - start < START_S and not self._asked():
            try:
                event = self.receive()
            except Died:
                return None
            if isinstance(event, kind):
                return event
        return None

    def replace(self, deaths: int) -> None:
        """Start another worker on the same device. Raises DeviceError if none starts, or after too many `deaths`.

        deaths: of workers one after another, each between two cells.
        """
        self._worker.close()
        reason = "the process that measures died again and again, with no cell in hand"
        for start in range(STARTS if deaths < STARTS else 0):
            time.sleep(PAUSE_S * bool(start))
            self._worker = Worker(self._want, self._ready.timer)
            self._worker.send(self._needs)
            try:
                opened = self._opened(self._worker)
            except DeviceError as error:
                reason = str(error)
                self._worker.kill(("crashed", reason))
                self._worker.close()
                continue
            if opened.device == self._ready.device:
                return
            reason = f"it is now {opened.device['renderer']}, {opened.device['version']}"
            self._worker.close()
        self._worker = None
        raise DeviceError(f"the OpenGL device {self._ready.device['renderer']} is gone: {reason}")

    def _opened(self, worker: Worker) -> Ready:
        start = time.monotonic()
        while time.monotonic() - start < START_S:
            try:
                event = worker.receive(LOOK_S)
            except Died as death:
                raise DeviceError(f"the OpenGL device cannot be opened: {death}") from None
            if isinstance(event, Failed):
                raise (UnknownDeviceError if event.unknown else DeviceError)(event.reason)
            if isinstance(event, Ready):
                return event
            if self._asked():
                raise KeyboardInterrupt
        raise DeviceError(f"the OpenGL device cannot be opened: no answer within {START_S:g} s")
