"""Stencil routing: fragments go to samples in order of arrival, beyond what a stencil counts; samples are memory."""

import numpy as np
import pytest

from mfr_bench.config import Measure
from mfr_bench.config import Scene as SceneConfig
from mfr_bench.methods import catalog
from mfr_bench.methods.spec import SAMPLE_FEATURES, Fitted, SceneStats
from mfr_bench.oracle.composite import composite
from mfr_bench.plan import Cell, Limits, judge
from mfr_bench.store.status import EXACT_ERROR

from .drawing import chosen, drawn, stack

COUNTS = tuple(SAMPLE_FEATURES.values())
SIZES = SceneStats(W=10, H=6, n=30, F=900, primitives=30, histogram=(0,) * 30 + (60,))


def depths(count):
    return np.random.default_rng(3).permutation(np.linspace(0.1, 0.9, count))


def draw(device, method, scene, **params):
    with drawn(device, method, scene, **params) as frame:
        assert frame.memory_bytes == Fitted(frame.variant, frame.stats).memory_bytes()
        assert frame.lost_fragments() == 0
        return frame.image(), frame.geometry_passes


@pytest.mark.parametrize("multisampling", ["on", "off"])
@pytest.mark.parametrize("samples", COUNTS)
@pytest.mark.parametrize("count", [1, 3, 4, 5, 8, 33])
def test_all_fragments_in_as_few_passes_as_samples_allow(device, count, samples, multisampling):
    scene = stack(depths(count))
    image, passes = draw(device, "peel-srab", scene, samples=samples, multisampling=multisampling)
    assert np.abs(image - composite(scene)).max() <= EXACT_ERROR
    assert passes == -(-count // samples)


def test_more_fragments_than_a_stencil_counts(device):
    """The decrement is clamped and the passes go on by submission, so the 256th fragment is like any other."""
    scene = stack(depths(530), size=(3, 2))
    image, passes = draw(device, "peel-srab", scene)
    assert np.abs(image - composite(scene)).max() <= EXACT_ERROR
    assert passes == 133


def test_more_fragments_than_a_stencil_counts_in_one_pass(device):
    scene = stack(depths(600), size=(3, 2))
    image, _ = draw(device, "kb-sr", scene, k=4)
    assert np.abs(image - composite(chosen(scene, slice(4)))).max() <= EXACT_ERROR


@pytest.mark.parametrize("multisampling", ["on", "off"])
@pytest.mark.parametrize("k", [1, 2, 3, 4, 7, 8, 16, 32])
def test_the_first_k_to_arrive_are_kept(device, k, multisampling):
    scene = stack(depths(40))
    image, passes = draw(device, "kb-sr", scene, k=k, multisampling=multisampling)
    assert np.abs(image - composite(chosen(scene, slice(k)))).max() <= EXACT_ERROR
    assert passes == 1


@pytest.mark.parametrize(("method", "params"), [("peel-srab", {}), ("kb-sr", {"k": 4})])
def test_equal_depths_are_kept_in_order_of_arrival(device, method, params):
    scene = stack([0.5, 0.25, 0.5, 0.5])
    image, _ = draw(device, method, scene, **params)
    assert np.abs(image - composite(scene)).max() <= EXACT_ERROR


@pytest.mark.parametrize(("k", "samples"), [(1, 4), (3, 4), (4, 4), (5, 8), (8, 8), (16, 16), (17, 32), (32, 32)])
def test_memory_is_three_words_a_sample(k, samples):
    variant = catalog()["kb-sr"].variant({"k": k})
    assert sum(Fitted(variant, SIZES).memory_bytes().values()) == 4 * SIZES.P * 3 * samples
    assert (Fitted(variant, SIZES).model_bytes() == 4 * SIZES.P * 3 * samples) == (k == samples)


@pytest.mark.parametrize(("method", "params", "reason"), [
    ("peel-srab", {"samples": 8}, "needs samples_8"), ("kb-sr", {"k": 5}, "needs samples_8: without it k is at most 4"),
    ("kb-sr", {"k": 32}, "needs samples_32: without it k is at most 4"),
    ("kb-sr", {"k": 33}, "needs samples_64: without it k is at most 4"),
    ("kb-sr", {"k": 4, "multisampling": "off"}, "needs sample_stencil"),
    ("peel-srab", {"samples": 4}, None),
])
def test_a_device_with_fewer_samples_is_told_apart(method, params, reason):
    limits = Limits(features=frozenset({"samples_4"}), max_block_bytes=2**27, max_texture_size=16384)
    chosen = catalog()[method].variant(params).params
    cell = Cell("e", method, method, chosen, SceneConfig(size=(10, 6), depth_complexity=30), Measure(), {})
    decision = judge(cell, catalog(), SIZES, limits)
    assert decision == (reason and ("unsupported", reason))


def test_samples_are_powers_of_two():
    with pytest.raises(ValueError, match=r"5 is not allowed; allowed: 4 \| 8 \| 16 \| 32"):
        catalog()["peel-srab"].param("samples").parse(5)


@pytest.mark.parametrize("multisampling", ["on", "off"])
@pytest.mark.parametrize("per_pass", COUNTS)
@pytest.mark.parametrize("k", [1, 4, 7, 40, 64])
def test_several_passes_keep_the_first_k_to_arrive(device, k, per_pass, multisampling):
    scene = stack(depths(40))
    image, passes = draw(device, "kb-sr", scene, k=k, per_pass=per_pass, multisampling=multisampling)
    assert np.abs(image - composite(chosen(scene, slice(k)))).max() <= EXACT_ERROR
    assert passes == -(-min(k, 40) // per_pass)


def test_several_passes_need_the_samples_of_one():
    variant = catalog()["kb-sr"].variant({"k": 20, "per_pass": 8})
    assert variant.needs == ("samples_8",)
    assert sum(Fitted(variant, SIZES).memory_bytes().values()) == 4 * SIZES.P * (3 * 8 + 8 + 2 + 2 * 20)
