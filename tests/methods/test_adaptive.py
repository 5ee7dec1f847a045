"""The adaptive method: which plan a frame gets, that none loses a fragment, and what stopping early costs."""

import numpy as np
import pytest

from mfr_bench.config.model import Scene as SceneConfig
from mfr_bench.gpu.frame import Canvas, Frame, SceneBuffer
from mfr_bench.methods import catalog
from mfr_bench.methods.adaptive import CUT, DENSE, DIRECT, RANGES, plan
from mfr_bench.methods.spec import Known
from mfr_bench.oracle import composite, sizes_of
from mfr_bench.scene import generate

from .drawing import assert_shows, chosen, drawn, over, stack

FEW = SceneConfig(size=(64, 64), depth_complexity=6, seed=3)


@pytest.mark.parametrize(("layers", "area", "fragments", "path"), [
    (0, 0, None, DIRECT), (1, 100, None, DIRECT), (1, 100, 30, DIRECT),
    (4, 100, None, RANGES), (4, 100, 400, DENSE), (4, 50, 200, DENSE), (4, 100, 300, RANGES),
    (4, 100, 377, DENSE), (4, 100, 375, RANGES),  # a twentieth of 2f + 2 words beside
])
def test_the_plan(layers, area, fragments, path):
    assert plan(Known(layers, area, 100, fragments), {}).path == path


@pytest.mark.parametrize("config", [
    FEW, SceneConfig(size=(64, 64), depth_complexity=40, pixel_density=0.05, seed=3),
    SceneConfig(size=(64, 64), depth_complexity=6, layout="tiles", pixel_density=0.3, seed=3),
    SceneConfig(size=(64, 64), depth_complexity=6, fragment_probability=0.97, seed=3),
    SceneConfig(size=(64, 64), depth_complexity=1, pixel_density=0.3, seed=3),
])
def test_memory_is_that_of_the_s_buffer_and_a_twentieth(config):
    sizes = sizes_of(generate(config))
    memory = sum(catalog()["adaptive"].variant({}).memory_bytes(sizes).values())
    assert memory <= 1.05 * 4 * (2 * sizes.F + 2 * sizes.P) + 64


def test_a_scene_that_thins_out_is_right_in_its_first_frame_and_has_ranges_in_the_next(device):
    """The plan of a frame is made from what the frame before had: it may waste memory once, never a fragment."""
    full = generate(FEW)
    thin = chosen(full, list(range(6)))
    thin.rect[1:, 2] = thin.rect[1:, 0] + 1
    quads, canvas = SceneBuffer(device, full), Canvas(device, (64, 64))
    frame = Frame(device, catalog()["adaptive"].variant({}), sizes_of(full), quads, canvas)
    try:
        frame.draw_fitting()
        assert frame._plan.path == DENSE
        quads.replace(thin)
        frame.show(thin)
        for path in (DENSE, RANGES):
            frame.draw()
            assert frame._plan.path == path
            np.testing.assert_allclose(frame.image(), composite(thin), rtol=0, atol=1e-4)
        quads.replace(full)
        frame.show(full)
        for path in (RANGES, DENSE):
            frame.draw()
            assert frame._plan.path == path
            np.testing.assert_allclose(frame.image(), composite(full), rtol=0, atol=1e-4)
        assert frame.lost_fragments() == 0
    finally:
        for thing in (frame, canvas, quads):
            thing.release()


@pytest.mark.parametrize("count", [2, 3, 5, 9, 17, 33, 64, 65, 100])
def test_faint_stacks_of_every_network_and_of_several_sweeps(device, count):
    """So little is hidden that all fragments count, whatever block and sweep they come in."""
    order = np.random.default_rng(count).permutation(count)
    rgba = np.random.default_rng(1).integers(1, 12, (count, 4))
    with drawn(device, "adaptive", stack((order + 1) / (count + 2), rgba)) as frame:
        assert_shows(frame, rgba[np.argsort(order)])


@pytest.mark.parametrize("equal", [2, 31, 32, 33, 70])
def test_equal_depths_at_the_end_of_a_sweep_are_all_kept(device, equal):
    """20 nearer, `equal` at one depth and 20 further: those of one depth are alike, so that their order is none."""
    count = 40 + equal
    depths = np.concatenate([np.linspace(0.1, 0.3, 20), np.full(equal, 0.5), np.linspace(0.6, 0.9, 20)])
    rgba = np.random.default_rng(2).integers(1, 9, (count, 4))
    rgba[20:20 + equal] = (200, 100, 50, 6)
    order = np.random.default_rng(3).permutation(count)
    with drawn(device, "adaptive", stack(depths[order], rgba[order])) as frame:
        assert_shows(frame, rgba)


@pytest.mark.parametrize("max_error", [1 / 512, 0.05])
def test_what_is_left_out_is_within_the_bound_and_is_said(device, max_error):
    rgba = np.random.default_rng(4).integers(20, 40, (90, 4))
    with drawn(device, "adaptive", stack(np.linspace(0.1, 0.9, 90), rgba), max_error=max_error) as frame:
        error = np.abs(frame.image() - over(rgba)).max()
        assert frame.variant.guarantee == "approximate"
    assert 1e-6 < error <= max_error + 1e-6


@pytest.mark.parametrize("config", [
    SceneConfig(size=(64, 48), depth_complexity=40, alpha=(0.5, 0.5), seed=5),
    SceneConfig(size=(64, 48), depth_complexity=40, fragment_probability=0.6, layout="tiles", pixel_density=0.5),
    SceneConfig(size=(64, 48), depth_complexity=30, alpha=(0.01, 1.0), layout="random", seed=6),
    SceneConfig(size=(64, 48), depth_complexity=40, alpha=(1.0, 1.0), seed=7),
    SceneConfig(size=(64, 48), depth_complexity=40, alpha=(0.004, 0.01), seed=8)])
@pytest.mark.parametrize("max_error", [1 / 512, 0.05])
def test_what_the_cut_discards_is_within_the_bound(device, config, max_error):
    scene = generate(config)
    with drawn(device, "adaptive", scene, max_error=max_error) as frame:
        assert frame._plan.path == CUT and frame.lost_fragments() == 0
        assert np.abs(frame.image() - composite(scene)).max() <= max_error + 1e-5
        held = frame.probe()["held_fragments"]
    faint = config.alpha[1] < 0.1
    assert (held == sizes_of(scene).F) == faint


def test_the_default_error_is_a_third_of_what_exact_images_may_differ_by():
    variant = catalog()["adaptive"].variant({})
    assert variant.guarantee == "exact all"
    assert variant.error_bound(sizes_of(generate(FEW))) < 1e-4 / 2
