"""Opaque primitives: a depth test leaves the nearest fragment of each pixel, and nothing is stored."""

from dataclasses import replace

import numpy as np
import pytest

from mfr_bench.config.model import Scene as SceneConfig
from mfr_bench.methods import catalog
from mfr_bench.methods.adaptive import DIRECT, NEAREST, RANGES, plan
from mfr_bench.methods.spec import Fitted, Known, Plan
from mfr_bench.oracle.composite import composite, stats_of
from mfr_bench.scene import generate
from mfr_bench.scene.primitives import OPAQUE
from mfr_bench.store.status import EXACT_ERROR

from ..contract.cases import SLANTED, Drawn, stage, stats_in
from .drawing import drawn, stack
from .test_adaptive_guess import animated, error, show

KNOWN = Known(60, 50, 100, None, opaque=1.0)
SCATTERED = SceneConfig(size=(40, 30), depth_complexity=4, layout="random", quad_size=(11, 7), alpha=(1, 1), seed=2)
SHUFFLED = np.random.default_rng(3).permutation(np.linspace(0.05, 0.95, 20))


def pile(alpha: int, *others: int, depths=SHUFFLED):
    """Quads of one alpha in random order, the last of them of others."""
    rgba = np.random.default_rng(len(depths)).integers(30, 226, (len(depths), 4))
    rgba[:, 3] = alpha
    rgba[len(depths) - len(others):, 3] = others
    return stack(depths, rgba)


def test_the_plan_of_opaque_primitives():
    assert plan(KNOWN, {}) == Plan(NEAREST, KNOWN, 0)
    assert plan(replace(KNOWN, filled=True), {}).path == NEAREST
    assert plan(replace(KNOWN, layers=1), {}).path == DIRECT
    assert plan(replace(KNOWN, opaque=0.0), {}).path == plan(KNOWN, {"opaque": "stored"}).path == RANGES


def test_a_budget_has_no_room_for_another_depth():
    assert plan(replace(KNOWN, room=10**6), {}).path != NEAREST


@pytest.mark.parametrize(("others", "hides"), [((), True), ((OPAQUE - 1,), False), ((0,), False)])
def test_a_scene_is_opaque_where_every_primitive_is(others, hides):
    stats = stats_of(pile(OPAQUE, *others))
    assert (Known.of(stats, None, None).opaque == 1) == hides
    assert not Known.of(replace(stats, geometry="reversed"), None, None).opaque, "a depth test would find the furthest"


@pytest.mark.parametrize("payload", ["rgba8", "rgba16f"])
@pytest.mark.parametrize("others", [(), (254,), (0,), (30,) * 10])
def test_the_nearest_is_seen_with_every_payload_and_what_lets_light_through_is_blended(device, others, payload):
    scene = pile(OPAQUE, *others)
    with drawn(device, "adaptive", scene, frames=2, payload=payload) as frame:
        assert (frame.plan.path == NEAREST) == (not others)
        assert np.abs(frame.image() - composite(scene)).max() <= EXACT_ERROR
        assert frame.probe()["stored_fragments"] == frame.stats.F and frame.lost_fragments() == 0
        assert frame.memory_bytes == frame.fitted.memory_bytes()


def test_of_opaque_fragments_at_one_depth_one_is_seen(device):
    scene = pile(OPAQUE, depths=np.full(5, 0.5))
    with drawn(device, "adaptive", scene) as frame:
        seen = np.rint(frame.image()[0, 0] * 255).astype(int).tolist()
        assert frame.plan.path == NEAREST and seen in scene.rgba.tolist()


@pytest.mark.parametrize("depths", [(1.0, 1.0), (0.0, 1.0), (1.0, 0.0)])
def test_the_ends_of_the_depth_range_are_seen(device, depths):
    scene = pile(OPAQUE, depths=np.array(depths))
    with drawn(device, "adaptive", scene) as frame:
        seen = np.rint(frame.image()[0, 0] * 255).astype(int).tolist()
        assert frame.plan.path == NEAREST and seen in scene.rgba[np.equal(depths, min(depths))].tolist()


@pytest.mark.parametrize("config", [
    SCATTERED, replace(SCATTERED, fragment_probability=0.4),
    *(replace(SLANTED[name], alpha=(1, 1)) for name in sorted(SLANTED))])
def test_scattered_rejected_and_slanted_fragments_are_right(device, config):
    variant = catalog()["adaptive"].variant({})
    assert Fitted(variant, stats_in(device, config)).plan().path == NEAREST
    shown = Drawn(device, variant, config, frames=2, probing=True)
    assert shown.error <= EXACT_ERROR and shown.lost == 0 and shown.passes == 1
    assert shown.allocated == shown.declared
    assert shown.probed["stored_fragments"] == stage(device, config).stats.F


def test_an_animation_may_become_opaque_and_clear_again(device):
    clear = replace(SCATTERED, alpha=(0.2, 0.6))
    scenes = [generate(config) for config in (clear, SCATTERED, replace(SCATTERED, seed=8), clear)]
    with animated(device, scenes) as (frame, quads):
        frame.draw_fitting()
        paths = [frame.plan.path]
        for scene in scenes[1:]:
            show(frame, quads, scene)
            frame.draw()
            paths.append(frame.plan.path)
            assert error(frame, quads, scene) <= EXACT_ERROR and frame.lost_fragments() == 0
    assert [path == NEAREST for path in paths] == [False, True, True, False]
