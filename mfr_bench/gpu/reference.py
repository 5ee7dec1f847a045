"""Draws a frame that is always the same, whose time tells how fast the device is just now."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from functools import cached_property

from ..methods import catalog
from ..scene import Scene as SceneConfig
from .context import Device
from .frame import Frame
from .probes import ProbeBench

SCENE = SceneConfig(size=(96, 96), depth_complexity=16)  # 0.3 ms on llvmpipe with two threads
TRIES = 4  # frames at most, of which the shortest counts
AS_EVER = 1.1  # times the best frame ever, up to which one was not held up: half of what tells a slower device
ALIKE = 1.05  # times another of the same look, up to which neither was


def shortest_ms(draw_ms: Callable[[], float], best_ms: float) -> float:
    """The shortest of as few frames as tell it from one that was held up, TRIES at most.

    draw_ms: draws a frame and returns its time in ms. best_ms: of all earlier ones; infinite without any. A frame that
    takes hardly longer than the best, or as long as another of these, was not held up: hardly ever are two held up for
    the same time.
    """
    times_ms: list[float] = []
    while len(times_ms) < TRIES:
        times_ms = sorted([*times_ms, draw_ms()])
        as_ever = times_ms[0] <= AS_EVER * best_ms < math.inf
        if as_ever or (times_ms[1:] and times_ms[1] <= ALIKE * times_ms[0]):
            break
    return times_ms[0]


class ReferenceFrame:
    """The blending floor of a small scene: each layer reads and writes the image, so that it feels caches and memory.

    On a processor that others share, frames that only compute take as long as ever while those that move much data
    take nearly twice as long; a GPU's clocks change both.
    """

    def __init__(self, device: Device):
        self._device = device

    def __call__(self, best_ms: float) -> float:
        """The shortest wall time of a few such frames one after another, in ms, as of `shortest_ms`."""
        now_ms = shortest_ms(self._once, best_ms)
        self._device.settle()  # what is drawn next is another method
        return now_ms

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
