"""Frames of growing buffers: each is right, whatever the frames before it needed."""

from dataclasses import replace

import numpy as np
import pytest

from mfr_bench.config import Scene as SceneConfig
from mfr_bench.gpu.frame import Frame
from mfr_bench.gpu.scene_buffer import SceneBuffer
from mfr_bench.gpu.targets import Canvas
from mfr_bench.methods import catalog
from mfr_bench.methods.spec import Fitted, Grown, Variant
from mfr_bench.oracle.composite import composite, stats_of
from mfr_bench.scene import generate

FEW = SceneConfig(size=(21, 13), depth_complexity=1, alpha=(0.1, 0.6), seed=4)
MANY = replace(FEW, depth_complexity=20)
GROWING = sorted(name for name, method in catalog().items()
                 if isinstance(method.capacity, Grown) and method.guarantee == "exact all")


@pytest.mark.parametrize("method", GROWING)
def test_a_frame_that_needs_more_room_than_the_one_before_is_right(device, method):
    few, many, declared = generate(FEW), generate(MANY), catalog()[method]
    small = replace(declared, capacity=replace(declared.capacity, start="P"))
    emulated = {"atomic64": "emulated"} if any(p.name == "atomic64" for p in declared.params) else {}
    variant = Variant(small, small.complete(emulated))
    quads, canvas = SceneBuffer(device, few), Canvas(device, few.viewport)
    frame = Frame(device, Fitted(variant, stats_of(many)), quads, canvas)
    try:
        frame.draw()
        before = sum(frame.memory_bytes.values())
        quads.replace(many)
        frame.show(many)
        frame.draw()
        assert sum(frame.memory_bytes.values()) > before
        assert np.abs(frame.image() - composite(many)).max() < 1e-4
        assert frame.lost_fragments() == 0
    finally:
        for thing in (frame, canvas, quads):
            thing.release()


@pytest.mark.parametrize("method", GROWING)
def test_only_a_frame_with_room_is_resolved(device, method):
    """A driver may compile what reads a buffer anew for each size that it has."""
    scene, declared = generate(MANY), catalog()[method]
    small = replace(declared, capacity=replace(declared.capacity, start="1"))
    emulated = {"atomic64": "emulated"} if any(p.name == "atomic64" for p in declared.params) else {}
    quads, canvas = SceneBuffer(device, scene), Canvas(device, scene.viewport)
    frame, drawn = Frame(device, Fitted(Variant(small, small.complete(emulated)), stats_of(scene)), quads, canvas), []
    try:
        frame.draw(drawn.append)
        readers = {"resolve", "render"} & set(drawn)
        first = min(map(drawn.index, readers))
        assert drawn.count(drawn[first - 1]) > 3 and drawn[first - 1] not in drawn[first:]
        assert np.abs(frame.image() - composite(scene)).max() < 1e-4
    finally:
        for thing in (frame, canvas, quads):
            thing.release()
