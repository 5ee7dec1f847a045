"""Exact coverage of triangles whose corners lie on a device's grid: edge functions in whole numbers.

GL leaves open which of two triangles takes a middle of a pixel on their shared edge; it asks that one of them does,
alone. Devices take it by the sides on which the edge lies: each of RULES names those that belong to a triangle.
"""

from __future__ import annotations

import numpy as np

from ...errors import MfrError
from ...scene.triangles import Triangles
from .clipping import window

RULES = ("top-left", "top-right", "bottom-left", "bottom-right")
MOST_PIXELS = 2**15  # of a coordinate, at which products of differences still are int64


class OffGridError(MfrError):
    """A corner that does not lie on the grid, or too far outside."""


def covered(scene: Triangles, rule: str, subpixel_bits: int) -> np.ndarray:
    """int64 (f,): triangle · pixels + pixel of every fragment, ascending.

    Raises OffGridError for corners that are not whole multiples of 2^-subpixel_bits pixels within MOST_PIXELS.
    """
    width, height = scene.viewport
    unit = 1 << subpixel_bits
    exact = window(scene, scene.position.astype(np.float64)) * unit
    corners = np.rint(exact).astype(np.int64)
    if (corners != exact).any() or np.abs(exact).max(initial=0) > MOST_PIXELS * unit:
        raise OffGridError(f"corners off the grid of {unit} steps a pixel, or over {MOST_PIXELS} pixels away")
    x, y = np.meshgrid(np.arange(width, dtype=np.int64), np.arange(height, dtype=np.int64))
    middle = np.stack([x, y], axis=-1).reshape(-1, 2) * unit + unit // 2
    found = [i * width * height + np.flatnonzero(_covers(triangle, middle, rule))
             for i, triangle in enumerate(corners)]
    return np.concatenate([np.empty(0, np.int64), *found])


def _covers(corners: np.ndarray, middle: np.ndarray, rule: str) -> np.ndarray:
    """bool (pixels,): whether a triangle (3, 2) of whole numbers covers points (pixels, 2)."""
    (ax, ay), (bx, by), (cx, cy) = corners.tolist()
    area = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
    if area == 0:
        return np.zeros(len(middle), dtype=bool)
    within = np.ones(len(middle), dtype=bool)
    ring = corners if area > 0 else corners[::-1]  # counter-clockwise
    for start, end in zip(ring, np.roll(ring, -1, axis=0), strict=True):
        dx, dy = (end - start).tolist()
        edge = dx * (middle[:, 1] - start[1]) - dy * (middle[:, 0] - start[0])
        within &= edge >= 0 if _belongs(dx, dy, rule) else edge > 0
    return within


def _belongs(dx: int, dy: int, rule: str) -> bool:
    """Whether an edge of a counter-clockwise triangle is among those of a rule. It has its triangle to its left."""
    vertical, horizontal = rule.split("-")
    if dy == 0:
        return dx < 0 if vertical == "top" else dx > 0
    return dy < 0 if horizontal == "left" else dy > 0
