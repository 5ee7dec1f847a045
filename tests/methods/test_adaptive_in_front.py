"""Some primitives are opaque: drawn first, they hide fragments, which are then neither stored nor counted."""

from contextlib import contextmanager
from dataclasses import replace

import numpy as np
import pytest

from mfr_bench.config.model import Scene as SceneConfig
from mfr_bench.gpu.frame import Frame
from mfr_bench.gpu.pass_runner import PassRunner
from mfr_bench.gpu.scene_buffer import SceneBuffer
from mfr_bench.gpu.targets import Canvas
from mfr_bench.gpu.truth import true_stats
from mfr_bench.methods import catalog
from mfr_bench.methods.adaptive import DENSE, NEAREST, PLANES, RANGES, plan
from mfr_bench.methods.shared.in_framebuffer import KEPT
from mfr_bench.methods.shared.opaque_first import ENOUGH, hidden_share
from mfr_bench.methods.spec import FRAMEBUFFER_FETCH, Fitted, Known, Plan
from mfr_bench.oracle.composite import scene_stats
from mfr_bench.scene import generate
from mfr_bench.scene.primitives import OPAQUE
from mfr_bench.scene.triangles import Triangles
from mfr_bench.store.status import EXACT_ERROR

from .test_adaptive_guess import error, show

KNOWN = Known(50, 100, 100, 400, deepest=12, opaque=0.5, draws_in_parts=True, expected=1000)
DEEP = SceneConfig(kind="hairball", size=(48, 40), depth_complexity=40, mean_depth=15, seed=9)
FEW = replace(DEEP, depth_complexity=12, mean_depth=5)


def partly(config: SceneConfig, share: float = 0.5, seed: int = 0):
    """The scene with so many opaque primitives among the others."""
    made = generate(config)
    rgba = made.rgba.copy()
    rgba[np.random.default_rng(seed).random(len(rgba)) < share, 3] = OPAQUE
    return replace(made, rgba=rgba)


def in_triangles(scene) -> Triangles:
    """The same scene with the two triangles of each strip as primitives of their own."""
    corners = scene.position[:, [[0, 1, 2], [2, 1, 3]]].reshape(-1, 3, 4)
    return Triangles(scene.viewport, corners, np.repeat(scene.rgba, 2, axis=0), 1.0, scene.seed,
                     np.zeros(len(corners), np.int32))


@contextmanager
def shown(device, scene, **params):
    """A frame for the scene, and the scene's buffer."""
    buffer, canvas = SceneBuffer(device, scene), Canvas(device, scene.viewport)
    stats = true_stats(device, buffer, canvas)
    frame = Frame(device, Fitted(catalog()["adaptive"].variant(params), stats), buffer, canvas)
    try:
        yield frame, buffer
    finally:
        for thing in (frame, canvas, buffer):
            thing.release()


def test_what_lies_behind_opaque_primitives_is_left_out_where_it_is_enough():
    chosen = plan(KNOWN, {"shallow": "memory"})
    assert chosen.in_front and replace(chosen, in_front=False) == plan(KNOWN, {"opaque": "stored"})
    assert plan(replace(KNOWN, fetches=True, deepest=6), {}) == Plan(
        KEPT, replace(KNOWN, fetches=True, deepest=6, layers=6), 0, guessed=True, in_front=True)
    assert plan(replace(KNOWN, opaque=1.0), {}).path == NEAREST


@pytest.mark.parametrize("known", [
    replace(KNOWN, draws_in_parts=False), replace(KNOWN, opaque=0.0), replace(KNOWN, expected=90),
    replace(KNOWN, room=10**6)])
def test_other_frames_store_all(known):
    assert not plan(known, {}).in_front


def test_primitives_that_fill_the_rectangle_and_deep_frames_that_are_cut_store_all():
    assert plan(replace(KNOWN, filled=True), {"flat": "stored"}) == Plan(PLANES, replace(KNOWN, filled=True), 5000)
    assert not plan(KNOWN, {"max_error": 0.1}).in_front


@pytest.mark.parametrize(("opaque", "mean", "share"), [
    (1.0, 10, 0.9), (0.5, 2, 0.25), (0.25, 3, 1 - (1 + 0.75 + 0.75**2) / 3), (0.0, 10, 0.0), (0.5, 0, 0.0)])
def test_the_share_that_is_hidden_is_that_behind_the_first_opaque_fragment(opaque, mean, share):
    known = replace(KNOWN, opaque=opaque, expected=mean * KNOWN.area)
    assert hidden_share(known) == pytest.approx(share)


def test_memory_is_bounded_by_all_fragments_that_are_to_be_expected():
    """Pixels of 12 layers take 16 cells side by side; what is in front alone, 40 fragments, leaves them no room."""
    known, params = replace(KNOWN, fragments=40), {"spare_memory": 8.0}
    assert plan(known, params).path == DENSE and plan(known, params).guessed
    assert plan(replace(known, draws_in_parts=False), params).path == RANGES


@pytest.mark.parametrize("triangles", [False, True], ids=["strips", "triangles"])
def test_the_fragments_to_expect_are_about_those_that_there_are(device, triangles):
    scene = in_triangles(generate(DEEP)) if triangles else generate(DEEP)
    with shown(device, scene) as (frame, _):
        assert scene.expected == pytest.approx(frame.stats.F, rel=0.05)
        assert frame.stats.in_front is None


CASES = [("guessed", DEEP, {}, DENSE), ("few", FEW, {}, KEPT), ("few in memory", FEW, {"shallow": "memory"}, DENSE),
         ("ranges", DEEP, {"spare_memory": 0.0}, RANGES), ("wide", DEEP, {"payload": "rgba16f"}, DENSE)]


@pytest.mark.parametrize("triangles", [False, True], ids=["strips", "triangles"])
@pytest.mark.parametrize(("config", "params", "path"), [case[1:] for case in CASES], ids=[case[0] for case in CASES])
def test_each_plan_leaves_out_what_is_hidden_and_shows_all_else(device, config, params, path, triangles):
    scene = partly(config, share=0.5 if config is DEEP else 0.8)
    scene = in_triangles(scene) if triangles else scene
    path = DENSE if FRAMEBUFFER_FETCH not in device.features and path == KEPT else path
    with shown(device, scene, **params) as (frame, buffer):
        for _ in range(3):
            frame.draw_fitting()
            assert frame.plan.in_front
            assert error(frame, buffer, scene) <= EXACT_ERROR
        fragments, deepest = frame.stats.in_front
        assert fragments < (1 - ENOUGH) * frame.stats.F and deepest < frame.stats.n
        assert frame.geometry_passes == (2 if path == RANGES else 1)
        assert frame.plan.path == path
        assert frame.memory_bytes == frame.fitted.memory_bytes()
        assert frame.probe()["stored_fragments"] == frame.stats.F and frame.lost_fragments() == 0


def test_fewer_fragments_are_stored(device):
    scene = partly(DEEP)
    with shown(device, scene) as (frame, _):
        frame.draw_fitting()
        frame.draw()
        counts = frame.words("counter")
        assert counts[:frame.stats.area].sum() == frame.stats.in_front[0] < frame.stats.F / 2


def stacked(*layers: tuple[float, int]) -> Triangles:
    """Triangles over the whole viewport, each of a depth and an alpha, in order of submission."""
    corner = np.float32([[-1, -1], [3, -1], [-1, 3]])
    position = np.float32([np.column_stack([corner, np.full(3, depth), np.ones(3)]) for depth, _ in layers])
    rgba = np.random.default_rng(2).integers(30, 226, (len(layers), 4)).astype(np.uint8)
    rgba[:, 3] = [alpha for _, alpha in layers]
    return Triangles((8, 6), position, rgba, 1.0, 0, np.zeros(len(layers), np.int32))


def test_certain_cells_hold_what_is_in_front(device):
    """A pixel has as many layers as there are primitives: nothing is hidden of what comes first."""
    scene = stacked((0.9, 255), (0.5, 90), (0.8, 255), (0.1, 120))
    with shown(device, scene, shallow="memory") as (frame, buffer):
        for _ in range(2):
            frame.draw_fitting()
            assert error(frame, buffer, scene) <= EXACT_ERROR
        assert frame.plan.in_front and frame.plan.path == DENSE and not frame.plan.guessed


@pytest.mark.parametrize("opaque", [0.4, 0.5, 0.6])
def test_a_fragment_at_the_depth_of_an_opaque_one_is_no_less_in_front(device, opaque):
    """Both are stored, in whichever order: which of the two is seen first is open, as with every method."""
    scene = stacked((opaque, 255), (0.5, 90), (0.7, 255), (0.9, 255), (0.95, 60))
    with shown(device, scene) as (frame, _):
        frame.draw_fitting()
        assert frame.plan.in_front and frame.stats.in_front == (48 * (1 + (opaque >= 0.5)), 1 + (opaque >= 0.5))


def test_an_animation_may_become_partly_opaque_and_clear_again(device):
    clear = generate(DEEP)
    scenes = [clear, partly(DEEP), partly(replace(DEEP, seed=8), 0.4), partly(DEEP, 1.0), clear]
    with shown(device, clear) as (frame, buffer):
        seen = []
        for scene in scenes:
            show(frame, buffer, scene)
            frame.draw_fitting()
            assert error(frame, buffer, scene) <= EXACT_ERROR and frame.lost_fragments() == 0
            seen.append(frame.plan.path if frame.plan.path == NEAREST else frame.plan.in_front)
    assert seen == [False, True, True, NEAREST, False]


@pytest.mark.parametrize(("first", "second"), [(True, True), (False, False), (False, True)])
def test_a_part_that_is_not_drawn_or_comes_too_late_is_seen(device, monkeypatch, first, second):
    """Both parts have to be drawn, and the opaque one before the depth is kept as it is."""
    def wrong(runner):
        runner.frame.scene_buffer.draw_part(runner.vao, opaque=first)
        runner.gl.glDepthMask(False)
        runner.frame.scene_buffer.draw_part(runner.vao, opaque=second)

    scene = partly(DEEP)
    right = scene_stats(scene, np.zeros(1, np.int64))
    with shown(device, scene) as (frame, buffer):
        frame.draw_fitting()
        monkeypatch.setattr(PassRunner, "_draw_geometry", wrong)
        frame.draw()
        monkeypatch.undo()
        stored = int(frame.words("counter")[:right.area].sum())
        assert error(frame, buffer, scene) > EXACT_ERROR or stored != frame.stats.in_front[0]


def test_a_device_says_how_many_fragments_are_in_front(device):
    """Two opaque triangles lie over each other, a faint one behind both, submitted in order of depth or against it."""
    for depths, stored in (((0.5, 0.2, 0.8), 2), ((0.2, 0.5, 0.8), 1)):
        scene = stacked(*zip(depths, (OPAQUE, OPAQUE, 99), strict=True))
        buffer, canvas = SceneBuffer(device, scene), Canvas(device, scene.viewport)
        try:
            stats = true_stats(device, buffer, canvas)
            assert (stats.F, stats.n) == (3 * 48, 3)
            assert stats.in_front == (stored * 48, stored)
        finally:
            for thing in (canvas, buffer):
                thing.release()
