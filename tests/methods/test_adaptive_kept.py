"""Shallow pixels sorted in the framebuffer: what they need, that they lose nothing, and that a guess is checked."""

from dataclasses import replace

import numpy as np
import pytest

from mfr_bench.config.model import Scene as SceneConfig
from mfr_bench.methods import catalog
from mfr_bench.methods.adaptive import DENSE, RANGES, SPARE_MEMORY, plan
from mfr_bench.methods.shared.in_framebuffer import KEPT, WIDE
from mfr_bench.methods.spec import FRAMEBUFFER_FETCH, Fitted, Known, Plan
from mfr_bench.oracle.composite import composite, stats_of
from mfr_bench.store.status import EXACT_ERROR

from ..contract.cases import SLANTED, Drawn, stage, stats_in
from .drawing import drawn, stack
from .test_adaptive_guess import animated, error, pile, show

KNOWN = Known(50, 100, 100, 400, deepest=6, fetches=True)
SCATTERED = SceneConfig(size=(40, 30), depth_complexity=1, layout="random", quad_size=(11, 7), seed=2)
CERTAIN = replace(KNOWN, layers=3, fragments=None, deepest=None)


@pytest.fixture(autouse=True)
def fetches(device):
    if FRAMEBUFFER_FETCH not in device.features:
        pytest.skip(f"this device lacks {FRAMEBUFFER_FETCH}")


def test_few_layers_are_kept_for_certain_by_the_geometry_or_as_a_guess_by_the_frame_before():
    assert plan(CERTAIN, {}) == Plan(KEPT, replace(CERTAIN, layers=4), 0)
    assert plan(KNOWN, {}) == Plan(KEPT, replace(KNOWN, layers=6), 0, guessed=True)
    assert [plan(replace(KNOWN, deepest=n), {}).known.layers for n in (1, 3, 5, 7, 8)] == [2, 4, 6, 7, 8]


@pytest.mark.parametrize(("known", "params"), [
    (replace(KNOWN, fetches=False), {}), (replace(KNOWN, deepest=9), {}), (replace(KNOWN, deepest=None), {}),
    (replace(KNOWN, room=10**6), {}), (replace(KNOWN, area=int(100 * WIDE)), {}), (KNOWN, {"shallow": "memory"}),
    (KNOWN, {"payload": "rgba16f"}), (KNOWN, {SPARE_MEMORY.name: 0.39})])
def test_other_frames_are_stored_in_memory(known, params):
    """600 places, of which 200 are in excess of the 400 of ranges; 0.4 of 500 with the two words for each pixel."""
    assert plan(known, params).path in (DENSE, RANGES)


def test_targets_as_large_as_a_guess_of_cells_are_within_its_memory():
    assert plan(KNOWN, {SPARE_MEMORY.name: 0.4}).path == KEPT


def crowd(count: int):
    """Quads in random order over the left or the right columns, `count` of them in each pixel.

    By their bounds a pixel could have twice as many, so that more than four are a guess.
    """
    scene = stack(np.random.default_rng(count).permutation(np.linspace(0.1, 0.9, 2 * count)))
    scene.rect[::2, 2], scene.rect[1::2, 0] = 3, 3
    return scene


def alike(count: int):
    """The same at one depth."""
    scene = crowd(count)
    scene.depth[:] = 0.5
    return scene


@pytest.mark.parametrize("payload", ["rgba8", "two_channel"])
@pytest.mark.parametrize("count", range(2, 9))
def test_every_fragment_is_kept_in_order(device, count, payload):
    """Up to seven beside the image, eight before it; from the first frame on, or after one that counts."""
    scene = crowd(count)
    with drawn(device, "adaptive", scene, frames=2, payload=payload) as frame:
        assert frame.plan.path == KEPT and frame.plan.guessed == (count > 4)
        assert frame.probe()["stored_fragments"] == stats_of(scene).F and frame.lost_fragments() == 0
        assert frame.memory_bytes == frame.fitted.memory_bytes()
        image = frame.image()
    with drawn(device, "adaptive", scene, frames=2, payload=payload, shallow="memory") as stored:
        np.testing.assert_allclose(image, stored.image(), rtol=0, atol=EXACT_ERROR)
    assert payload != "rgba8" or np.abs(image - composite(scene)).max() <= EXACT_ERROR


@pytest.mark.parametrize("count", [4, 8])
def test_fragments_of_one_depth_are_all_kept(device, count):
    with drawn(device, "adaptive", alike(count), frames=2) as frame:
        assert frame.plan.path == KEPT
        assert frame.probe()["stored_fragments"] == frame.stats.F


@pytest.mark.parametrize("config", [
    replace(SCATTERED, depth_complexity=7, fragment_probability=0.6), replace(SCATTERED, depth_complexity=2)])
def test_scenes_that_reject_fragments_or_lie_at_random_are_right(device, config):
    drawn = Drawn(device, catalog()["adaptive"].variant({}), config, frames=3, probing=True)
    assert drawn.error <= EXACT_ERROR and drawn.lost == 0
    assert drawn.allocated == drawn.declared
    assert drawn.probed["stored_fragments"] == stage(device, config).stats.F


@pytest.mark.parametrize("name", SLANTED)
def test_slanted_primitives_are_kept_where_they_are_few(device, name):
    few = replace(SLANTED[name], depth_complexity=4)
    drawn = Drawn(device, catalog()["adaptive"].variant({}), few, frames=3)
    assert Fitted(catalog()["adaptive"].variant({}), stats_in(device, few), device.features).plan().path == KEPT
    assert drawn.error <= EXACT_ERROR and drawn.lost == 0
    assert drawn.allocated == drawn.declared


@pytest.mark.parametrize(("shader", "right", "wrong"), [
    ("keep.frag", "fragment.x < held.x", "fragment.x > held.x"),
    ("keep.frag", "before ? held : fragment", "before ? fragment : held"),
    ("kept.frag", "EACH_PLACE(COMPOSITE)", "COMPOSITE(out_kept_0)"),
    ("places.glsl", "DO(out_kept_6)", "DO(out_kept_5)"), ("places.glsl", "DO(EIGHTH_PLACE)", "DO(out_kept_6)")])
def test_a_wrong_line_is_seen(device, plant, shader, right, wrong):
    plant(f"methods/adaptive/{shader}", right, wrong)
    scene = crowd(8)
    with drawn(device, "adaptive", scene, frames=2) as frame:
        assert frame.plan.path == KEPT
        assert np.abs(frame.image() - composite(scene)).max() > EXACT_ERROR


def passes_of(device, *counts: int) -> tuple[list[int], str, list[bool]]:
    """Geometry passes of frames with so many fragments in a pixel, after one with five; last plan; what is right."""
    scenes, passes, right = [pile(count) for count in (5, *counts)], [], []
    with animated(device, scenes, shallow="framebuffer") as (frame, quads):
        frame.draw_fitting()
        assert frame.plan.path == KEPT and frame.plan.guessed
        for scene in scenes[1:]:
            show(frame, quads, scene)
            assert frame.draw()
            passes.append(frame.geometry_passes)
            right.append(error(frame, quads, scene) <= EXACT_ERROR)
        return passes, frame.plan.path, right


def test_a_frame_that_has_too_few_places_is_drawn_again_with_more(device):
    assert passes_of(device, 6, 7, 8, 7) == ([1, 2, 1, 1], KEPT, [True] * 4)


def test_a_frame_too_deep_for_the_framebuffer_is_stored_in_memory(device):
    """It has six places, then eight, then cells."""
    assert passes_of(device, 12, 12) == ([3, 1], DENSE, [True] * 2)


@pytest.mark.parametrize(("shader", "right", "wrong"), [
    ("keep.frag", "LAST_PLACE.x |= OVERFULL", ""), ("kept.frag", "last >= OVERFULL", "last < OVERFULL"),
    ("kept.frag", "uint(LAYERS) + 1u", "0u")])
def test_a_wrong_line_of_what_tells_of_too_few_places_is_seen(device, plant, shader, right, wrong):
    plant(f"methods/adaptive/{shader}", right, wrong)
    assert passes_of(device, 7, 7) != ([2, 1], KEPT, [True] * 2)


def test_a_device_without_framebuffer_fetch_stores_them_in_memory(device, monkeypatch):
    monkeypatch.setattr(type(device), "features", device.features - {FRAMEBUFFER_FETCH})
    with drawn(device, "adaptive", crowd(4), frames=2) as frame:
        assert frame.plan.path in (DENSE, RANGES)
        assert np.abs(frame.image() - composite(crowd(4))).max() <= EXACT_ERROR
