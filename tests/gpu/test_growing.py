"""Frames of growing buffers: each is right, whatever the frames before it needed."""

from dataclasses import replace

import numpy as np
import pytest
from moderngl import Context

from mfr_bench.config import Scene as SceneConfig
from mfr_bench.gpu.frame import Frame
from mfr_bench.gpu.scene_buffer import SceneBuffer
from mfr_bench.gpu.targets import Canvas
from mfr_bench.methods import catalog
from mfr_bench.methods.spec import Fitted, Grown, Variant
from mfr_bench.oracle.composite import composite, stats_of
from mfr_bench.scene import generate

from ..methods.drawing import drawn

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


@pytest.mark.parametrize("params", [{"flat": "ordered"}, {"flat": "stored"}], ids=["ordered", "stored"])
def test_a_frame_of_fewer_layers_than_the_one_before_is_right(device, params):
    """Shaders see the capacity of the frame, not of the deepest so far: what lies behind it is of no layer."""
    many = generate(replace(MANY, depth_complexity=40))
    few = generate(replace(MANY, depth_complexity=12))
    quads, canvas = SceneBuffer(device, many), Canvas(device, many.viewport)
    frame = Frame(device, Fitted(catalog()["adaptive"].variant(params), stats_of(many)), quads, canvas)
    try:
        frame.draw_fitting()
        quads.replace(few)
        frame.show(few)
        frame.draw_fitting()
        assert np.abs(frame.image() - composite(few)).max() < 1e-5
    finally:
        for thing in (frame, canvas, quads):
            thing.release()


@pytest.fixture
def memory_holds(monkeypatch):
    """Fills buffers that are made without contents with a byte."""
    made = Context.buffer

    def holding(byte: int) -> None:
        monkeypatch.setattr(Context, "buffer", lambda self, data=None, *, reserve=0, **more: made(
            self, bytes([byte]) * reserve if data is None else data, **more))
    return holding


@pytest.mark.parametrize("method", [m for m in catalog().values() if any(b.continues for b in m.buffers)],
                         ids=lambda m: m.id)
def test_a_buffer_that_continues_from_the_frame_before_begins_with_zeros(device, memory_holds, method):
    """Whatever the device's memory held, so that each run draws the same frames."""
    [name] = [b.name for b in method.buffers if b.continues]
    found = []
    for byte in (0x00, 0xAB):
        memory_holds(byte)
        with drawn(device, method.id, generate(MANY), atomic64="emulated") as frame:
            found.append(frame.words(name))
    np.testing.assert_array_equal(*found)


@pytest.mark.parametrize("method", [m for m in catalog().values() if m.guarantee == "exact all"], ids=lambda m: m.id)
def test_no_image_depends_on_what_fresh_memory_holds(device, memory_holds, method):
    scene, emulated = generate(MANY), {"atomic64": "emulated"} if method.param("atomic64") else {}
    memory_holds(0xAB)
    with drawn(device, method.id, scene, **emulated) as frame:
        assert np.abs(frame.image() - composite(scene)).max() < 1e-5
        assert frame.lost_fragments() == 0
