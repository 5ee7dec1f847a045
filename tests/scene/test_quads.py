"""Synthetic scenes: the same bits for a seed, distinct exact depths, the coverage and the order that were asked for."""

import hashlib
import itertools
import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given

from mfr_bench.config.model import Scene as SceneConfig
from mfr_bench.hashing import hash3
from mfr_bench.oracle.composite import composite, fragment_counts
from mfr_bench.scene import generate
from mfr_bench.scene.kinds.quads import TILE

from ..methods.drawing import drawn, stack
from ..scenes import configs

FIELDS = ("rect", "depth", "rgba")


def rows(scene):
    """The quads as a sorted list, whatever their order of submission."""
    return sorted(zip(scene.depth.tolist(), scene.rect.tolist(), scene.rgba.tolist(), strict=True))


def covered(scene):
    mask = np.zeros(scene.viewport[::-1], dtype=bool)
    for x0, y0, x1, y1 in scene.rect:
        mask[y0:y1, x0:x1] = True
    return mask


def digest(scene):
    return hashlib.sha256(b"".join(np.ascontiguousarray(getattr(scene, f)).tobytes() for f in FIELDS)).hexdigest()[:16]


@given(configs())
def test_a_seed_gives_the_same_bits(config):
    first, second = generate(config), generate(config)
    for name in FIELDS:
        np.testing.assert_array_equal(getattr(first, name), getattr(second, name))


@given(configs())
def test_bounds_and_reach_are_those_of_the_pixels_covered(config):
    """The rectangle is the smallest; the reach counts every quad's pixels, fragments unless they are rejected."""
    scene = generate(config)
    left, bottom, width, height = scene.bounds
    ys, xs = np.nonzero(covered(scene))
    if len(xs):
        assert (left, bottom, left + width, bottom + height) == (xs.min(), ys.min(), xs.max() + 1, ys.max() + 1)
    else:
        assert width * height == 0
    counts = fragment_counts(scene)
    assert counts.sum() <= scene.reach
    assert counts.sum() == scene.reach or config.fragment_probability < 1 or config.least_depth


@given(configs())
def test_arrays_are_what_the_interface_says(config):
    scene = generate(config)
    count = len(scene)
    assert (scene.rect.dtype, scene.depth.dtype, scene.rgba.dtype) == (np.int32, np.float32, np.uint8)
    assert (scene.rect.shape, scene.depth.shape, scene.rgba.shape) == ((count, 4), (count,), (count, 4))
    x0, y0, x1, y1 = scene.rect.T
    width, height = config.size
    assert ((x0 >= 0) & (x0 < x1) & (x1 <= width) & (y0 >= 0) & (y0 < y1) & (y1 <= height)).all()


@given(configs())
def test_depths_are_distinct_and_exact_on_their_way_through_the_device(config):
    depth = generate(config).depth
    grid = depth.astype(np.float64) * 2**23
    assert (grid == np.round(grid)).all()
    assert ((depth > 0) & (depth < 1)).all()
    assert len(np.unique(depth)) == len(depth)
    device = np.float32(2) * depth - np.float32(1)
    assert (device * np.float32(0.5) + np.float32(0.5) == depth).all()


@given(configs())
def test_alphas_are_the_range_in_steps_of_8_bits(config):
    low, high = (round(255 * a) for a in config.alpha)
    alpha = generate(config).rgba[:, 3]
    assert ((alpha >= low) & (alpha <= high)).all()


def _within_a_tenth(ideal, most):
    return range(max(1, math.floor(0.9 * ideal)), max(1, min(most, math.floor(1.1 * ideal))) + 1)


@given(configs(layout="block"))
def test_a_block_is_centred_and_as_near_the_density_as_whole_pixels_allow(config):
    scene = generate(config)
    if not len(scene):
        return
    assert (scene.rect == scene.rect[0]).all()
    x0, y0, x1, y1 = scene.rect[0]
    (width, height), target = config.size, config.pixel_density * math.prod(config.size)
    assert abs(x0 - (width - x1)) <= 1
    assert abs(y0 - (height - y1)) <= 1
    others = itertools.product(*(_within_a_tenth(side * math.sqrt(config.pixel_density), side) for side in config.size))
    assert abs((x1 - x0) * (y1 - y0) - target) <= min(abs(w * h - target) for w, h in others) + 1e-6


@given(configs(layout="tiles"))
def test_tiles_hold_the_same_number_of_quads_and_come_nearest_the_density(config):
    scene = generate(config)
    tiles, counts = np.unique(scene.rect, axis=0, return_counts=True)
    assert (counts == config.depth_complexity).all()
    assert (tiles[:, :2] % TILE == 0).all()
    if len(tiles) > 1:
        area = np.prod(tiles[:, 2:] - tiles[:, :2], axis=1).sum()
        assert abs(area - config.pixel_density * math.prod(config.size)) <= TILE * TILE / 2


@given(configs(layout="random"))
def test_random_quads_have_the_mean_depth_complexity(config):
    scene = generate(config)
    x0, y0, x1, y1 = scene.rect.T
    assert len({*(x1 - x0)}) <= 1
    assert len({*(y1 - y0)}) <= 1
    within = generate(SceneConfig(size=config.size, pixel_density=config.pixel_density, depth_complexity=1)).rect[0]
    assert (scene.rect[:, :2] >= within[:2]).all()
    assert (scene.rect[:, 2:] <= within[2:]).all()
    if len(scene):
        block = math.prod(within[2:] - within[:2])
        assert abs(((x1 - x0) * (y1 - y0)).sum() - config.depth_complexity * block) <= (x1 - x0)[0] * (y1 - y0)[0] / 2


@pytest.mark.parametrize("layout", ["block", "tiles", "random"])
def test_orders_submit_the_same_quads(layout):
    scenes = {order: generate(SceneConfig(size=(97, 71), depth_complexity=9, layout=layout, order=order, seed=5))
              for order in ("random", "front_to_back", "back_to_front")}
    assert rows(scenes["random"]) == rows(scenes["front_to_back"]) == rows(scenes["back_to_front"])
    assert (np.diff(scenes["front_to_back"].depth) > 0).all()
    assert (np.diff(scenes["back_to_front"].depth) < 0).all()
    steps = np.diff(scenes["random"].depth) > 0
    assert 0.2 < steps.mean() < 0.8


def test_seeds_and_frames_differ():
    config = SceneConfig(size=(97, 71), depth_complexity=9)
    assert rows(generate(config)) != rows(generate(SceneConfig(size=(97, 71), depth_complexity=9, seed=2)))
    assert rows(generate(config, frame=1)) == rows(generate(SceneConfig(size=(97, 71), depth_complexity=9, seed=2)))
    assert rows(generate(SceneConfig(size=(9, 9), depth_complexity=9, seed=2**32 - 1), frame=1)) == \
        rows(generate(SceneConfig(size=(9, 9), depth_complexity=9, seed=0)))


@pytest.mark.parametrize("size", [(1, 1), (1, 70), (97, 71), (33, 31)])
@pytest.mark.parametrize("layout", ["block", "tiles", "random"])
def test_full_density_covers_every_pixel_of_odd_sizes(size, layout):
    scene = generate(SceneConfig(size=size, depth_complexity=40, layout=layout, quad_size=(1, 1), seed=3))
    if layout == "random":
        assert covered(scene).mean() > 0.9
    else:
        assert covered(scene).all()


@pytest.mark.parametrize("layout", ["block", "tiles", "random"])
def test_an_empty_scene_has_no_quads(layout):
    assert len(generate(SceneConfig(size=(97, 71), depth_complexity=0, layout=layout))) == 0


@pytest.mark.parametrize("probability", [0.1, 0.5, 0.9])
def test_fragments_are_kept_with_their_probability(probability):
    scene = generate(SceneConfig(size=(97, 71), depth_complexity=9, fragment_probability=probability, seed=6))
    kept = [scene.kept(quad, 0, 0, 97, 71) for quad in range(9)]
    assert np.mean(kept) == pytest.approx(probability, abs=0.02)
    assert np.mean(kept[0] & kept[1]) == pytest.approx(probability**2, abs=0.03)


def test_what_is_kept_does_not_depend_on_the_rectangle_asked_for():
    scene = generate(SceneConfig(size=(97, 71), depth_complexity=3, fragment_probability=0.5, seed=6))
    whole = scene.kept(1, 0, 0, 97, 71)
    assert (scene.kept(1, 13, 7, 40, 31) == whole[7:31, 13:40]).all()
    assert whole[50, 60] == (hash3(50 * 97 + 60, 1, 6) < 2**31)


@pytest.mark.parametrize(("layout", "found"), [
    ("block", "3972df5d8e29b6b2"), ("tiles", "9f7527c393d62dee"), ("random", "b1d838609f71f035"),
])
def test_scenes_never_change_silently(layout, found):
    """Every image and every key of a result depends on these bits."""
    config = SceneConfig(size=(97, 71), pixel_density=0.4, depth_complexity=6, layout=layout, seed=7)
    assert digest(generate(config)) == found


def test_one_scene_written_out():
    scene = generate(SceneConfig(size=(8, 6), pixel_density=0.5, depth_complexity=3, seed=7))
    assert scene.rect.tolist() == [[1, 1, 7, 5], [1, 1, 7, 5], [1, 1, 7, 5]]
    assert (scene.depth * 2**23).astype(int).tolist() == [7666439, 916517, 4456706]
    assert scene.rgba.tolist() == [[117, 69, 127, 98], [145, 217, 33, 53], [19, 54, 39, 97]]


@pytest.mark.parametrize("order", ["random", "front_to_back"])
def test_pixels_draw_their_number_of_fragments_evenly(order):
    """From a tenth of the depth complexity to all of it (kplus_2015 §5.1.1: n up to 10 k), each as often."""
    config = SceneConfig(size=(160, 150), depth_complexity=20, least_depth=0.1, order=order, seed=4)
    scene = generate(config)
    counts = fragment_counts(scene)
    assert scene.rejects and (counts.min(), counts.max()) == (2, 20)
    drawn = np.bincount(counts.ravel(), minlength=21)[2:]
    assert drawn == pytest.approx(np.full(19, counts.size / 19), rel=0.15)
    assert np.abs(np.corrcoef(counts[:, :-1].ravel(), counts[:, 1:].ravel())[0, 1]) < 0.03  # neighbours draw apart


def test_a_drawn_pixel_takes_every_quad_alike_often():
    scene = generate(SceneConfig(size=(160, 150), depth_complexity=20, least_depth=0.1, seed=4))
    shares = [scene.kept(quad, 0, 0, 160, 150).mean() for quad in range(20)]
    assert shares == pytest.approx([11 / 20] * 20, rel=0.05)


def test_drawn_fragments_are_thinned_by_the_fragment_probability():
    config = SceneConfig(size=(160, 150), depth_complexity=40, least_depth=0.1, fragment_probability=0.25, seed=4)
    counts = fragment_counts(generate(config))
    assert counts.mean() == pytest.approx(22 * 0.25, rel=0.02)
    assert 0.2 < (counts < 4).mean() < 0.5  # pixels with fewer than k = 4 of n = 40 fragments


def test_a_fragment_whose_hash_is_the_threshold_is_rejected_on_the_device_too(device):
    scene = stack([0.75, 0.5], size=(1, 1))
    scene = replace(scene, fragment_probability=hash3(0, 1, scene.seed) / 2**32)
    assert scene.keep_threshold == hash3(0, 1, scene.seed) and not scene.kept(1, 0, 0, 1, 1).any()
    with drawn(device, "ab-array", scene) as frame:
        assert frame.lost_fragments() == 0
        np.testing.assert_allclose(frame.image(), composite(scene), rtol=0, atol=1e-6)
