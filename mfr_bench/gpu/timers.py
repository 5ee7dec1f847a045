"""Frame and pass times: by the wall clock between two finishes, or by 64-bit GPU timestamps."""

from __future__ import annotations

import time
from collections.abc import Callable

from . import rawgl
from .device import Device

Draw = Callable[[Callable[[str], None] | None], object]


class WallTimer:
    """Wall time between two glFinish. Right everywhere, and includes what the driver does on the CPU."""

    name = "wall"

    def __init__(self, device: Device):
        self.device = device

    def frame_ms(self, draw: Draw) -> float:
        self.device.finish()
        start = time.perf_counter()
        draw(None)
        self.device.finish()
        return (time.perf_counter() - start) * 1e3

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

    def frame_ms(self, draw: Draw) -> float:
        self.device.finish()
        self._stamp(0)
        draw(None)
        self._stamp(1)
        return (self._read_ns(1) - self._read_ns(0)) / 1e6

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

