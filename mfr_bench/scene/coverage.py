"""About how primitives with corners cover the viewport, before a device has drawn them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .primitives import Cornered

GRID = 32  # cells along the longer side of the viewport, by which fragments are estimated


@dataclass(frozen=True)
class Estimate:
    """About how a scene covers the viewport. counts: pixels with 0, 1, 2, … fragments, the covered ones only."""

    primitives: int
    covered: int
    counts: tuple[float, ...]


def estimate_of(made: Cornered) -> Estimate:
    """The areas of the primitives, summed in the cells of a coarse grid by their boxes."""
    width, height = made.viewport
    cell = max(1, -(-max(width, height) // GRID))
    columns, rows = -(-width // cell), -(-height // cell)
    area = np.zeros((rows, columns))
    boxes, areas = made.boxes, _areas(made)
    for x in range(columns):
        wide = np.clip(np.minimum(boxes[:, 2], (x + 1) * cell) - np.maximum(boxes[:, 0], x * cell), 0, None)
        for y in range(rows) if wide.any() else ():
            high = np.clip(np.minimum(boxes[:, 3], (y + 1) * cell) - np.maximum(boxes[:, 1], y * cell), 0, None)
            area[y, x] = (areas * wide * high).sum()
    deep = area / cell**2
    pixels = np.minimum(1.0, deep) * cell**2  # covered ones of each cell
    layers = np.maximum(1, np.rint(deep)).astype(int)
    counts = np.bincount(layers.ravel(), weights=pixels.ravel(), minlength=2)
    return Estimate(len(made), max(1, min(width * height, round(pixels.sum()))), tuple(counts))


def _areas(made: Cornered) -> np.ndarray:
    """Area of each primitive on the screen over that of its box; 0 where a corner is behind the eye."""
    corners = made.position.astype(np.float64)
    before = (corners[..., 3] > 0).all(axis=1)
    window = corners[..., :2] / np.where(before[:, None], corners[..., 3], 1.0)[..., None] / 2 * made.viewport
    found = sum(_area(window[:, i:i + 3]) for i in range(made.triangles_each))
    boxes = np.maximum(1, (made.boxes[:, 2:] - made.boxes[:, :2]).prod(axis=1))
    return np.where(before, found, 0.0) / boxes


def _area(corners: np.ndarray) -> np.ndarray:
    """float64 (n,): areas of triangles (n, 3, 2)."""
    one, other = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    return np.abs(one[:, 0] * other[:, 1] - one[:, 1] * other[:, 0]) / 2
