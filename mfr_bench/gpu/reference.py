"""Draws a frame that is always the same, whose time tells how fast the device is just now."""

from __future__ import annotations

import time

from ..config.model import Scene as SceneConfig
from ..methods import catalog
from .context import Device
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
        self._scene = ProbeBench(device, SCENE)
        self._frame = self._scene.frame(catalog()["floor"])
        self._frame.draw_fitting()

    def __call__(self) -> float:
        """The shortest wall time of a few such frames one after another, in ms."""
        return min(self._once() for _ in range(TRIES))

    def _once(self) -> float:
        self._device.finish()
        start = time.perf_counter()
        self._frame.draw()
        self._device.finish()
        return (time.perf_counter() - start) * 1e3

    def release(self) -> None:
        self._frame.release()
        self._scene.release()
