"""The process that draws the first frames of cells before their turn: serves `precompile.Precompiler`."""

from __future__ import annotations

import os
import signal
import time
from collections.abc import Mapping
from contextlib import suppress
from multiprocessing.connection import Connection

from ..gpu.device import open_device
from ..gpu.frame import Frame
from ..gpu.programs import Programs
from ..gpu.timers import WallTimer
from ..methods import catalog
from ..methods.spec import Fitted
from .bench import Bench
from .jobs import Job
from .parent import live_for
from .scene_work import SceneWork

PROGRAMS = 16  # that it keeps
LONGEST_S = 60.0  # of processor time for one cell, after which the kernel ends the process


def serve(link: Connection, parent: int, index: int, wanted: frozenset[str] | None, failed_trials: Mapping[str, str],
          flushes: bool) -> None:
    """Draw the first frame of each cell that comes; the answer is its key with the processor time that it took.

    A key that comes says that the cell is not to be drawn any more; the answer then has None for the time. index: of
    the device. wanted, failed_trials, flushes: what the process that measures was told of it, and has found out.
    """
    live_for(parent)
    _say_nothing()
    device = open_device(str(index))
    device.programs = Programs(PROGRAMS)
    device.wanted, device.failed_trials, device.flushes_dispatches = wanted, dict(failed_trials), flushes
    scenes = _Scenes(Bench(device, WallTimer(device), lambda event: None))
    asked: dict[str, Job] = {}
    with suppress(EOFError, ConnectionError):
        while True:
            job = _next(link, asked)
            signal.setitimer(signal.ITIMER_PROF, LONGEST_S)  # without a handler it ends the process, in a driver too
            begun = time.process_time()
            with suppress(Exception):  # what is wrong with the cell, the process that measures will find
                scenes.draw(job)
            spent_s = time.process_time() - begun
            signal.setitimer(signal.ITIMER_PROF, 0)
            if not device.alive():
                break
            link.send((job.key, spent_s))
    os._exit(0)  # without the exit handlers of a driver, which may hang


def _next(link: Connection, asked: dict[str, Job]) -> Job:
    """The cell that was asked for first, of those that are still wanted. Waits for one."""
    while not asked or link.poll(0):
        message = link.recv()
        if isinstance(message, str):
            if asked.pop(message, None):
                link.send((message, None))
        else:
            asked[message.key] = message
    return asked.pop(next(iter(asked)))


def _say_nothing() -> None:
    """Print nothing: the last line is that of the process that measures."""
    nowhere = os.open(os.devnull, os.O_RDWR)
    for descriptor in (1, 2):
        os.dup2(nowhere, descriptor)


class _Scenes:
    """The scene of the cells that are drawn, kept until one of another scene comes."""

    def __init__(self, bench: Bench):
        self._bench, self._catalog = bench, catalog()
        self._scene: SceneWork | None = None

    def draw(self, job: Job) -> None:
        """Draw the first frame of a cell as the process that measures will, and the passes that count at its end."""
        scene, device = self._of(job), self._bench.device
        scene.show(0)
        device.times_frames = not job.cell.measure.single
        variant = self._catalog[job.cell.method].variant(job.cell.params)
        frame = Frame(device, Fitted(variant, scene.stats, device.limits.features), scene.scene_buffer, scene.canvas)
        try:
            frame.draw_fitting()
            frame.compile_probes()
            device.finish()
        finally:
            frame.release()

    def _of(self, job: Job) -> SceneWork:
        if self._scene is None or self._scene.config != job.cell.scene:
            if self._scene:
                self._scene.release()
            self._scene = None
            self._scene = SceneWork(self._bench, job.cell.scene)
        return self._scene
