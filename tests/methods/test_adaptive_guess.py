"""Dense cells for as many layers as the frame before had: a guess that may cost a frame, never a fragment."""

from contextlib import contextmanager
from dataclasses import replace

import numpy as np
import pytest

from mfr_bench.config.model import Scene as SceneConfig
from mfr_bench.gpu.frame import Frame
from mfr_bench.gpu.scene_buffer import SceneBuffer
from mfr_bench.gpu.targets import Canvas
from mfr_bench.gpu.truth import Truth
from mfr_bench.methods import catalog
from mfr_bench.methods.adaptive import DENSE, RANGES, SPARE_MEMORY, plan
from mfr_bench.methods.spec import Fitted, Known, Plan, Promise
from mfr_bench.oracle.composite import stats_of
from mfr_bench.scene import generate
from mfr_bench.scene.quads import Quads
from mfr_bench.store.status import EXACT_ERROR

from ..contract.cases import SLANTED, Drawn, stage, stats_in
from .drawing import stack

SIZE = (64, 48)
SHALLOW = SceneConfig(size=SIZE, depth_complexity=2, layout="random", quad_size=(11, 7), seed=6)
DEEPER = [replace(SHALLOW, depth_complexity=n, seed=n) for n in (5, 25)]
KNOWN = Known(50, 100, 100, 400, deepest=8)


@contextmanager
def animated(device, scenes, **params):
    """A frame for the scenes, whose fragments are kept in memory, and their buffer."""
    quads, canvas = SceneBuffer(device, scenes[0]), Canvas(device, scenes[0].viewport)
    stats = stats_of(max(scenes, key=len))
    frame = Frame(device, Fitted(catalog()["adaptive"].variant({"shallow": "memory"} | params), stats), quads, canvas)
    try:
        yield frame, quads
    finally:
        for thing in (frame, canvas, quads):
            thing.release()


def show(frame, quads, scene) -> None:
    quads.replace(scene)
    frame.show(scene)


def error(frame, quads, scene) -> float:
    right = Truth(frame.device, quads, frame.canvas).image(Promise())
    return float(np.abs(frame.image() - right).max())


def test_the_frame_before_tells_the_layers_of_dense_cells():
    assert plan(replace(KNOWN, deepest=None), {}).path == RANGES
    assert plan(KNOWN, {}) == Plan(DENSE, replace(KNOWN, layers=8), 800, guessed=True)
    assert plan(replace(KNOWN, layers=6), {}).known.layers == 6


@pytest.mark.parametrize(("spare", "path"), [(0.0, RANGES), (0.79, RANGES), (0.8, DENSE), (8.0, DENSE)])
def test_a_guess_keeps_within_its_memory(spare, path):
    """800 cells, of which 400 are in excess of the 400 of ranges; 0.8 of 500 with the two words for each pixel."""
    assert plan(KNOWN, {SPARE_MEMORY.name: spare}).path == path


def test_needles_of_256_layers_find_room_by_default():
    """Cells for 256 layers of every pixel of their rectangle take 8.03 times as much memory more as exact ranges."""
    needles = Known(3000, 5184, 9216, 138735, deepest=256)
    assert plan(needles, {}).path == DENSE
    assert plan(needles, {SPARE_MEMORY.name: 8.0}).path == RANGES


def test_a_budget_that_holds_every_layer_leaves_the_guess_and_another_gets_bands():
    assert plan(replace(KNOWN, room=5000), {}).guessed
    assert plan(replace(KNOWN, room=4999), {}).banded


@pytest.mark.parametrize("name", SLANTED)
@pytest.mark.parametrize("payload", ["rgba8", "rgba16f"])
def test_slanted_primitives_are_stored_by_a_guess_after_the_first_frame(device, name, payload):
    variant = catalog()["adaptive"].variant({"payload": payload})
    assert Fitted(variant, stats_in(device, SLANTED[name])).plan().guessed
    drawn = Drawn(device, variant, SLANTED[name], frames=3, probing=True)
    assert drawn.error <= EXACT_ERROR and drawn.lost == 0
    assert drawn.passes == 1, "nothing is counted"
    assert drawn.allocated == drawn.declared
    assert drawn.probed["stored_fragments"] == stage(device, SLANTED[name]).stats.F


def test_a_deeper_scene_is_drawn_again_and_the_next_of_its_depth_is_not(device):
    """The room grows by an eighth more than was asked for, so that an animation settles."""
    scenes = [generate(config) for config in (SHALLOW, *DEEPER, replace(DEEPER[-1], seed=41), SHALLOW)]
    with animated(device, scenes) as (frame, quads):
        frame.draw_fitting()
        assert frame.plan.guessed
        passes = []
        for scene in scenes[1:]:
            show(frame, quads, scene)
            frame.draw()
            passes.append(frame.geometry_passes)
            assert error(frame, quads, scene) <= EXACT_ERROR
        assert frame.lost_fragments() == 0
    assert passes == [2, 2, 1, 1]


def pile(count: int, thick: bool = False) -> Quads:
    """`count` quads over the left columns and as many over the right ones, all in one square of the host's bounds.

    They are so faint that none is hidden; or eight of them, the furthest, are `thick` and come first.
    """
    rgba = np.random.default_rng(count).integers(1, 9, (2 * count, 4))
    rgba[:16 * thick, 3] = 40
    scene = stack(np.linspace(0.9, 0.1, 2 * count), rgba)
    scene.rect[::2, 2], scene.rect[1::2, 0] = 3, 4
    return scene


def after_an_overflow(device, before: int = 2, after: int = 7) -> tuple[int, int, bool]:
    """Layers of a frame in which more fragments met room for fewer, its geometry passes, whether it is right."""
    with animated(device, [pile(before), pile(after)], spare_memory=1000.0) as (frame, quads):
        frame.draw_fitting()
        assert frame.plan.guessed and before <= frame.plan.known.layers < after
        show(frame, quads, pile(after))
        assert frame.draw()
        return frame.plan.known.layers, frame.geometry_passes, error(frame, quads, quads.scene) <= EXACT_ERROR


@pytest.mark.parametrize("layers", [8, 24])
def test_a_scene_as_deep_as_the_cells_that_there_are_is_drawn_once(device, layers):
    with animated(device, [pile(layers)], spare_memory=1000.0) as (frame, quads):
        frame.draw_fitting()
        show(frame, quads, pile(layers))
        assert frame.draw()
        assert (frame.plan.known.layers, frame.geometry_passes) == (layers, 1)


UNCLASSED, CLASSED = (2, 7, 8), (20, 30, 40)  # fragments of a pixel in two frames, and layers of the second


@pytest.mark.parametrize(("before", "after", "layers"), [UNCLASSED, CLASSED])
def test_a_frame_tells_how_many_layers_it_needs(device, before, after, layers):
    """And one more for each eight of them, for the frames to come; where pixels are classified and where not."""
    assert after_an_overflow(device, before, after) == (layers, 2, True)


@pytest.mark.parametrize(("shader", "right", "wrong", "case"), [
    ("room.glsl", "atomicMax(deepest", "atomicMin(deepest", UNCLASSED),
    ("room.glsl", "capacity / PLACES", "capacity", UNCLASSED),
    ("room.glsl", "atomicMax(deepest[0], count)", "atomicMax(deepest[0], count - 1u)", UNCLASSED),
    ("resolve.frag", "ask_for_room(counter[place()]);", "", UNCLASSED),
    ("classify.frag", "ask_for_room(count);", "", CLASSED)])
def test_a_wrong_line_of_what_a_frame_tells_is_seen(device, plant, shader, right, wrong, case):
    plant(f"methods/adaptive/{shader}", right, wrong)
    before, after, layers = case
    assert after_an_overflow(device, before, after) != (layers, 2, True)


@pytest.mark.parametrize(("layers", "thick"), [
    (7, False), (8, False), (9, False), (16, False), (17, False), (60, False), (64, False), (100, False), (100, True)])
def test_cells_in_chunks_hold_every_fragment(device, layers, thick):
    """Up to 8 layers side by side by pixel, above in chunks of 8; sorted by every network, merged, in sweeps."""
    scene = pile(layers, thick)
    with animated(device, [scene], spare_memory=1000.0) as (frame, quads):
        for _ in range(2):
            frame.draw_fitting()
        assert frame.plan.guessed and frame.plan.known.layers == (layers if layers <= 8 else -(-layers // 8) * 8)
        assert error(frame, quads, scene) <= EXACT_ERROR and frame.lost_fragments() == 0


@pytest.mark.parametrize("thick", [False, True])
@pytest.mark.parametrize(("spare_memory", "path"), [(0.0, RANGES), (1000.0, DENSE)])
def test_the_last_block_of_a_pixel_ends_with_its_fragments(device, spare_memory, path, thick):
    """Behind them are those of the next pixel, or of a deeper frame. They are merged, or swept where some are thick."""
    deeper, scene = pile(103), pile(87, thick)
    with animated(device, [deeper, scene], spare_memory=spare_memory) as (frame, quads):
        frame.draw_fitting()
        show(frame, quads, scene)
        frame.draw()
        assert frame.plan.path == path
        assert error(frame, quads, scene) <= EXACT_ERROR and frame.lost_fragments() == 0


@pytest.mark.parametrize("layers", [12, 21, 64])
@pytest.mark.parametrize("payload", ["rgba8", "rgba16f"])
def test_cells_read_two_at_a_time_hold_the_same_as_one_by_one(device, layers, payload):
    """Odd and even numbers, in networks and halves; fragments of three words are read one by one."""
    def image():
        with animated(device, [scene], spare_memory=1000.0, payload=payload) as (frame, _):
            frame.draw_fitting()
            resolve = next(step for step in frame.running if step.name == "resolve" and step.resolver)
            assert frame.fitted.reads_pairs(resolve, "nodes") == (payload != "rgba16f")
            return frame.image()

    scene = pile(layers)
    pairs = image()
    with animated(device, [scene], spare_memory=0.0, payload=payload) as (ranges, _):
        ranges.draw_fitting()
        assert ranges.plan.path == RANGES
        np.testing.assert_allclose(pairs, ranges.image(), rtol=0, atol=EXACT_ERROR)


@pytest.mark.parametrize(("shader", "right", "wrong", "payload"), [
    ("store.frag", "slot / uint(CHUNK) * PLACES + p", "slot / uint(CHUNK) * PLACES + p / 2u", "rgba8"),
    ("cells.glsl", "slot % uint(CHUNK);", "0u;", "rgba8"), ("cells.glsl", "(PLACES - 1u)", "(PLACES - 2u)", "rgba16f"),
    ("cells.glsl", "first_cell = p * uint(CHUNK)", "first_cell = p", "rgba8"),
    ("registers.glsl", "at += PLACES * uint(CHUNK)", "at += PLACES", "rgba8"),
    ("registers.glsl", "(at + 6u)", "(at + 4u)", "rgba8"), ("registers.glsl", "pair.zw", "pair.xy", "rgba8"),
    ("registers.glsl", "in_use ? pair.xy : NO_FRAGMENT", "pair.xy", "rgba8"),
    ("registers.glsl", "cell + 1u < end_cell", "cell < end_cell", "rgba8")])
def test_a_wrong_line_of_chunks_is_seen(device, plant, shader, right, wrong, payload):
    plant(f"methods/adaptive/{shader}", right, wrong)
    deeper, scene = pile(24), pile(21)  # which leaves fragments of the first in cells that the second does not use
    with animated(device, [deeper, scene], spare_memory=1000.0, payload=payload) as (frame, quads):
        frame.draw_fitting()
        show(frame, quads, scene)
        frame.draw()
        assert error(frame, quads, scene) > EXACT_ERROR


def test_a_buffer_too_large_for_a_texture_is_read_as_it_lies(device, monkeypatch):
    def image():
        with animated(device, [pile(9)], spare_memory=1000.0) as (frame, quads):
            frame.draw_fitting()
            assert error(frame, quads, quads.scene) <= EXACT_ERROR
            return frame.image(), sorted("_by_storage" in runner.__dict__ for runner in frame._runners.values())

    through, none = image()
    monkeypatch.setattr(type(device), "max_texels", 10)
    as_it_lies, some = image()
    np.testing.assert_array_equal(through, as_it_lies)
    assert not any(none) and any(some)


@pytest.mark.parametrize("layers", [20, 60, 128])
def test_a_frame_reads_cells_through_textures_of_one_format(device, layers):
    """Another texture of the same memory would be taken for the first on zink (the trial 'textures of one buffer')."""
    scene = SceneConfig(size=(31, 13), depth_complexity=layers, layout="random", quad_size=(9, 5), pixel_density=0.6)
    with animated(device, [generate(scene)]) as (frame, _):
        for pairs in (False, True):  # the second frame's layers are guessed
            assert {(ref, frame.fitted.reads_pairs(step, ref)) for step in frame.running for ref in step.texels} <= {
                ("nodes", pairs)}
            frame.draw_fitting()
        assert any(step.pairs for step in frame.running)
