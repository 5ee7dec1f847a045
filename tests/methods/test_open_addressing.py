"""Open addressing: load factors, growth, ages, the grid of its depths; ranges of PreCalc_Fixed and of the DFB."""

from dataclasses import replace

import moderngl
import numpy as np
import pytest

from mfr_bench.config import Measure
from mfr_bench.config import Scene as SceneConfig
from mfr_bench.gpu.frame import Frame
from mfr_bench.gpu.scene_buffer import SceneBuffer
from mfr_bench.gpu.targets import Canvas
from mfr_bench.methods import catalog
from mfr_bench.methods.spec import Fitted, Grown, Variant
from mfr_bench.oracle.composite import composite, fragment_counts, stats_of
from mfr_bench.plan import Cell, expected_stats, judge
from mfr_bench.scene import generate

from .drawing import assert_shows, drawn, stack

METHODS = pytest.mark.parametrize("method", ["open-post", "open-pre"])
ATOMIC64 = pytest.mark.parametrize("atomic64", ["native", "emulated"])
SCENE = generate(SceneConfig(size=(33, 21), depth_complexity=24, seed=3))


def assert_exact(frame, scene):
    assert frame.lost_fragments() == 0
    assert np.abs(frame.image() - composite(scene)).max() < 1e-4


@METHODS
@ATOMIC64
@pytest.mark.parametrize("load_factor", [0.02, 0.4, 0.625, 0.8, 0.95])
def test_exact_at_every_load(device, method, atomic64, load_factor):
    with drawn(device, method, SCENE, frames=2, load_factor=load_factor, atomic64=atomic64) as frame:
        assert_exact(frame, SCENE)
        assert frame.words("cell_counter")[0] == stats_of(SCENE).F
        assert frame.memory_bytes == Fitted(frame.variant, stats_of(SCENE)).memory_bytes()


@METHODS
def test_exact_at_128_layers(device, method):
    scene = generate(SceneConfig(size=(31, 13), depth_complexity=128, pixel_density=0.6))
    with drawn(device, method, scene, atomic64="emulated") as frame:
        assert_exact(frame, scene)


@METHODS
def test_interrupts_a_crowded_table_and_doubles_it(device, method):
    """Starts with a cell per pixel: 24 times too few. Above 10/16 of the cells the build is given up."""
    declared = catalog()[method]
    small = replace(declared, capacity=Grown(start="P", counter="cell_counter"))
    variant = Variant(small, small.complete({"atomic64": "emulated"}))
    stats = stats_of(SCENE)
    quads, canvas = SceneBuffer(device, SCENE), Canvas(device, (stats.W, stats.H))
    frame = Frame(device, Fitted(variant, stats), quads, canvas)
    frame.draw()
    assert frame.geometry_passes > 1
    assert_exact(frame, SCENE)
    cells = frame.memory_bytes["cells"] // 4
    assert cells in (stats.P * 2**i for i in range(12))
    assert stats.F <= 10 / 16 * cells < 2 * stats.F
    for thing in (frame, canvas, quads):
        thing.release()


@METHODS
def test_equal_fragments_are_all_kept(device, method):
    """Equal in every bit, as their cells then are at equal ages."""
    colours = [(200, 10, 30, 120)] * 5
    with drawn(device, method, stack([0.25] * 5, colours), atomic64="emulated") as frame:
        assert_shows(frame, colours)


def test_equal_depths_come_by_payload(device):
    colours = [(200, 10, 30, 120), (10, 200, 30, 90), (90, 90, 250, 60)]
    with drawn(device, "open-pre", stack([0.5] * 3, colours), atomic64="emulated") as frame:
        assert_shows(frame, sorted(colours, key=lambda c: c[::-1], reverse=True))


@METHODS
def test_adjacent_depths_of_the_grid_keep_their_order(device, method):
    depths = [0.0, 2**-23, 0.5, 0.5 + 2**-23, 1 - 2**-23]
    scene = stack(depths[::-1])
    with drawn(device, method, scene, atomic64="emulated") as frame:
        assert_exact(frame, scene)


@METHODS
@pytest.mark.parametrize("depth", [2**-25, 0.25 + 2**-25, 1 - 2**-24])
def test_a_depth_off_the_grid_counts_as_lost(device, method, depth):
    scene = stack([depth])
    with drawn(device, method, scene, atomic64="emulated") as frame:
        assert frame.lost_fragments() == scene.viewport[0] * scene.viewport[1]


@METHODS
def test_what_a_frame_loses_does_not_add_up_over_frames(device, method):
    scene = stack([2**-25])
    with drawn(device, method, scene, atomic64="emulated") as frame:
        frame.lost_fragments()
        for _ in range(3):
            frame.draw()
        assert frame.lost_in_a_frame() == scene.viewport[0] * scene.viewport[1]
        assert frame.lost_in_a_frame() == 0


@METHODS
def test_both_ends_of_the_depth_range_are_on_the_grid(device, method):
    colours = [(200, 10, 30, 120), (10, 200, 30, 90), (90, 90, 250, 60)]
    with drawn(device, method, stack([1.0, 0.0, 1 - 2**-23], colours), atomic64="emulated") as frame:
        assert_shows(frame, [colours[1], colours[2], colours[0]])


@METHODS
def test_ages_count_from_one_to_the_oldest(device, method):
    """Every fragment has a cell of its own, at an age that the table A covers; 255 at most."""
    with drawn(device, method, SCENE, atomic64="emulated", load_factor=0.6) as frame:
        ages, cells = frame.words("ages"), frame.words("cells")
        records = frame.words("records").reshape(-1, 2)
    named = cells[cells > 0] - 1
    assert len(np.unique(named)) == len(named) == stats_of(SCENE).F
    at = np.flatnonzero(cells)
    age = records[cells[at] - 1, 1] >> 24
    assert age.min() == 1
    assert age.max() == ages.max() <= 255
    assert (ages.reshape(SCENE.viewport[::-1]) >= fragment_counts(SCENE)).all()


def test_offsets_are_drawn_from_the_seed(device):
    offsets = []
    for seed in (1, 1, 2):
        scene = generate(SceneConfig(size=(16, 16), depth_complexity=2, seed=seed))
        with drawn(device, "open-pre", scene, atomic64="emulated") as frame:
            offsets.append(tuple(frame.words("offsets")))
    assert offsets[0] == offsets[1] != offsets[2]
    assert len(set(offsets[0])) > 128


def test_offsets_do_not_depend_on_what_the_memory_held_before(device, monkeypatch):
    """Each frame draws them from those before, the first from zeros. New memory may hold anything, as on zink."""
    real, offsets = moderngl.Context.buffer, []
    for dirt in (b"\0", b"\xa5"):
        monkeypatch.setattr(moderngl.Context, "buffer", lambda ctx, data=None, *, reserve=0, dirt=dirt, **more:
                            real(ctx, data or dirt * reserve, **more))
        with drawn(device, "open-pre", SCENE, atomic64="emulated") as frame:
            offsets.append(tuple(frame.words("offsets")))
    assert offsets[0] == offsets[1]


@METHODS
def test_too_deep_a_pixel_is_refused_before_it_is_drawn(method):
    cell = Cell("test", method, method, catalog()[method].complete({}), SceneConfig(size=(8, 8), depth_complexity=300),
                Measure(), {})
    status, reason = judge(cell, catalog(), expected_stats(cell.scene), None)
    assert status == "over_budget"
    assert "300 fragments" in reason


@pytest.mark.parametrize("size", [(1, 1), (4, 4), (16, 1), (17, 1), (16, 16), (257, 1), (97, 71)])
@pytest.mark.parametrize("method", ["ab-dfb", "ab-precalc"])
def test_ranges_follow_from_the_counters(device, method, size):
    scene = generate(SceneConfig(size=size, depth_complexity=3, fragment_probability=0.5, seed=7))
    with drawn(device, method, scene, frames=2) as frame:
        counter, address = frame.words("counter"), frame.words("address")
        assert_exact(frame, scene)
    np.testing.assert_array_equal(address, np.cumsum(counter))  # the store has moved each to its end


def test_fixed_ranges_need_one_geometry_pass_and_no_sum(device):
    with drawn(device, "ab-precalc-fixed", SCENE) as frame:
        assert frame.geometry_passes == 1
        stats = stats_of(SCENE)
        np.testing.assert_array_equal(frame.words("address"), stats.n * np.arange(stats.P))
        assert sum(frame.memory_bytes.values()) == Fitted(frame.variant, stats).model_bytes()
        assert_exact(frame, SCENE)
