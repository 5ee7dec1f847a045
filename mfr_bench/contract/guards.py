"""No method writes outside its buffers: words behind each of them keep their pattern, whatever the count."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from ..gpu.allocation import Allocation
from ..gpu.frame import Frame
from ..gpu.scene_buffer import SceneBuffer
from ..gpu.targets import Canvas
from ..gpu.truth import true_stats
from ..methods.spec import Fitted, Method, Variant
from ..scene import Scene as SceneConfig
from ..scene import generate
from .cases import runs_here

WORDS = 4032  # behind each buffer, and bound with it: a driver may check bounds, and drop what is written beyond
GUARD = np.full(WORDS, 0xA5C3F00D, dtype=np.uint32).tobytes()
PIXELS = (13, 7)
SCENES = {
    "one pixel has all": SceneConfig(size=PIXELS, depth_complexity=8, pixel_density=1 / 91, seed=1),
    "every pixel has one": SceneConfig(size=PIXELS, depth_complexity=1, seed=2),
    "exactly full": SceneConfig(size=PIXELS, depth_complexity=7, seed=3),
    "one over": SceneConfig(size=PIXELS, depth_complexity=8, seed=4),
    "nothing": SceneConfig(size=PIXELS, depth_complexity=0, seed=5),
    "equal depths": SceneConfig(size=PIXELS, depth_complexity=8, depth_copies=8, seed=6),
    "far corners": SceneConfig(size=PIXELS, depth_complexity=8, overhang=2**20, odd_depth="nan", seed=7),
}
K = 7


class Guarded(Allocation):
    """An allocation with guard words behind every buffer."""

    def _allocate(self, trims: bool = False):
        super()._allocate(trims)
        for buffer in self._fitted.variant.buffers:
            copies = self._buffers[buffer.name]
            for at, made in enumerate(copies):
                if not isinstance(made, _Fenced):
                    copies[at] = _Fenced(self._device, made)

    @property
    def broken(self) -> list[str]:
        return [name for name, copies in self._buffers.items() for b in copies if not b.whole]


class _Fenced:
    """A buffer in a longer one: `size` is that of the front part."""

    def __init__(self, device, plain):
        self.size = plain.size
        self._buffer = device.ctx.buffer(bytes(self.size) + GUARD)
        self.glo = self._buffer.glo
        plain.release()

    @property
    def mglo(self):
        """The buffers from which attributes and indirect commands are read."""
        return self._buffer.mglo

    def bind_to_storage_buffer(self, binding):
        self._buffer.bind_to_storage_buffer(binding)

    def read(self, *args, **more):
        return self._buffer.read(self.size, *args, **more)

    def release(self):
        self._buffer.release()

    @property
    def whole(self) -> bool:
        return self._buffer.read(len(GUARD), offset=self.size) == GUARD


class GuardedFrame(Frame):
    """A frame whose buffers are guarded."""

    ALLOCATION = Guarded


def variant_of(method: Method) -> Variant:
    """The variant with room for K fragments where the method has a k, and 64-bit atomics emulated."""
    atomics = method.param("atomic64")
    return method.variant(({"k": K} if method.param("k") else {})
                          | ({"atomic64": "emulated"} if atomics and atomics.acts is None else {}))


def broken(device, variant: Variant, config: SceneConfig, untold: int = 0) -> list[str]:
    """The buffers behind which two frames have written; the method expects `untold` fragments fewer per pixel."""
    scene = generate(config)
    quads, canvas = SceneBuffer(device, scene), Canvas(device, config.size)
    stats = true_stats(device, quads, canvas)
    stats = replace(stats, n=max(1, stats.n - untold), F=stats.F - untold * stats.P)
    frame = GuardedFrame(device, Fitted(variant, stats), quads, canvas)
    try:
        frame.draw_fitting()
        frame.draw()
        device.finish()
        return frame.allocation.broken
    finally:
        for thing in (frame, canvas, quads):
            thing.release()


def keeps_to_its_buffers(device, method: Method) -> Iterator[str]:
    """Every count of fragments, and one that the method does not know of."""
    variant = variant_of(method)
    if not runs_here(device, variant):
        return
    for name, config in SCENES.items():
        yield from (f"{name}: something is written behind {buffer}" for buffer in broken(device, variant, config))
    yield from (f"one fragment per pixel more than the method knows of: something is written behind {buffer}"
                for buffer in broken(device, variant, SCENES["one over"], untold=1))
