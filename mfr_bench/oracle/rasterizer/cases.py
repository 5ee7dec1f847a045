"""Small scenes of triangles that rasterizers find hard, drawn by chance with a fixed seed."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np

from ...scene.meshes.view import DEPTH_RANGES, DIRECTIONS, axes_of, perspective_camera
from ...scene.triangles import Triangles

SIZE = (64, 64)  # pixels; a power of two, so that corners on a grid are exact in clip space
COUNT = 60  # triangles of a case
GRID_BITS = 4  # of a grid that every device has, the least GL_SUBPIXEL_BITS


def of_corners(corners: np.ndarray, depth: np.ndarray) -> Triangles:
    """Triangles (n, 3, 2) in pixels of SIZE with depths (n, 3) of normalized device coordinates."""
    position = np.ones((len(corners), 3, 4))
    position[..., :2] = corners / np.array(SIZE) * 2.0 - 1.0
    position[..., 2] = depth
    return of_clip(position)


def of_clip(position: np.ndarray) -> Triangles:
    """Triangles (n, 3, 4) in clip space, with colours that nothing asks for."""
    count = len(position)
    return Triangles(SIZE, np.ascontiguousarray(position, np.float32), np.full((count, 4), 128, np.uint8), 1.0, 1,
                     np.arange(count, dtype=np.int32))


def _depths(chance: np.random.Generator) -> np.ndarray:
    return chance.uniform(-0.9, 0.9, (COUNT, 3))


def on_grid() -> Triangles:
    """Corners in the viewport on the coarsest grid, half of the triangles with edges through middles of pixels."""
    chance = np.random.default_rng(1)
    corners = chance.integers(0, SIZE[0] << GRID_BITS, (COUNT, 3, 2)) / (1 << GRID_BITS)
    corners[::2] = np.floor(corners[::2]) + 0.5
    corners[::4, 1, 1], corners[2::4, 1, 0] = corners[::4, 0, 1], corners[2::4, 0, 0]  # level and upright edges
    return of_corners(corners, _depths(chance))


def shared() -> Triangles:
    """A sheet of triangles without gaps over the viewport and beyond, on grid lines, middles and anywhere."""
    chance = np.random.default_rng(2)
    lines = np.arange(-12.0, SIZE[0] + 13.0, 4.0) + 0.5
    points = np.stack(np.meshgrid(lines, lines), axis=-1)
    moves = chance.uniform(-1.4, 1.4, points.shape)
    moves[::2] = np.rint(moves[::2])
    points += moves
    a, b, c, d = points[:-1, :-1], points[:-1, 1:], points[1:, 1:], points[1:, :-1]
    corners = np.concatenate([np.stack(t, axis=-2).reshape(-1, 3, 2) for t in ((a, b, c), (a, c, d))])
    return of_corners(corners, np.zeros(corners.shape[:2]))


def slivers() -> Triangles:
    """Long triangles a twentieth of a pixel wide."""
    chance = np.random.default_rng(3)
    start, along = chance.uniform(0, SIZE[0], (COUNT, 2)), chance.uniform(-40, 40, (COUNT, 2))
    third = start + 0.5 * along + chance.uniform(-0.05, 0.05, (COUNT, 2))
    return of_corners(np.stack([start, start + along, third], axis=1), _depths(chance))


def tiny() -> Triangles:
    """Triangles below a pixel."""
    chance = np.random.default_rng(4)
    return of_corners(chance.uniform(0, SIZE[0], (COUNT, 1, 2)) + chance.uniform(-0.6, 0.6, (COUNT, 3, 2)),
                      _depths(chance))


def huge() -> Triangles:
    """Triangles whose corners lie up to a million pixels away."""
    chance = np.random.default_rng(5)
    reach = 10.0 ** chance.uniform(2, 6, (COUNT, 1, 1))
    return of_corners(reach * chance.uniform(-1, 1, (COUNT, 3, 2)), _depths(chance))


def before_the_eye(depth_range: str = "whole") -> Triangles:
    """Triangles around the eye in perspective: the near plane cuts many of them, some reach behind the eye."""
    chance = np.random.default_rng(6)
    corners = chance.uniform(-1, 1, (COUNT, 1, 3)) + chance.uniform(-0.8, 0.8, (COUNT, 3, 3))
    camera = perspective_camera(corners, SIZE, axes_of(DIRECTIONS["-z"]), (0.1, 0.1, 0.3), 60.0)
    return of_clip(replace(camera, depths=DEPTH_RANGES[depth_range]).clip(corners))


CASES: Mapping[str, Callable[[], Triangles]] = {
    "corners on the grid": on_grid, "shared edges": shared, "slivers": slivers, "tiny triangles": tiny,
    "huge triangles": huge, "triangles around the eye": before_the_eye,
}
