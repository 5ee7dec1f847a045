"""Methods cut short: peelings of so many layers, compositing that ends at an opacity. The promise weakens with it."""

import numpy as np
import pytest

from mfr_bench.config import Scene as SceneConfig
from mfr_bench.methods import catalog
from mfr_bench.oracle.composite import composite, stats_of
from mfr_bench.scene import generate
from mfr_bench.store.status import EXACT_ERROR

from .drawing import drawn, stack

DEEP = generate(SceneConfig(size=(19, 11), depth_complexity=40, alpha=(0.05, 0.5), fragment_probability=0.8, seed=3))
CUT = [("peel-f2b", {}, 8), ("peel-f2b", {}, 1), ("peel-f2b", {}, 500), ("peel-kplus", {"k": 8}, 16),
       ("peel-kplus", {"k": 8}, 17), ("peel-kplus", {"k": 8}, 1)]
STOPPING = [("peel-f2b", {}), *(("ab-array", {"sort": sort}) for sort in ("hybrid", "lplus", "register")),
            ("ab-ll", {"resolve": "compute"}), ("lin-pre", {}), ("kb-ps", {"k": 32}), ("kb-mdt32", {"k": 32}),
            ("kplus-heap", {"k": 32, "bma": "on", "sort": "hybrid"}), ("ab-ll-bucket", {}), ("kb-ll", {"k": 32})]


@pytest.mark.parametrize(("method", "params", "layers"), CUT)
def test_a_peeling_cut_short_gives_its_nearest_layers_exactly(device, method, params, layers):
    with drawn(device, method, DEEP, layers=layers, **params) as frame:
        k = params.get("k", 1)
        assert frame.variant.layers == -(-layers // k) * k
        assert frame.variant.guarantee == "exact k nearest"
        assert frame.geometry_passes <= -(-layers // k)
        np.testing.assert_allclose(frame.image(), composite(DEEP, frame.variant.layers), rtol=0, atol=EXACT_ERROR)


@pytest.mark.parametrize("layers", [1, 2, 9, 16])
def test_dual_peeling_cut_short_lacks_the_middle(device, layers):
    """From each side so many layers as passes; what lies between is not there."""
    passes = -(-layers // 2)
    with drawn(device, "peel-dual", DEEP, layers=layers) as frame:
        assert frame.geometry_passes == 1 + passes
        assert frame.variant.guarantee == "approximate"
        nearest, furthest = composite(DEEP, passes), composite(DEEP, passes, "furthest")
        both = nearest + (1 - nearest[..., 3:]) * furthest
        deeper = stats_of(DEEP).n > 2 * passes
        assert deeper
        full = np.abs(frame.image() - composite(DEEP)).max()
        assert full > EXACT_ERROR
        counts = np.array([np.abs(frame.image() - both)[y, x].max() for y, x in deep_pixels(2 * passes)])
        assert counts.max() <= EXACT_ERROR


def deep_pixels(layers):
    from mfr_bench.oracle.composite import fragment_counts

    return np.argwhere(fragment_counts(DEEP) >= layers)


def test_layers_that_are_not_reached_change_nothing(device):
    for method in ("peel-f2b", "peel-dual", "peel-kplus"):
        with drawn(device, method, DEEP, layers=4096) as frame:
            np.testing.assert_allclose(frame.image(), composite(DEEP), rtol=0, atol=EXACT_ERROR)


@pytest.mark.parametrize("stop", [0.5, 0.9])
@pytest.mark.parametrize(("method", "params"), STOPPING)
def test_what_lies_behind_the_opacity_is_all_that_is_missing(device, method, params, stop):
    with drawn(device, method, DEEP, stop_opacity=stop, **params) as frame:
        error = np.abs(frame.image() - composite(DEEP, params.get("k"))).max()
        assert frame.variant.guarantee == "approximate"
        assert frame.lost_fragments() == 0
        assert EXACT_ERROR < error <= 1 - stop
        assert frame.image()[..., 3].min() >= min(stop, composite(DEEP)[..., 3].min()) - 1e-6


@pytest.mark.parametrize(("method", "params"), STOPPING)
def test_one_is_never_reached(method, params):
    variant = catalog()[method].variant({**params, "stop_opacity": 1.0})
    assert variant == catalog()[method].variant(params)
    assert not variant.weaknesses


def test_peeling_ends_when_every_pixel_is_opaque_enough(device):
    with drawn(device, "peel-f2b", DEEP) as all_layers, drawn(device, "peel-f2b", DEEP, stop_opacity=0.5) as stopped:
        assert stopped.geometry_passes < all_layers.geometry_passes


@pytest.mark.parametrize("opacity", [0.5, 0.8])
def test_early_culling_errs_by_what_its_opacity_leaves(device, opacity):
    scene = generate(SceneConfig(size=(33, 21), depth_complexity=40, alpha=(0.2, 0.5), order="front_to_back"))
    with drawn(device, "lin-pre", scene, early_culling="on", culling_opacity=opacity) as frame:
        assert 0.02 < np.abs(frame.image() - composite(scene)).max() <= 1 - opacity


@pytest.mark.parametrize("value", [0, 0.0, 1.5, -0.1, float("nan"), True, "on"])
def test_an_opacity_is_above_0_and_at_most_1(value):
    with pytest.raises(ValueError, match="allowed: a number above 0, up to 1"):
        catalog()["peel-f2b"].param("stop_opacity").parse(value)


def test_a_fragment_at_the_far_plane_counts_as_a_layer(device):
    with drawn(device, "peel-f2b", stack([0.5, 1.0])) as frame:
        assert frame.probe()["stored_fragments"] == frame.stats.F
