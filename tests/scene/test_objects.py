"""Slanted quads, hairballs, needle trees, temples and mixed depths: the same bits for a seed, depths on their grid."""

import hashlib
import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mfr_bench.config.model import Scene as SceneConfig
from mfr_bench.gpu.capture import count
from mfr_bench.gpu.scene_buffer import SceneBuffer
from mfr_bench.gpu.targets import Canvas
from mfr_bench.oracle.composite import fragment_counts
from mfr_bench.scene import colours, generate, objects
from mfr_bench.scene.spec.layout import shares, spread
from mfr_bench.scene.triangles import Triangles

KINDS = ("hairball", "needles", "temple")
SLANTED = {kind: SceneConfig(kind=kind, size=(97, 71), depth_complexity=12, mean_depth=5, seed=7) for kind in KINDS}
SLANTED["slanted"] = SceneConfig(size=(97, 71), depth_complexity=12, layout="tiles", slant=0.6, seed=7)
EACH = pytest.mark.parametrize("kind", SLANTED)


def window(scene):
    """Window depths of all corners as the device gets them."""
    return scene.position[..., 2] / scene.position[..., 3] / 2 + 0.5


def rows(scene):
    """The strips as a sorted list, whatever their order of submission."""
    return sorted(zip(scene.position.tolist(), scene.rgba.tolist(), strict=True))


@pytest.mark.parametrize(("kind", "found"), [
    ("hairball", "ae7be8d7a9925e97"), ("needles", "fa65c1e3e584fb80"), ("temple", "607e1a92e88c1401"),
    ("slanted", "1cfbc5fa52ac3984")])
def test_scenes_never_change_silently(kind, found):
    """On any machine: nothing but additions, multiplications, divisions and square roots decides them."""
    scene = generate(SLANTED[kind])
    assert hashlib.sha256(scene.position.tobytes() + scene.rgba.tobytes()).hexdigest()[:16] == found


@EACH
def test_arrays_are_what_the_interface_says(kind):
    scene = generate(SLANTED[kind])
    assert (scene.position.dtype, scene.rgba.dtype) == (np.float32, np.uint8)
    assert (scene.position.shape, scene.rgba.shape) == ((len(scene), 4, 4), (len(scene), 4))
    assert np.isfinite(scene.position).all()
    assert (scene.position[..., 3] > 0).all()


@EACH
def test_no_fragment_lies_beside_the_bounds(device, kind):
    scene = generate(replace(SLANTED[kind], pixel_density=0.2))
    left, bottom, width, height = scene.bounds
    quads, canvas = SceneBuffer(device, scene), Canvas(device, scene.viewport)
    counts = count(device, quads, canvas)
    for thing in (quads, canvas):
        thing.release()
    assert counts[bottom:bottom + height, left:left + width].sum() == counts.sum() > 0
    assert width * height < counts.size or kind == "slanted"  # whose tiles lie all over the viewport


@pytest.mark.parametrize(("corners", "bounds"), [
    ((10.5, 17.2, 20.1, 30.9), (8, 16, 16, 16)), ((16, 8, 24, 16), (8, 0, 24, 24)),
    ((50.5, 1, 59.9, 3), (48, 0, 12, 8)), ((20.2, 29.2, 21.5, 30.5), (16, 24, 8, 8))])
def test_bounds_begin_and_end_at_multiples_of_eight_or_at_the_edge(corners, bounds):
    """The viewport has 60 x 40 pixels; a triangle has three corners of a box, and a pixel to spare on each side."""
    x0, y0, x1, y1 = corners
    at = np.array([[x0, y0], [x1, y0], [x0, y1]]) * 2 / (60, 40) - 1
    position = np.concatenate([at, np.full((3, 1), 0.25), np.ones((3, 1))], axis=1)[None].astype(np.float32)
    assert Triangles((60, 40), position, np.zeros((1, 4), np.uint8), 1.0, 1, np.zeros(1, np.int32)).bounds == bounds


def test_the_bounds_are_the_viewport_where_a_corner_lies_behind_the_eye():
    scene = generate(SLANTED["slanted"])
    position = scene.position.copy()
    position[0, 0, 3] = -1.0
    assert replace(scene, position=position).bounds == (0, 0, *scene.viewport)


@EACH
@pytest.mark.parametrize("frame", [0, 3])
def test_depths_lie_where_float32_steps_by_2_to_minus_24(kind, frame):
    depth = window(generate(SLANTED[kind], frame))
    assert (depth > 0.5).all()
    assert (depth < 1).all()


@EACH
def test_orders_submit_the_same_strips(kind):
    made = {order: generate(replace(SLANTED[kind], order=order))
            for order in ("random", "front_to_back", "back_to_front")}
    assert rows(made["random"]) == rows(made["front_to_back"]) == rows(made["back_to_front"])
    middle = {order: window(scene).astype(np.float64).mean(axis=1) for order, scene in made.items()}
    assert (np.diff(middle["front_to_back"]) > -1e-6).all()
    assert (np.diff(middle["back_to_front"]) < 1e-6).all()
    assert 0.2 < (np.diff(middle["random"]) > 0).mean() < 0.8


@pytest.mark.parametrize("kind", KINDS)
def test_an_animation_comes_nearer_and_goes_back(kind):
    reach = [float(np.abs(generate(SLANTED[kind], frame).position[..., :2]).max()) for frame in range(9)]
    assert reach[8] == reach[0] < reach[1] < reach[2] < reach[3] < reach[4]
    assert reach[5:8] == reach[3:0:-1]


@pytest.mark.parametrize("kind", [*KINDS, "quads"])
def test_a_scene_may_be_empty(kind):
    layout = "mixed" if kind == "quads" else "block"
    assert len(generate(SceneConfig(kind=kind, size=(9, 7), depth_complexity=0, layout=layout))) == 0


@EACH
def test_seeds_differ(kind):
    assert rows(generate(SLANTED[kind])) != rows(generate(replace(SLANTED[kind], seed=8)))


def test_the_slant_is_the_change_of_depth_across_a_quad():
    depth = window(generate(SceneConfig(size=(64, 48), depth_complexity=40, slant=0.5)))
    change = depth.max(axis=1) - depth.min(axis=1)
    assert change == pytest.approx(np.full(40, 0.5 * (0.5 - 2**-9)), abs=1e-6)


@given(st.integers(1, 60), st.floats(0, 1), st.tuples(st.integers(1, 90), st.integers(1, 90)),
       st.floats(0.05, 1), st.integers(0, 2**32 - 1))
def test_mixed_depths_have_exactly_the_maximum_and_nearly_the_mean(layers, part, size, density, seed):
    """The mean to half a side of the last rectangle, and to the pixel that the least of layers has."""
    mean = 1 + part * (layers - 1)
    config = SceneConfig(size=size, pixel_density=density, depth_complexity=layers, layout="mixed", mean_depth=mean,
                         seed=seed)
    counts = fragment_counts(generate(config))
    covered = counts[counts > 0]
    assert counts.max() == layers
    block = [*np.argwhere(counts > 0).min(axis=0)[::-1], *np.argwhere(counts > 0).max(axis=0)[::-1] + 1]
    assert block in generate(config).rect.tolist()
    assert covered.mean() == pytest.approx(mean, abs=(layers + 90) / covered.size)


def test_the_lost_empire_of_gpu_pro_5():
    """Figure 1.3: mean depth 10.3, at most 46 fragments."""
    counts = fragment_counts(generate(SceneConfig(size=(320, 240), depth_complexity=46, layout="mixed",
                                                  mean_depth=10.3)))
    assert counts.max() == 46
    assert counts.mean() == pytest.approx(10.3, abs=0.01)


@given(st.floats(1 / 60, 1))
def test_a_spread_has_the_mean_that_was_asked_for(mean):
    even = (np.arange(4000) + 0.5) / 4000
    found = spread(mean)(even)
    assert found.mean() == pytest.approx(mean, rel=1e-3)
    assert (np.diff(found) >= 0).all()


@given(st.integers(1, 200), st.floats(0, 1))
def test_shares_add_up_to_the_mean(layers, part):
    mean = 1 + part * (layers - 1)
    found = shares(layers, mean)
    assert found[0] == 1
    assert found == sorted(found, reverse=True)
    assert sum(found) == pytest.approx(mean, rel=0.03)


def test_directions_are_those_of_the_circle():
    turns = np.linspace(-1.5, 1.5, 4001)
    cosine, sine = objects.direction(turns)
    assert cosine == pytest.approx(np.cos(2 * np.pi * turns), abs=2e-7)
    assert sine == pytest.approx(np.sin(2 * np.pi * turns), abs=2e-7)


def test_colours_of_a_plane_lie_on_it():
    index = np.arange(500, dtype=np.uint64)
    found = colours.rgba(SceneConfig(size=(4, 4), depth_complexity=1, colours="plane"), index, 3)[:, :3]
    normal = np.cross(colours.TEAL, colours.ORANGE)
    off = np.square(found / 255.0) @ (normal / np.linalg.norm(normal))
    assert np.abs(off).max() < 2.5 / 255
    assert len(np.unique(found, axis=0)) > 300


@pytest.mark.parametrize("count", [1, 3, 12])
def test_colour_sets_have_so_many_hues(count):
    index = np.arange(800, dtype=np.uint64)
    found = colours.rgba(SceneConfig(size=(4, 4), depth_complexity=1, colours=f"hues-{count}"), index, 3)[:, :3]
    light = np.square(found / 255.0)
    hue = light / light.max(axis=1, keepdims=True)
    nearest = np.abs(hue[:, None] - colours.hues(count)).max(axis=-1)
    assert nearest.min(axis=1).max() < 0.05
    assert len(np.unique(nearest.argmin(axis=1))) == count
    assert math.isclose(float(colours.hues(count).max()), 1.0)
