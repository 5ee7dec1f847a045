"""Measures how fast a device copies and fills, as a yardstick for what methods read, write and shade."""

from __future__ import annotations

import time
from collections.abc import Callable

import numpy as np

from ..methods.spec import IMAGE, Fitted, Method, Pass, SceneStats
from ..scene.quads import Quads
from .context import Device
from .frame import Frame
from .scene_buffer import SceneBuffer
from .targets import Canvas

COPY_BYTES = 2**25  # beyond the last cache of most devices, below a storage block of every one
SIDE = 1024  # pixels of the target that is filled
LONG_ENOUGH_S = 0.01  # compared with which a round trip to the device is short
FILL = Method(id="fill", name="fill", family="probe", source="", summary="", guarantee="none", words="0", ties="",
              steps=(Pass("fill", "fullscreen", "probe/fill.frag", into=(IMAGE,)),))


def rates(device: Device) -> dict[str, float]:
    """`copy_bytes_per_s`, read and written alike, and `fill_pixels_per_s` of 16 bytes; the best of a few tries."""
    return {"copy_bytes_per_s": _copied(device), "fill_pixels_per_s": _filled(device)}


def _copied(device: Device) -> float:
    source, target = (device.ctx.buffer(reserve=COPY_BYTES) for _ in range(2))
    try:
        return 2 * COPY_BYTES * _per_second(device, lambda: device.ctx.copy_buffer(target, source))
    finally:
        source.release()
        target.release()


def _filled(device: Device) -> float:
    scene = Quads((SIDE, SIDE), np.zeros((0, 4), np.int32), np.zeros(0, np.float32), np.zeros((0, 4), np.uint8), 1.0, 0)
    scene_buffer, canvas = SceneBuffer(device, scene), Canvas(device, (SIDE, SIDE))
    stats = SceneStats(W=SIDE, H=SIDE, n=1, F=0, primitives=0)
    frame = Frame(device, Fitted(FILL.variant({}), stats), scene_buffer, canvas)
    try:
        return SIDE * SIDE * _per_second(device, frame.draw)
    finally:
        frame.release()
        canvas.release()
        scene_buffer.release()


def _per_second(device: Device, work: Callable[[], object]) -> float:
    """The rate of the work per second, at best; what it takes longer for the first time is left out."""
    work()
    times, count = _time(device, work, 1), 1
    while times < LONG_ENOUGH_S and count < 2**12:
        count *= 2
        times = _time(device, work, count)
    return count / min(times, _time(device, work, count), _time(device, work, count))


def _time(device: Device, work: Callable[[], object], count: int) -> float:
    device.finish()
    start = time.perf_counter()
    for _ in range(count):
        work()
    device.finish()
    return time.perf_counter() - start
