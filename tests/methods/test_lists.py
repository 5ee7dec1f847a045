"""Linked lists: pages, buckets, 64-bit records, equal depths, growth, early culling."""

import numpy as np
import pytest

from mfr_bench.config import Scene as SceneConfig
from mfr_bench.methods import catalog
from mfr_bench.methods.spec import Fitted, SceneStats
from mfr_bench.oracle.composite import composite, stats_of
from mfr_bench.scene import generate

from .drawing import SIZE, assert_shows, drawn, stack

DEEP = generate(SceneConfig(size=(33, 21), depth_complexity=40, fragment_probability=0.7, seed=3))
COLOURS = [(200, 10, 30, 120), (10, 200, 30, 120), (90, 90, 250, 120), (200, 10, 30, 120)]
WIDE = [("lin-post", {"packed": "on", "atomic64": a, "allocation": c})
        for a in ("native", "emulated") for c in ("counter", "paged")]
WIDE += [("lin-pre", {"insert": "max64", "atomic64": a}) for a in ("native", "emulated")]
PAGED = [("ab-ll-paged", {}), ("lin-post", {"allocation": "paged"}),
         ("lin-post", {"allocation": "paged", "packed": "on", "atomic64": "emulated"})]
SORTED = [("lin-pre", {"insert": "cas32"}), ("lin-pre", {"insert": "max64", "atomic64": "emulated"}),
          ("lin-pre", {"insert": "max64", "atomic64": "native"})]


def assert_exact(frame, scene):
    assert frame.lost_fragments() == 0
    assert np.abs(frame.image() - composite(scene)).max() < 1e-4


@pytest.mark.parametrize(("method", "params"), WIDE)
def test_64_bit_records_hold_depth_and_link(device, method, params):
    with drawn(device, method, DEEP, frames=2, **params) as frame:
        assert_exact(frame, DEEP)


@pytest.mark.parametrize(("method", "params"), WIDE)
def test_64_bit_records_keep_equal_depths(device, method, params):
    """Fragments have equal alpha, so that their order shows in the colours alone: every one of them is there."""
    with drawn(device, method, stack([0.5] * 4, COLOURS), **params) as frame:
        alpha = 1 - (1 - 120 / 255) ** 4
        np.testing.assert_allclose(frame.image()[..., 3], alpha, rtol=0, atol=1e-5)


@pytest.mark.parametrize(("method", "params"), PAGED)
@pytest.mark.parametrize("layers", [0, 1, 3, 4, 5, 8, 9])
def test_pages_are_taken_when_the_last_is_full(device, method, params, layers):
    scene = stack(np.linspace(0.75, 0.25, layers))
    with drawn(device, method, scene, **params) as frame:
        assert_exact(frame, scene)
        assert frame.words("cell_counter")[0] == SIZE[0] * SIZE[1] * 4 * -(-layers // 4)


def test_paged_cells_are_whole_pages_of_every_pixel():
    stats = SceneStats(W=3, H=2, n=5, F=11, primitives=5, histogram=(1, 2, 0, 0, 1, 1))
    assert stats.F == 2 * 1 + 4 + 5
    assert stats.paged(4) == 2 * 4 + 4 + 8
    assert Fitted(catalog()["ab-ll-paged"].variant({}), stats).capacity() == 24  # 6 pixels, doubled until 20 cells fit


@pytest.mark.parametrize(("method", "params"), [*PAGED, ("ab-ll", {}), ("ab-ll-bucket", {}), *SORTED])
def test_grows_until_the_frame_fits(device, method, params):
    with drawn(device, method, DEEP, **params) as frame:
        variant = frame.variant
        assert frame.memory_bytes == Fitted(variant, stats_of(DEEP)).memory_bytes()
        assert Fitted(variant, stats_of(DEEP)).capacity() > Fitted(variant, stats_of(DEEP)).start_capacity()
        assert_exact(frame, DEEP)


@pytest.mark.parametrize("buckets", [2, 3, 8, 32])
def test_buckets_composite_in_order(device, buckets):
    with drawn(device, "ab-ll-bucket", DEEP, buckets=buckets) as frame:
        assert_exact(frame, DEEP)


@pytest.mark.parametrize("depths", [[0.5] * 4, [0.0] * 4, [0.25, 0.25, 0.25, 0.75]])
def test_buckets_of_no_depth_range(device, depths):
    scene = stack(depths, [COLOURS[0]] * 4)
    with drawn(device, "ab-ll-bucket", scene) as frame:
        assert_shows(frame, [COLOURS[0]] * 4)


def test_the_class_of_a_pixel_is_that_of_its_longest_bucket(device):
    """Twelve fragments are in the first bucket, one in the last."""
    scene = stack([*np.linspace(0.1, 0.12, 12), 0.9])
    with drawn(device, "ab-ll-bucket", scene, bma="on") as frame:
        assert_exact(frame, scene)


def test_buckets_share_out_the_fragments(device):
    """Depths at equal distances: the longest list is a quarter."""
    scene = stack(np.linspace(0, 0.984375, 64))
    with drawn(device, "ab-ll-bucket", scene, buckets=4) as frame:
        pixels, links = SIZE[0] * SIZE[1], frame.words("next")
        lengths = []
        for bucket in range(4):
            at, length = bucket * pixels, 0
            while links[at] != 0xFFFFFFFF:
                at, length = 4 * pixels + links[at], length + 1
            lengths.append(length)
    assert lengths == [16] * 4


@pytest.mark.parametrize(("method", "params"), SORTED)
def test_lists_are_sorted_when_built(device, method, params):
    """The resolve does not sort: arrival in any order gives the same image."""
    for seed in range(3):
        scene = stack(np.random.default_rng(seed).permutation(16) / 16)
        with drawn(device, method, scene, **params) as frame:
            assert_exact(frame, scene)


@pytest.mark.parametrize(("method", "params"), [*SORTED, ("open-pre", {"atomic64": "emulated"})])
def test_early_culling_errs_by_a_twentieth_at_most(device, method, params):
    scene = generate(SceneConfig(size=(33, 21), depth_complexity=40, alpha=(0.2, 0.5), order="front_to_back"))
    with drawn(device, method, scene, early_culling="on", **params) as frame:
        assert frame.lost_fragments() == 0
        assert np.abs(frame.image() - composite(scene)).max() <= 0.05 + 1e-4
        assert 0 < frame.probe()["stored_fragments"] < 0.6 * stats_of(scene).F


@pytest.mark.parametrize(("method", "params"), [*SORTED, ("open-pre", {"atomic64": "emulated"})])
def test_early_culling_keeps_what_nothing_hides(device, method, params):
    scene = generate(SceneConfig(size=(33, 21), depth_complexity=12, alpha=(0.2, 0.2)))
    with drawn(device, method, scene, early_culling="on", **params) as frame:
        assert_exact(frame, scene)
        assert frame.probe()["stored_fragments"] == stats_of(scene).F


@pytest.mark.parametrize("method", ["lin-pre", "open-pre"])
def test_early_culling_weakens_the_guarantee(method):
    exact, weak = (catalog()[method].variant({"early_culling": choice}) for choice in ("off", "on"))
    assert exact.guarantee == "exact all"
    assert weak.guarantee == "approximate"
    assert weak.weaknesses


def test_atomic64_matters_only_where_it_is_used():
    plain = catalog()["lin-pre"].variant({"insert": "cas32", "atomic64": "emulated"})
    assert plain.params["atomic64"] == "native"
    assert not plain.needs
    assert catalog()["lin-pre"].variant({"insert": "max64"}).needs == ("shader_atomic_int64",)
    assert not catalog()["lin-pre"].variant({"insert": "max64", "atomic64": "emulated"}).needs
