"""No method writes outside its buffers: words behind each of them keep their pattern, whatever the count."""

from dataclasses import replace

import numpy as np
import pytest

from mfr_bench import glsl
from mfr_bench.config.model import Scene as SceneConfig
from mfr_bench.gpu.allocation import Allocation
from mfr_bench.gpu.frame import Frame
from mfr_bench.gpu.scene_buffer import SceneBuffer
from mfr_bench.gpu.targets import Canvas
from mfr_bench.gpu.truth import true_stats
from mfr_bench.methods import catalog
from mfr_bench.methods.spec import Fitted, Variant
from mfr_bench.scene import generate

from .cases import every_method, runs_here

WORDS = 4032  # behind each buffer, and bound with it: a driver may check bounds, and drop what is written beyond
GUARD = np.full(WORDS, 0xA5C3F00D, dtype=np.uint32).tobytes()
PIXELS = (13, 7)
SCENES = {
    "one pixel has all": SceneConfig(size=PIXELS, depth_complexity=40, pixel_density=1 / 91, seed=1),
    "every pixel has one": SceneConfig(size=PIXELS, depth_complexity=1, seed=2),
    "exactly full": SceneConfig(size=PIXELS, depth_complexity=8, seed=3),
    "one over": SceneConfig(size=PIXELS, depth_complexity=9, seed=4),
    "nothing": SceneConfig(size=PIXELS, depth_complexity=0, seed=5),
    "equal depths": SceneConfig(size=PIXELS, depth_complexity=9, depth_copies=9, seed=6),
    "far corners": SceneConfig(size=PIXELS, depth_complexity=9, overhang=2**20, odd_depth="nan", seed=7),
}
K = 8


class Guarded(Allocation):
    """An allocation with guard words behind every buffer."""

    def _allocate(self):
        super()._allocate()
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
        """What attributes and indirect commands are read from."""
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


def variant_of(method) -> Variant:
    """The variant with room for K fragments where the method has a k, and emulated atomics where it needs wide ones."""
    wide = method.param("atomic64")
    return method.variant(({"k": K} if method.param("k") else {})
                          | ({"atomic64": "emulated"} if wide and wide.acts is None else {}))


def broken(device, variant, config, untold: int = 0) -> list[str]:
    """The buffers behind which two frames have written; the method is told of `untold` fragments less per pixel."""
    scene = generate(config)
    quads, canvas = SceneBuffer(device, scene), Canvas(device, config.size)
    stats = true_stats(device, quads, canvas)
    stats = replace(stats, n=max(1, stats.n - untold), F=stats.F - untold * stats.P)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("mfr_bench.gpu.frame.Allocation", Guarded)
        frame = Frame(device, Fitted(variant, stats), quads, canvas)
    try:
        frame.draw_fitting()
        frame.draw()
        device.finish()
        return frame.allocation.broken
    finally:
        for thing in (frame, canvas, quads):
            thing.release()


@pytest.mark.parametrize("method", every_method(), ids=lambda m: m.id)
def test_nothing_is_written_behind_a_buffer(device, method):
    variant = variant_of(method)
    if not runs_here(device, variant):
        pytest.skip(f"this device lacks {', '.join(f for f in variant.needs if f not in device.features)}")
    for name, config in SCENES.items():
        assert broken(device, variant, config) == [], name
    assert broken(device, variant, SCENES["one over"], untold=1) == []


@pytest.mark.parametrize("method", ["ab-array", "ab-sb", "ab-ll"])
def test_nothing_is_written_behind_the_list_of_tiles(device, method):
    variant = catalog()[method].variant({"touched": "tiles"})
    for name, config in SCENES.items():
        assert broken(device, variant, config) == [], name


def test_a_tile_behind_the_list_is_seen(device, plant):
    plant("common/list_tiles.comp", "tile_list[at]", "tile_list[at + 1u]")
    variant = catalog()["ab-array"].variant({"touched": "tiles"})
    assert broken(device, variant, SCENES["exactly full"]) == ["tile_list"]


@pytest.mark.parametrize(("method", "right", "wrong", "buffer"), [
    ("ab-array", "slot < uint(SLOTS)", "slot <= uint(SLOTS)", "nodes"),
    ("ab-array", "nodes[slot * pixels + p]", "nodes[(slot + 1u) * pixels + p]", "nodes"),
    ("kplus-array", "slot < room", "slot <= room", "nodes"),
    ("ab-ll", "cells[cell] = fragment", "cells[cell + 1u] = fragment", "cells"),
])
def test_a_write_behind_a_buffer_is_seen(device, monkeypatch, method, right, wrong, buffer):
    whole = glsl.read
    monkeypatch.setattr(glsl.includes, "read", lambda path: whole(path).replace(right, wrong))
    variant = variant_of(next(m for m in every_method() if m.id == method))
    found = {name for config in SCENES.values() for name in broken(device, variant, config)}
    found |= set(broken(device, variant, SCENES["one over"], untold=1))
    assert buffer in found
