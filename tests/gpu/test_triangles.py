"""Triangles of meshes: every pixel that a float64 rasterizer covers, opaque ones in front of what they hide."""

from dataclasses import replace

import numpy as np
import pytest

from mfr_bench.config import load
from mfr_bench.gpu.capture import capture
from mfr_bench.gpu.single import shown
from mfr_bench.gpu.trial_triangles import fragments
from mfr_bench.methods import catalog
from mfr_bench.oracle.rasterizer.cases import CASES
from mfr_bench.oracle.rasterizer.deviation import deviation
from mfr_bench.plan import expand
from mfr_bench.scene import generate
from mfr_bench.scene.kinds.mesh import View
from mfr_bench.scene.meshes.view import DIRECTIONS, axes_of, orthographic_camera, perspective_camera
from mfr_bench.scene.triangles import Triangles
from mfr_bench.store.status import EXACT_ERROR

SIZE = (64, 48)


def soup(count: int, seed: int, perspective: bool = False) -> Triangles:
    """Random triangles in a box, seen along -z."""
    numbers = np.random.default_rng(seed)
    corners = numbers.uniform(-1, 1, (count, 1, 3)) + numbers.uniform(-0.5, 0.5, (count, 3, 3))
    place = perspective_camera if perspective else orthographic_camera
    clip = place(corners, SIZE, axes_of(DIRECTIONS["-z"])).clip(corners).astype(np.float32)
    rgba = numbers.integers(20, 250, (count, 4), dtype=np.uint8)
    return Triangles(SIZE, clip, rgba, 1.0, 1, np.arange(count, dtype=np.int32))


def rasterized(scene: Triangles) -> tuple[np.ndarray, np.ndarray]:
    """Window depths float64 (n, H, W), NaN where a triangle does not cover the middle of a pixel.

    The second array says how far inside of all edges that middle lies, in pixels.
    """
    width, height = scene.viewport
    corners = scene.position.astype(np.float64)
    window = (corners[..., :3] / corners[..., 3:] + 1) / 2 * [width, height, 1]
    x, y = np.meshgrid(np.arange(width) + 0.5, np.arange(height) + 0.5)
    depths, inside = (np.full((len(scene), height, width), np.nan) for _ in range(2))
    for i, (a, b, c) in enumerate(window):
        area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
        if area == 0:
            continue
        edges = [((q[0] - p[0]) * (y - p[1]) - (q[1] - p[1]) * (x - p[0])) / area for p, q in ((b, c), (c, a), (a, b))]
        lengths = [np.hypot(*(q - p)[:2]) for p, q in ((b, c), (c, a), (a, b))]
        inside[i] = np.min([e * abs(area) / length for e, length in zip(edges, lengths, strict=True)], axis=0)
        depths[i] = sum(e * corner[2] for e, corner in zip(edges, (a, b, c), strict=True))
    depths[inside < 0] = np.nan
    return depths, inside


@pytest.mark.parametrize("perspective", [False, True])
def test_fragments_are_those_of_a_rasterizer_in_float64(device, perspective):
    """But for pixels whose middle lies within 1/256 of an edge, where fixed-point coverage may differ."""
    scene = soup(60, 3, perspective)
    with shown(device, scene) as on:
        found = capture(device, on.scene_buffer, on.canvas)
    depths, inside = rasterized(scene)
    close = (np.abs(inside) < 1 / 128).any(axis=0)
    expected = np.isfinite(depths).sum(axis=0)
    assert close.mean() < 0.2
    assert (found.counts == expected)[~close].all()
    starts = np.cumsum(found.counts.ravel()) - found.counts.ravel()
    errors = []
    for y, x in zip(*np.nonzero(~close & (expected > 0)), strict=True):
        first, count = starts[y * SIZE[0] + x], found.counts[y, x]
        drawn = np.sort(depths[:, y, x][np.isfinite(depths[:, y, x])])
        errors.append(np.abs(found.depth[first:first + count].view(np.float32) - drawn).max())
    assert max(errors) < 2e-6


@pytest.mark.parametrize("case", CASES)
def test_hard_triangles_are_within_the_bounds_of_the_independent_rasterizer(device, case):
    off = deviation(fragments(device, CASES[case]()), device.subpixel_bits)
    assert off.within and off.fragments > 0, off


@pytest.mark.parametrize("depth_range", ["half", "whole", "reversed"])
@pytest.mark.parametrize("view", ["perspective", "orthographic"])
def test_the_mesh_of_the_package_is_within_bounds(device, view, depth_range):
    scene = expand(load("meshes", catalog(), "smoke")[0], catalog())[0].scene
    seen = View(direction="+x") if view == "orthographic" else scene.view
    off = deviation(fragments(device, generate(replace(scene, opaque="store", view=seen, depth_range=depth_range))),
                    device.subpixel_bits)
    assert off.within and off.fragments > 1000, off


METHODS = ["ab-array", "ab-ll", "ab-sb", "peel-f2b", "peel-dual", "kplus-array", "kb-mdt32", "adaptive", "lin-post",
           "ab-precalc", "peel-bucket", "open-post"]


def variant_of(method: str, k: int):
    declared = catalog()[method]
    wide = {"atomic64": "emulated"} if declared.param("atomic64") else {}
    return declared.variant(({"k": k} if declared.param("k") else {}) | wide)


@pytest.mark.parametrize("perspective", [False, True])
@pytest.mark.parametrize("method", METHODS)
def test_methods_are_exact_on_triangles(device, method, perspective):
    scene = soup(60, 3, perspective)
    with shown(device, scene) as on:
        variant = variant_of(method, on.stats.n)
        errors = on.errors(variant, on.render(variant))
    assert errors["max_abs_error"] <= EXACT_ERROR and errors["tied_pixels"] == 0


def behind_a_wall(scene: Triangles, depth: float) -> Triangles:
    """The scene with an opaque rectangle of this clip depth over the left half."""
    left, right = -1.0, 0.0
    wall = np.array([[[left, -1, depth, 1], [right, -1, depth, 1], [right, 1, depth, 1]],
                     [[left, -1, depth, 1], [right, 1, depth, 1], [left, 1, depth, 1]]], np.float32)
    return replace(scene, opaque=wall)


@pytest.mark.parametrize("method", [*METHODS, "wboit", "zbuffer"])
def test_what_is_behind_something_opaque_never_counts(device, method):
    scene = behind_a_wall(soup(60, 5), 0.5)
    with shown(device, scene) as on:
        variant = variant_of(method, on.stats.n)
        image = on.render(variant)
        errors = on.errors(variant, image)
        found = capture(device, on.scene_buffer, on.canvas)
    depths, inside = rasterized(scene)
    with np.errstate(invalid="ignore"):
        expected = np.isfinite(np.where(depths < 0.75, depths, np.nan)).sum(axis=0)
    clear = ~(np.abs(inside) < 1 / 128).any(axis=0)
    half = SIZE[0] // 2
    assert (found.counts[:, :half] == expected[:, :half])[clear[:, :half]].all()
    assert (found.counts[:, half:] == np.isfinite(depths).sum(axis=0)[:, half:])[clear[:, half:]].all()
    assert 0 < expected[:, :half].sum() < np.isfinite(depths)[..., :half].sum()
    if method != "wboit":
        assert errors["max_abs_error"] <= EXACT_ERROR


def test_opaque_triangles_move_with_an_animation(device):
    near, far = behind_a_wall(soup(60, 5), -0.9), behind_a_wall(soup(60, 5), 0.99)
    with shown(device, far) as on:
        before = int(capture(device, on.scene_buffer, on.canvas).counts.sum())
        on.scene_buffer.replace(near)
        after = int(capture(device, on.scene_buffer, on.canvas).counts.sum())
    assert after < before


def test_the_arrays_are_in_pixels_and_window_depth():
    scene = soup(4, 1)
    arrays = scene.arrays()
    assert {name: (array.dtype.str, array.shape) for name, array in arrays.items()} == {
        "position": ("<f4", (4, 3, 3)), "rgba": ("|u1", (4, 4)), "object": ("<i4", (4,))}
    assert (arrays["position"][..., :2].max(axis=(0, 1)) <= SIZE).all() and (arrays["position"][..., 2] >= 0.5).all()
