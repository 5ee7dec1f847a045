"""The bench that the cells of a process share: the device, the timer, and the receiver of events."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, field
from typing import Any

from ..gpu.context import Device
from ..gpu.timers import Timer
from ..measure.split import Split
from ..measure.watch import Unwatched, Watch
from ..scene import Scene
from ..scene.kinds import kind_of
from .ahead import Ahead
from .answers import Answers
from .aside import Aside, AtOnce
from .events import BETWEEN, Begun
from .precompile import Precompiler

Emit = Callable[[Any], None]
BESIDE_PIXELS = 2**16  # of a scene, from which on it is worth what another process takes to start and to be asked


@dataclass
class Bench:
    """The device and the timer of every cell, and `emit`, which receives the events of its measurement.

    answers: what this process knows of scenes. beside: another process, which does what no frame waits for; None where
    there is none. watch: tells whether the device was slower while samples were taken. precompiler: holds a third
    process, where one helps, which compiles for cells that come later.
    """

    device: Device
    timer: Timer
    emit: Emit
    interrupted: Callable[[], bool] = lambda: False
    answers: Answers = field(default_factory=Answers)
    beside: Aside | None = None
    watch: Watch | Unwatched = field(default_factory=Unwatched)
    precompiler: Precompiler = field(default_factory=lambda: Precompiler(None))

    def __post_init__(self) -> None:
        self.here = AtOnce(self.answers)
        self.ahead = Ahead(self.answers, self.aside_for)

    @property
    def split(self) -> Split:
        """The wall time of this process by kind of work."""
        return self.answers.split

    def aside_for(self, scene: Scene) -> Aside:
        """The doer of the work on a scene that no frame waits for: this process for small scenes.

        It does for those of packages from outside as well, which it alone has imported.
        """
        foreign = kind_of(scene).package(scene) or scene.settings.effect.package
        return self.here if self.beside is None or foreign or math.prod(scene.size) < BESIDE_PIXELS else self.beside

    @contextmanager
    def paused(self) -> Iterator[None]:
        """Within this no other process takes a core that draws."""
        with ExitStack() as stack:
            for process in filter(None, (self.beside, self.precompiler)):
                stack.enter_context(process.paused())
            yield

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
    def within(self, phase: str) -> Iterator[None]:
        """A phase that ends between two steps; where something goes wrong in it, it goes on."""
        self.begin(phase)
        yield
        self.begin(BETWEEN)

    @contextmanager
    def apart(self, phase: str) -> Iterator[None]:
        """A phase of the harness's own, CHECK or WAIT, which counts as no time of the method."""
        before = self._now
        self.begin(phase)
        with self._bench.split.work(phase):
            yield
        self.begin(before)
