"""A device draws slanted primitives as their corners say: the oracle sorts the device's own fragments, so
that a wrong vertex shader would be wrong in both."""

from dataclasses import replace

import numpy as np
import pytest

from mfr_bench import glsl
from mfr_bench.config.model import Scene as SceneConfig
from mfr_bench.gpu import scene_buffer as scene_buffers
from mfr_bench.gpu.capture import capture
from mfr_bench.gpu.scene_buffer import LAYOUTS
from mfr_bench.gpu.single import shown
from mfr_bench.hashing import hash3
from mfr_bench.scene import generate

EDGE = 0.02  # pixels: nearer to an edge than this a device may round either way
DEPTH = 3e-7  # what is left of float32 where an edge crosses all of a depth range of a half

SCENES = {
    "hairball": SceneConfig(kind="hairball", size=(32, 24), depth_complexity=6, mean_depth=3),
    "needles": SceneConfig(kind="needles", size=(32, 24), depth_complexity=6, seed=3),
    "temple": SceneConfig(kind="temple", size=(32, 24), depth_complexity=6, mean_depth=3),
    "slanted": SceneConfig(size=(32, 24), depth_complexity=6, layout="random", slant=0.8, quad_size=(11, 9)),
    "rejecting": SceneConfig(size=(32, 24), depth_complexity=6, slant=0.8, fragment_probability=0.5),
}


def on_screen(scene):
    """float64 (n, 4, 3): corners in pixels and window depth."""
    position = scene.position.astype(np.float64)
    ndc = position[..., :3] / position[..., 3:]
    return np.concatenate([(ndc[..., :2] + 1) / 2 * np.array(scene.viewport), ndc[..., 2:] / 2 + 0.5], axis=-1)


def weights(triangle, x, y):
    """Barycentric weights (3, H, W) of the pixels' middles, and their distance from the nearest edge, negative outside.

    None for a triangle without area.
    """
    found, inside = [], []
    for i in range(3):
        (ax, ay, _), (bx, by, _), (cx, cy, _) = (triangle[(i + step) % 3] for step in (1, 2, 0))
        doubled = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
        length = np.hypot(bx - ax, by - ay)
        if abs(doubled) < 1e-9 or length < 1e-9:
            return None
        cross = (bx - ax) * (y - ay) - (by - ay) * (x - ax)
        found.append(cross / doubled)
        inside.append(cross * np.sign(doubled) / length)
    return np.array(found), np.minimum.reduce(inside)


def assert_made_of_its_corners(device, config):
    scene = generate(config)
    width, height = scene.viewport
    with shown(device, scene) as on:
        found = capture(device, on.scene_buffer, on.canvas)
    pixel = np.repeat(np.arange(width * height), found.counts.ravel())
    depth_of = {(int(p), int(i)): float(d) for p, i, d in zip(pixel, found.primitive, found.depth.view(np.float32),
                                                             strict=True)}
    y, x = np.mgrid[0:height, 0:width] + 0.5
    checked = 0
    for index, corners in enumerate(on_screen(scene)):
        triangles = [w for w in (weights(corners[[0, 1, 2]], x, y), weights(corners[[1, 3, 2]], x, y)) if w]
        near = np.min([np.abs(edge) for _, edge in triangles], axis=0) if triangles else np.full(x.shape, np.inf)
        covers = np.zeros(x.shape, dtype=bool)
        for part, (inner, edge) in zip(([0, 1, 2], [1, 3, 2]), triangles, strict=False):
            covers |= edge > 0
            if len(triangles) == 2:
                expected = np.tensordot(corners[part][:, 2], inner, 1)
                for p in np.flatnonzero((edge > EDGE) & (near > EDGE)):
                    if (p, index) in depth_of:
                        assert abs(depth_of[p, index] - expected.ravel()[p]) < DEPTH
                        checked += 1
        for p in np.flatnonzero(near > EDGE):
            kept = hash3(int(p), index, scene.seed) < scene.keep_threshold
            assert ((int(p), index) in depth_of) == (bool(covers.ravel()[p]) and kept)
    assert checked > 300


@pytest.mark.parametrize("name", SCENES)
def test_fragments_lie_where_the_corners_say(device, name):
    assert_made_of_its_corners(device, SCENES[name])


@pytest.mark.parametrize(("right", "wrong"), [
    ("gl_Position = in_corner", "gl_Position = in_corner + vec4(0, 0, (gl_VertexID & 3) == 2 ? 1e-5 : 0.0, 0)"),
    ("uint(gl_VertexID) / 4u", "uint(gl_VertexID) / 4u ^ 1u"), ("uint(gl_VertexID) / 4u", "uint(gl_VertexID) / 8u")])
def test_a_wrong_vertex_shader_is_seen(device, monkeypatch, right, wrong):
    original = glsl.read
    assert right in original("scene/strip.vert")
    monkeypatch.setattr(glsl.includes, "read", lambda path: original(path).replace(right, wrong)
                        if path == "scene/strip.vert" else original(path))
    with pytest.raises(AssertionError):
        assert_made_of_its_corners(device, SCENES["slanted"])


@pytest.mark.parametrize("indices", [(0, 1, 2, 2, 1, 1), (0, 1, 2, 0, 1, 3), (0, 1, 3, 2, 1, 3)])
def test_wrong_indices_are_seen(device, monkeypatch, indices):
    monkeypatch.setattr(scene_buffers, "LAYOUTS", LAYOUTS | {"strip": replace(LAYOUTS["strip"], indices=indices)})
    with pytest.raises(AssertionError):
        assert_made_of_its_corners(device, SCENES["slanted"])


def test_a_longer_scene_that_follows_is_drawn_to_its_end(device):
    """The buffer of indices grows with the number of strips."""
    few, many = (generate(replace(SCENES["slanted"], depth_complexity=count)) for count in (2, 9))
    with shown(device, few) as on:
        on.scene_buffer.replace(many)
        found = capture(device, on.scene_buffer, on.canvas)
    assert set(found.primitive) == set(range(len(many)))
