"""Multi depth test: 64-bit elements by emulation, equal depths, and the papers' conversion."""

import numpy as np
import pytest

from mfr_bench.config import Scene as SceneConfig
from mfr_bench.methods import catalog
from mfr_bench.oracle.composite import composite
from mfr_bench.oracle.quality import conformance
from mfr_bench.oracle.ties import answer_of_quads
from mfr_bench.scene import generate

from .drawing import assert_shows, drawn, over, stack

COLOURS = [(200, 10, 30, 120), (10, 200, 30, 90), (90, 90, 250, 60), (200, 10, 30, 120)]
DEEP = generate(SceneConfig(size=(33, 21), depth_complexity=40, fragment_probability=0.7, seed=3))


@pytest.mark.parametrize("atomic64", ["native", "emulated"])
@pytest.mark.parametrize("k", [1, 7, 16, 64])
def test_64_bits_bring_depth_and_colour_at_once(device, atomic64, k):
    with drawn(device, "kb-mdt64", DEEP, k=k, atomic64=atomic64) as frame:
        assert np.abs(frame.image() - composite(DEEP, k)).max() < 1e-4
        assert frame.lost_fragments() == 0
        assert frame.geometry_passes == 1


@pytest.mark.parametrize("atomic64", ["native", "emulated"])
@pytest.mark.parametrize("k", [1, 2, 3, 4, 5])
def test_64_bits_keep_equal_depths_in_order_of_payload(device, atomic64, k):
    """Two of them are equal in all their bits, and both stay."""
    with drawn(device, "kb-mdt64", stack([0.5] * 4, COLOURS), k=k, atomic64=atomic64) as frame:
        assert_shows(frame, sorted(COLOURS, key=lambda c: c[::-1])[:k])


@pytest.mark.parametrize("k", [1, 3, 8])
def test_32_bits_lose_all_but_one_colour_of_equal_depths(device, k):
    with drawn(device, "kb-mdt32", stack([0.5] * 4, COLOURS), k=k) as frame:
        image = frame.image()
    shown = [over([colour]) for colour in COLOURS]
    assert all(min(np.abs(pixel - one).max() for one in shown) < 1e-5 for pixel in image.reshape(-1, 4))


@pytest.mark.parametrize("resolve", ["fragment", "compute"])
def test_32_bits_show_no_colour_of_an_earlier_frame(device, resolve):
    """Colours are not cleared: slots that share a depth show that of the first alone."""
    with drawn(device, "kb-mdt32", stack([0.25, 0.5, 0.5, 0.5], COLOURS), k=4, resolve=resolve) as frame:
        frame.fill("colours", np.full(4 * 7 * 5, 0xFFFFFFFF, dtype=np.uint32))
        frame.draw()
        image = frame.image()
    shown = [over([COLOURS[0], colour]) for colour in COLOURS[1:]]
    assert all(min(np.abs(pixel - one).max() for one in shown) < 1e-5 for pixel in image.reshape(-1, 4))


@pytest.mark.parametrize(("depth_bits", "collide"), [(8, True), (11, True), (13, False), (24, False), (32, False)])
def test_scaled_conversion_loses_what_is_finer(device, depth_bits, collide):
    """Depths 2**-12 apart need more than 12 bits."""
    scene = stack([0.5, 0.5 + 2**-12], COLOURS[:2])
    with drawn(device, "kb-mdt32", scene, k=2, key="fixed", depth_bits=depth_bits) as frame:
        wrong = conformance(frame.image(), answer_of_quads(scene))["wrong_pixels"]
    assert wrong == (scene.viewport[0] * scene.viewport[1] if collide else 0)


def test_scaled_conversion_is_an_approximation():
    method = catalog()["kb-mdt32"]
    assert method.variant({}).guarantee == "exact k nearest"
    fixed = method.variant({"key": "fixed", "k": 5})
    assert fixed.guarantee == "approximate"
    assert fixed.weaknesses
    assert fixed.layers == 5


def test_bits_of_the_conversion_mean_nothing_to_float_bits():
    assert catalog()["kb-mdt32"].variant({"depth_bits": 11}) == catalog()["kb-mdt32"].variant({})


def test_the_whole_depth_range_keeps_its_order(device):
    """Depth 0 and depth 1 included, where the bits of a float are at their ends."""
    depths = [1.0, 0.0, 2.0**-23, 1 - 2.0**-23]
    for chosen in ({}, {"key": "fixed"}, {"key": "fixed", "depth_bits": 32}):
        with drawn(device, "kb-mdt32", stack(depths, COLOURS), k=4, **chosen) as frame:
            assert_shows(frame, [COLOURS[i] for i in (1, 2, 3, 0)])
