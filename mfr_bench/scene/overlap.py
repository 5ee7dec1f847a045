"""Bounds where a scene's primitives can be on the screen, and how many can meet in a pixel, found without drawing."""

from __future__ import annotations

import numpy as np

CELL = 8  # pixels, side of the squares in which rectangles are counted
DEPTH_MARGIN = 2.0**-20  # of the depth range, to spare for what a device rounds
MARGIN = 1  # pixels to spare for what a device rounds


def boxes_of(position: np.ndarray, viewport: tuple[int, int]) -> np.ndarray:
    """int32 (n, 4): the pixels of the viewport that bound each primitive, x0 y0 x1 y1, half-open, with MARGIN.

    position: (n, corners, 4), clip space. A primitive with a corner at or behind the eye has the whole viewport.
    """
    corners = position.astype(np.float64)
    behind = corners[..., 3].min(axis=1, initial=np.inf) <= 0
    corners[behind] = 1.0
    window = (corners[..., :2] / corners[..., 3:] + 1.0) / 2.0 * viewport
    edges = np.hstack([np.floor(window.min(axis=1)) - MARGIN, np.ceil(window.max(axis=1)) + MARGIN])
    boxes = np.clip(edges, 0, np.tile(viewport, 2)).astype(np.int32)
    return np.where(behind[:, None], np.array([0, 0, *viewport], dtype=np.int32), boxes)


def areas_of(position: np.ndarray, boxes: np.ndarray, viewport: tuple[int, int]) -> np.ndarray:
    """float64 (n,): pixels that each primitive covers, a triangle or a strip of two, by its area; its box at most.

    position: (n, 3 or 4, 4), clip space. boxes: those of `boxes_of`, which stand for what reaches behind the eye.
    """
    corners = position.astype(np.float64)
    most = (boxes[:, 2:] - boxes[:, :2]).clip(0).prod(axis=1, dtype=np.float64)
    behind = corners[..., 3].min(axis=1, initial=np.inf) <= 0
    corners[behind] = 1.0
    window = corners[..., :2] / corners[..., 3:] / 2.0 * viewport
    areas = np.zeros(len(corners))
    for a, b, c in ((0, 1, 2), (2, 1, 3))[:corners.shape[1] - 2]:
        along, across = window[:, b] - window[:, a], window[:, c] - window[:, a]
        areas += np.abs(along[:, 0] * across[:, 1] - along[:, 1] * across[:, 0]) / 2.0
    return np.where(behind, most, np.minimum(areas, most))


def bounds_of(boxes: np.ndarray) -> tuple[int, int, int, int]:
    """Left, bottom, width and height in pixels of the rectangle around all boxes; all 0 where there is none."""
    if not len(boxes):
        return 0, 0, 0, 0
    (left, bottom), (right, top) = boxes[:, :2].min(axis=0), boxes[:, 2:].max(axis=0)
    return int(left), int(bottom), int(right - left), int(top - bottom)


def depth_bounds_of(position: np.ndarray) -> tuple[float, float]:
    """Nearest and furthest window depth of the primitives' corners, in [0, 1], with a step to spare for rounding.

    position: (n, corners, 4), clip space. The whole range where there is no corner, or one at or behind the eye.
    """
    if not len(position) or position[..., 3].min() <= 0:
        return 0.0, 1.0
    depth = (position[..., 2].astype(np.float64) / position[..., 3] + 1.0) / 2.0
    return max(0.0, float(depth.min()) - DEPTH_MARGIN), min(1.0, float(depth.max()) + DEPTH_MARGIN)


def most_over(rects: np.ndarray, viewport: tuple[int, int]) -> int:
    """A bound on how many of the rectangles (int (n, 4), x0 y0 x1 y1, half-open, within the viewport) share a pixel.

    They are counted in squares of CELL pixels: two that meet in a square count twice though they may not overlap.
    """
    x0, y0, x1, y1 = rects[(rects[:, 2] > rects[:, 0]) & (rects[:, 3] > rects[:, 1])].T
    width, height = viewport
    steps = np.zeros((height // CELL + 2, width // CELL + 2), dtype=np.int64)
    left, bottom, right, top = x0 // CELL, y0 // CELL, (x1 - 1) // CELL + 1, (y1 - 1) // CELL + 1
    for y, x, step in ((bottom, left, 1), (bottom, right, -1), (top, left, -1), (top, right, 1)):
        np.add.at(steps, (y, x), step)
    return int(steps.cumsum(axis=0).cumsum(axis=1).max())
