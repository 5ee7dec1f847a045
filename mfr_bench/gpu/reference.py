"""Draws a frame that is always the same, whose time tells how fast the device is just now."""

from __future__ import annotations

import time
from functools import cached_property

from ..config.model import Scene as SceneConfig
from ..methods import catalog
from .context import Device
from .frame import Frame
from .probes import ProbeBench

SCENE = SceneConfig(size=(96, 96), depth_complexity=16)  # 0.3 ms on llvmpipe with two threads
TRIES = 4


class ReferenceFrame:
    """The blending floor of a small scene: each layer reads and writes the image, so that it feels caches and memory.

    On a processor that others share, frames that only compute take as long as ever while those that move much data
    take nearly twice as long; a GPU's clocks change both.
    """

    def __init__(self, device: Device):
        self._device = device

    def __call__(self) -> float:
        """The shortest wall time of a few such frames one after another, in ms."""
        shortest_ms = min(self._once() for _ in range(TRIES))
        self._device.settle()  # what is drawn next is another method
        return shortest_ms

    @cached_property
    def _frame(self) -> Frame:
        """The frame, compiled when it is drawn first."""
        frame = ProbeBench(self._device, SCENE).frame(catalog()["floor"])
        frame.draw_fitting()
        return frame

    def _once(self) -> float:
        frame = self._frame
        self._device.finish()
        start = time.perf_counter()
        frame.draw()
        self._device.finish()
        return (time.perf_counter() - start) * 1e3
