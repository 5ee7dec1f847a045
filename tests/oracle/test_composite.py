"""The oracle against a sort of every pixel's fragments in plain Python."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mfr_bench.config.model import Scene as SceneConfig
from mfr_bench.hashing import hash3
from mfr_bench.oracle.composite import composite, fragment_counts, stats_of
from mfr_bench.scene import generate
from mfr_bench.scene.quads import Quads

from ..scenes import configs, placed

CLOSE = 1e-13  # float64, some hundred operations on values up to 1


def fragments(scene: Quads, x: int, y: int) -> list[tuple[float, list[int]]]:
    """(depth, RGBA8) of everything that a pixel receives, nearest first."""
    found = []
    for quad, ((x0, y0, x1, y1), depth, rgba) in enumerate(zip(scene.rect, scene.depth, scene.rgba, strict=True)):
        inside = x0 <= x < x1 and y0 <= y < y1 and drawn(scene, x, y, quad)
        if inside and hash3(y * scene.viewport[0] + x, quad, scene.seed) < scene.keep_threshold:
            found.append((float(depth), rgba.tolist()))
    return sorted(found)


def drawn(scene: Quads, x: int, y: int, quad: int) -> bool:
    """Whether a pixel that draws its number of fragments receives the quad."""
    if not scene.least:
        return True
    pixel, count = y * scene.viewport[0] + x, len(scene)
    layers = scene.least + hash3(pixel, 2**32 - 1, scene.seed) % (count - scene.least + 1)
    return (hash3(pixel, 2**32 - 2, scene.seed) % count + quad) % count < layers


def over(layers: list[tuple[float, list[int]]]) -> list[float]:
    """Premultiplied RGBA of straight 8-bit layers, nearest first, over transparent black."""
    colour, transmittance = [0.0, 0.0, 0.0], 1.0
    for _, (*rgb, alpha) in layers:
        colour = [c + transmittance * (alpha / 255) * (v / 255) for c, v in zip(colour, rgb, strict=True)]
        transmittance *= 1 - alpha / 255
    return [*colour, 1 - transmittance]


def by_hand(scene: Quads, layers: int | None = None) -> np.ndarray:
    width, height = scene.viewport
    return np.array([[over(fragments(scene, x, y)[:layers]) for x in range(width)] for y in range(height)])


@given(placed(), st.none() | st.integers(1, 4))
def test_every_pixel_is_its_sorted_fragments_composited(scene, layers):
    image = composite(scene, layers)
    assert image.dtype == np.float64
    np.testing.assert_allclose(image, by_hand(scene, layers), rtol=0, atol=CLOSE)


@given(placed(), st.integers(1, 4))
def test_the_best_by_a_criterion_are_composited_by_depth(scene, layers):
    best = {"nearest": lambda f: f[0], "furthest": lambda f: -f[0], "opaque": lambda f: (-f[1][3], f[0])}
    width, height = scene.viewport
    for criterion, rank in best.items():
        expected = [[over(sorted(sorted(fragments(scene, x, y), key=rank)[:layers])) for x in range(width)]
                    for y in range(height)]
        np.testing.assert_allclose(composite(scene, layers, criterion), expected, rtol=0, atol=CLOSE)


@given(configs(size=(9, 7), depth_complexity=3), st.none() | st.integers(1, 3))
def test_on_every_layout_order_and_probability(config, layers):
    scene = generate(config)
    np.testing.assert_allclose(composite(scene, layers), by_hand(scene, layers), rtol=0, atol=CLOSE)


@given(placed())
def test_counts_are_the_fragments_of_each_pixel(scene):
    width, height = scene.viewport
    counts = np.array([[len(fragments(scene, x, y)) for x in range(width)] for y in range(height)])
    np.testing.assert_array_equal(fragment_counts(scene), counts)
    stats = stats_of(scene)
    assert (stats.W, stats.H, stats.F, stats.primitives) == (width, height, counts.sum(), len(scene))
    assert stats.n == max(1, counts.max())
    assert stats.histogram == tuple(np.bincount(counts.ravel()))
    assert stats.rejects == (scene.fragment_probability < 1 or scene.least > 0)
    assert [stats.bounded(k) for k in (1, 2, 99)] == [np.minimum(counts, k).sum() for k in (1, 2, 99)]


@given(configs(size=(23, 17)))
def test_as_many_layers_as_there_are_fragments_are_all_of_them(config):
    scene = generate(config)
    np.testing.assert_array_equal(composite(scene, stats_of(scene).n), composite(scene))


@given(placed(), st.randoms(use_true_random=False))
def test_the_order_of_submission_does_not_matter(scene, random):
    scene = replace(scene, fragment_probability=1.0, least=0)  # which fragments are rejected does depend on it
    order = random.sample(range(len(scene)), len(scene))
    shuffled = replace(scene, rect=scene.rect[order], depth=scene.depth[order], rgba=scene.rgba[order])
    np.testing.assert_array_equal(composite(shuffled), composite(scene))


@pytest.mark.parametrize("probability", [1.0, 0.5])
def test_an_empty_scene_is_transparent_black(probability):
    scene = generate(SceneConfig(size=(9, 7), depth_complexity=0, fragment_probability=probability))
    assert composite(scene).shape == (7, 9, 4)
    assert not composite(scene).any()
    stats = stats_of(scene)
    assert (stats.n, stats.F, stats.histogram) == (1, 0, (63,))


def test_row_0_is_at_the_bottom_and_colours_are_premultiplied():
    scene = Quads((2, 2), np.array([[0, 0, 1, 1]], dtype=np.int32), np.array([0.5], dtype=np.float32),
                  np.array([[255, 51, 0, 102]], dtype=np.uint8), 1.0, 1)
    image = composite(scene)
    assert image[0, 0].tolist() == pytest.approx([0.4, 0.08, 0, 0.4])
    assert not image[1].any()


def test_an_opaque_fragment_hides_what_is_behind():
    rect = np.array([[0, 0, 1, 1]] * 3, dtype=np.int32)
    rgba = np.array([[255, 255, 255, 255], [0, 255, 0, 255], [255, 0, 0, 51]], dtype=np.uint8)
    scene = Quads((1, 1), rect, np.array([0.75, 0.5, 0.25], dtype=np.float32), rgba, 1.0, 1)
    assert composite(scene)[0, 0].tolist() == pytest.approx([0.2, 0.8, 0, 1])
    assert composite(scene, 1)[0, 0].tolist() == pytest.approx([0.2, 0, 0, 0.2])
