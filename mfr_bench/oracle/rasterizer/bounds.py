"""Which fragments a rasterizer must, may and must not make of triangles, and between which depths each lies.

A device moves the corners of a triangle: it rounds them to float32 and snaps them to its grid. Let none move by more
than d along either axis. Then the boundary moves by at most d·√2, so a middle of a pixel further inside is certain,
and one further outside impossible. With g the gradient of the depth in the window, the depth there moves by at most
(|g_x| + |g_y|)·d, since it is a mean of the corners' depths, and their roundings come on top.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...scene.triangles import Triangles
from .clipping import Polygons, polygons

UNIT = 2.0**-24  # unit roundoff of float32
ROUNDINGS = 8  # of a coordinate or a depth on a device: a division, the viewport, the interpolation


@dataclass(frozen=True)
class Bounds:
    """The possible fragments of a scene, one for each triangle and pixel, sorted by both.

    primitive, pixel: int64 (c,). inside: float64 (c,), how far the middle of the pixel lies within the triangle, in
    pixels; below 0 outside. certain: bool (c,). depth, low, high: float64 (c,), window depths. d: float64 (n,), by how
    many pixels a device may move the corners of each triangle.
    """

    scene: Triangles
    primitive: np.ndarray
    pixel: np.ndarray
    inside: np.ndarray
    certain: np.ndarray
    depth: np.ndarray
    low: np.ndarray
    high: np.ndarray
    d: np.ndarray


def bounds(scene: Triangles, subpixel_bits: int) -> Bounds:
    """The bounds of a device with a grid of 2^-subpixel_bits pixels (GL_SUBPIXEL_BITS)."""
    shape = polygons(scene)
    moved = 2.0**-subpixel_bits + ROUNDINGS * UNIT * np.maximum(shape.reach, max(scene.viewport))
    primitive, x, y = _candidates(scene, shape, moved)
    inside = np.empty(len(primitive))
    for part in _parts(len(primitive)):
        inside[part] = _inside(shape.corners[primitive[part]], np.stack([x[part], y[part]], axis=-1) + 0.5)
    near = inside >= -np.sqrt(2.0) * moved[primitive]
    primitive, x, y, inside = primitive[near], x[near], y[near], inside[near]
    depth, off = _depths(scene, primitive, x + 0.5, y + 0.5, moved[primitive])
    return Bounds(scene, primitive, y * scene.viewport[0] + x, inside, inside > np.sqrt(2.0) * moved[primitive], depth,
                  np.clip(depth - off, 0.0, 1.0), np.clip(depth + off, 0.0, 1.0), moved)


def _candidates(scene: Triangles, shape: Polygons, moved: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Triangle, column and row of each pixel whose middle lies in the box of a triangle, with room for its moves."""
    room = 1.0 + 2.0 * moved[:, None]
    low = np.clip(np.floor(shape.corners.min(axis=1) - room), 0, scene.viewport).astype(np.int64)
    high = np.clip(np.ceil(shape.corners.max(axis=1) + room), 0, scene.viewport).astype(np.int64)
    sides = np.where(shape.empty[:, None], 0, high - low)
    area = sides.prod(axis=1)
    primitive = np.repeat(np.arange(len(area)), area)
    at = np.arange(len(primitive)) - np.repeat(np.cumsum(area) - area, area)
    row, column = np.divmod(at, np.maximum(sides[:, 0], 1)[primitive])
    return primitive, low[primitive, 0] + column, low[primitive, 1] + row


def _parts(count: int, room: int = 2**15) -> list[slice]:
    return [slice(start, start + room) for start in range(0, count, room)]


def _inside(corners: np.ndarray, point: np.ndarray) -> np.ndarray:
    """float64 (c,): distances of points (c, 2) from the boundaries of convex polygons (c, m, 2), negative outside."""
    edge = np.roll(corners, -1, axis=1) - corners
    offset = point[:, None] - corners
    length = (edge**2).sum(axis=-1)
    along = np.clip((edge * offset).sum(axis=-1) / np.where(length > 0, length, 1.0), 0.0, 1.0)
    distance = np.sqrt(((offset - along[..., None] * edge)**2).sum(axis=-1)).min(axis=1)
    side = edge[..., 0] * offset[..., 1] - edge[..., 1] * offset[..., 0]
    within = ((side >= 0).all(axis=1) | (side <= 0).all(axis=1)) & (side != 0).any(axis=1)
    return np.where(within, distance, -distance)


def _depths(scene: Triangles, primitive: np.ndarray, x: np.ndarray, y: np.ndarray,
            moved: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Window depths at points of the window, and by how much a device may be off."""
    width, height = scene.viewport
    plane, lost = (values[primitive] for values in _planes(scene))
    depth = plane[:, 0] * (2.0 * x / width - 1.0) + plane[:, 1] * (2.0 * y / height - 1.0) + plane[:, 2]
    slope = np.abs(plane[:, 0]) * 2.0 / width + np.abs(plane[:, 1]) * 2.0 / height  # per pixel
    rounded = ROUNDINGS * UNIT * (1.0 + slope * max(width, height) * lost)
    return depth, slope * moved + rounded


def _planes(scene: Triangles) -> tuple[np.ndarray, np.ndarray]:
    """The window depth of each triangle as a function of x/w, y/w and 1, float64 (n, 3), by Cramer's rule.

    The second array is how often larger than the area of the triangle the products are whose difference it is: so many
    roundings lie in a gradient that is computed from it. An edge-on triangle has a depth of its own, and no gradient.
    """
    clip = scene.position.astype(np.float64)
    xyw = clip[..., (0, 1, 3)]
    others = np.stack([np.cross(xyw[:, 1], xyw[:, 2]), np.cross(xyw[:, 2], xyw[:, 0]),
                       np.cross(xyw[:, 0], xyw[:, 1])], axis=1)
    volume = (xyw[:, 0] * others[:, 0]).sum(axis=-1)
    flat = volume == 0
    z = clip[..., 2] if scene.geometry == "reversed" else (clip[..., 2] + clip[..., 3]) / 2.0
    plane = (z[..., None] * others).sum(axis=1) / np.where(flat, 1.0, volume)[:, None]
    plane[flat] = [0.0, 0.0, 0.5]
    products = np.abs(xyw[:, 0]) * (np.abs(np.roll(xyw[:, 1], 1, axis=-1) * np.roll(xyw[:, 2], -1, axis=-1))
                                    + np.abs(np.roll(xyw[:, 1], -1, axis=-1) * np.roll(xyw[:, 2], 1, axis=-1)))
    lost = products.sum(axis=-1) / np.where(flat, 1.0, np.abs(volume))
    lost[flat] = 1.0 / UNIT
    return plane, lost
