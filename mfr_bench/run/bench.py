"""The bench that the cells of a process share: the device, the timer, and the receiver of events."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any

from ..gpu.context import Device
from ..gpu.timers import Timer
from ..measure.split import Split
from .aside import Aside, AtOnce
from .events import CHECK, Begun

Emit = Callable[[Any], None]


@dataclass
class Bench:
    """The device and the timer of every cell, and `emit`, which receives the events of its measurement.

    aside: does what no frame waits for.
    """

    device: Device
    timer: Timer
    emit: Emit
    interrupted: Callable[[], bool] = lambda: False
    split: Split = field(default_factory=Split)
    aside: Aside = field(default_factory=AtOnce)

    def stop_if_asked(self) -> None:
        if self.interrupted():
            raise KeyboardInterrupt


class Phases:
    """Reports which phase of its measurement a cell is in; the supervisor limits each by its kind."""

    def __init__(self, bench: Bench, key: str):
        self._bench, self._key, self._now = bench, key, ""

    def begin(self, phase: str) -> None:
        self._now = phase
        self._bench.emit(Begun(self._key, phase))

    @contextmanager
    def checking(self) -> Iterator[None]:
        """The harness's own work on images, which counts as no time of the method."""
        before = self._now
        self.begin(CHECK)
        with self._bench.split.work("check"):
            yield
        self.begin(before)
