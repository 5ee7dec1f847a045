"""The order of a tile: its pixels take it where it is right, mend it in a window, or sort by themselves."""

import numpy as np
import pytest

from mfr_bench.config.model import Scene as SceneConfig
from mfr_bench.gpu.device import Device
from mfr_bench.gpu.single import shown
from mfr_bench.methods import catalog
from mfr_bench.scene import generate

from .drawing import over, stack

STAGES = pytest.mark.parametrize("stage", ["fragment", "compute"])
NO_FALLBACK = ("common/resolve_register.glsl", "vec4 resolve_pixel(uint p) {",
               "vec4 resolve_pixel(uint p) { return vec4(9.0);")
FLAT = SceneConfig(size=(30, 21), depth_complexity=20, seed=3)
CROSSING = SceneConfig(size=(30, 21), depth_complexity=20, slant=0.9, seed=3)
LEANING = SceneConfig(size=(30, 21), depth_complexity=20, slant=0.2, seed=3)


def error(device: Device, config: SceneConfig, **params) -> float:
    """Largest error of a channel."""
    variant = catalog()["ab-coherent"].variant(params)
    with shown(device, generate(config)) as on:
        return on.errors(variant, on.render(variant))["max_abs_error"]


@STAGES
@pytest.mark.parametrize("window", [1, 4, 16])
def test_every_window_gives_the_exact_image(device, stage, window):
    for config in (FLAT, LEANING, CROSSING):
        assert error(device, config, resolve=stage, window=window) < 1e-6


@STAGES
def test_flat_primitives_need_neither_a_window_nor_a_sort_of_a_pixel(device, plant, stage):
    plant(*NO_FALLBACK)
    assert error(device, FLAT, resolve=stage, window=1) < 1e-6


@STAGES
def test_a_wider_window_mends_more(device, plant, stage):
    """Crossing primitives need the sort of single pixels; where orders differ by a few places, a window will do."""
    plant(*NO_FALLBACK)
    assert error(device, CROSSING, resolve=stage, window=4) > 1
    assert error(device, LEANING, resolve=stage, window=1) > 1
    assert error(device, LEANING, resolve=stage, window=16) < 1e-6


@STAGES
def test_a_pixel_with_more_fragments_than_are_ordered_is_sorted_by_itself(device, stage):
    count = 1030
    order, rgba = np.random.default_rng(1).permutation(count), np.random.default_rng(2).integers(1, 4, (count, 4))
    variant = catalog()["ab-coherent"].variant({"resolve": stage})
    with shown(device, stack((order + 1) / (count + 2), rgba, size=(1, 1))) as on:
        np.testing.assert_allclose(on.render(variant)[0, 0], over(rgba[np.argsort(order)]), rtol=0, atol=1e-5)
