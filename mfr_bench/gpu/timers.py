"""Frame and pass times: by the wall clock between two finishes, or by 64-bit GPU timestamps."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterable
from functools import cached_property
from itertools import pairwise

from . import rawgl
from .context import Device

Draw = Callable[[Callable[[str], None] | None], object]

TICKS = 200  # of the clock in a sample, at least: one of them is half a percent
MOST_REPEATS = 1000
LOOKS = 256  # at a clock, to see its tick
RUNNING = 0.9  # processor time over wall time of a frame on the CPU, at least, if no other process held it up
TRIES, TRIES_MS = 8, 50.0  # of a frame that was held up, and of all its tries, after which none is begun


def tick(readings: Iterable[float]) -> float | None:
    """The smallest step between readings of a clock one after another; None where it never moved."""
    return min((later - earlier for earlier, later in pairwise(readings) if later > earlier), default=None)


def repeats_for(frame_ms: float, resolution_ms: float | None) -> int:
    """Frames to draw within one sample so that the clock resolves it to half a percent."""
    if not resolution_ms:
        return 1
    return max(1, math.ceil(min(MOST_REPEATS, TICKS * resolution_ms / frame_ms if frame_ms > 0 else MOST_REPEATS)))


class WallTimer:
    """Wall time between two glFinish. Right everywhere, and includes what the driver does on the CPU."""

    name = "wall"

    def __init__(self, device: Device):
        self.device = device

    @cached_property
    def resolution_ms(self) -> float | None:
        """The clock's tick, as measured."""
        step_ns = tick([time.perf_counter_ns() for _ in range(LOOKS)])
        return None if step_ns is None else step_ns / 1e6

    def frame_ms(self, draw: Draw, repeats: int = 1) -> float:
        """Time of one frame: of `repeats` drawn one after another, divided by their number."""
        self.device.finish()
        start = time.perf_counter()
        for _ in range(repeats):
            draw(None)
        self.device.finish()
        return (time.perf_counter() - start) * 1e3 / repeats

    def passes_ms(self, draw: Draw) -> dict[str, float]:
        """Time of each pass by name, summed over its draws; a finish after every pass slows the frame down."""
        spent: dict[str, float] = {}
        self.device.finish()
        last = time.perf_counter()

        def mark(name: str) -> None:
            nonlocal last
            self.device.finish()
            now = time.perf_counter()
            spent[name] = spent.get(name, 0.0) + (now - last) * 1e3
            last = now

        draw(mark)
        return spent


class GpuTimer:
    """GPU timestamps before and after. 64 bits of nanoseconds: no frame is too long."""

    name = "gpu"

    def __init__(self, device: Device):
        self.device, self.gl = device, device.gl
        self._queries: list[int] = []

    def _stamp(self, index: int) -> None:
        while index >= len(self._queries):
            self._queries.append(self.gl.generate("Queries"))
        self.gl.glQueryCounter(self._queries[index], rawgl.TIMESTAMP)

    def _read_ns(self, index: int) -> int:
        return self.gl.query_result(self._queries[index])

    @cached_property
    def resolution_ms(self) -> float | None:
        """The clock's tick, as measured; None where it stands still without work."""
        for index in range(LOOKS):
            self._stamp(index)
        step_ns = tick([self._read_ns(index) for index in range(LOOKS)])
        return None if step_ns is None else step_ns / 1e6

    def frame_ms(self, draw: Draw, repeats: int = 1) -> float:
        """Time of one frame: of `repeats` drawn one after another, divided by their number."""
        self.device.finish()
        self._stamp(0)
        for _ in range(repeats):
            draw(None)
        self._stamp(1)
        return (self._read_ns(1) - self._read_ns(0)) / 1e6 / repeats

    def passes_ms(self, draw: Draw) -> dict[str, float]:
        """Time of each pass by name, summed over its draws."""
        names: list[str] = []

        def mark(name: str) -> None:
            names.append(name)
            self._stamp(len(names))

        self.device.finish()
        self._stamp(0)
        draw(mark)
        spent: dict[str, float] = {}
        for index, name in enumerate(names):
            spent[name] = spent.get(name, 0.0) + (self._read_ns(index + 1) - self._read_ns(index)) / 1e6
        return spent


Timer = WallTimer | GpuTimer


def undisturbed_ms(timer: Timer, draw: Draw, repeats: int = 1) -> float:
    """The time of a frame that other processes did not hold up; after TRIES, or TRIES_MS, of the one held up least.

    A driver that draws on the CPU always has a thread at work while it draws, so that processor time below wall time
    shows for how long none of them had a processor. A GPU tells nothing of the kind: its first frame counts.
    """
    if timer.name != "wall" or timer.device.info["kind"] != "cpu":
        return timer.frame_ms(draw, repeats)
    tried: list[tuple[float, float]] = []
    while len(tried) < TRIES and sum(ms for _, ms in tried) * repeats < TRIES_MS:
        begun_s = time.process_time()
        time_ms = timer.frame_ms(draw, repeats)
        share = (time.process_time() - begun_s) * 1e3 / (time_ms * repeats) if time_ms else 1.0
        if share >= RUNNING:
            return time_ms
        tried.append((share, time_ms))
    return max(tried)[1]
