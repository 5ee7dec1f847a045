"""Counts of rectangles that can meet in a pixel: never fewer than do, and as many where their edges lie on the grid."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mfr_bench.config.model import Scene as SceneConfig
from mfr_bench.gpu.capture import count
from mfr_bench.gpu.scene_buffer import SceneBuffer
from mfr_bench.gpu.targets import Canvas
from mfr_bench.oracle.composite import fragment_counts
from mfr_bench.scene import generate
from mfr_bench.scene.overlap import CELL, most_over

from ..scenes import configs, placed


def truly(rects, viewport) -> int:
    counts = np.zeros(viewport[::-1], dtype=int)
    for x0, y0, x1, y1 in rects:
        counts[y0:y1, x0:x1] += 1
    return int(counts.max(initial=0))


@given(placed() | configs(fragment_probability=1.0).map(generate))
def test_no_pixel_has_more_layers_than_the_bound(scene):
    assert scene.layers >= fragment_counts(scene).max()
    assert scene.layers <= len(scene)


@given(st.lists(st.tuples(*[st.integers(0, 6)] * 4), max_size=12))
def test_on_the_grid_the_bound_is_the_number(edges):
    rects = CELL * np.array([[min(a, b), min(c, d), max(a, b), max(c, d)] for a, b, c, d in edges],
                            dtype=np.int32).reshape(-1, 4)
    viewport = (6 * CELL, 6 * CELL)
    assert most_over(rects, viewport) == truly(rects, viewport)


def test_tiles_have_as_many_layers_as_each_tile():
    scene = generate(SceneConfig(size=(100, 70), depth_complexity=5, layout="tiles", pixel_density=0.6, seed=2))
    assert scene.layers == 5 < len(scene)


@pytest.mark.parametrize("kind", ["hairball", "needles", "temple"])
def test_strips_have_no_more_fragments_in_a_pixel_than_their_boxes_allow(device, kind):
    scene = generate(SceneConfig(kind=kind, size=(97, 71), depth_complexity=12, mean_depth=5, seed=7))
    quads, canvas = SceneBuffer(device, scene), Canvas(device, scene.viewport)
    assert count(device, quads, canvas).max() <= scene.layers <= 2 * len(scene)
    for thing in (quads, canvas):
        thing.release()
