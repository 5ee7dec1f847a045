"""How many of a scene's primitives can meet in a pixel, as the host finds it without drawing."""

from __future__ import annotations

import numpy as np

CELL = 8  # pixels, side of the squares in which rectangles are counted


def most_over(rects: np.ndarray, viewport: tuple[int, int]) -> int:
    """No pixel lies in more of the rectangles, which are int (n, 4), x0 y0 x1 y1, half-open, within the viewport.

    They are counted in squares of CELL pixels: two that meet in a square count twice though they may not overlap.
    """
    x0, y0, x1, y1 = rects[(rects[:, 2] > rects[:, 0]) & (rects[:, 3] > rects[:, 1])].T
    width, height = viewport
    steps = np.zeros((height // CELL + 2, width // CELL + 2), dtype=np.int64)
    left, bottom, right, top = x0 // CELL, y0 // CELL, (x1 - 1) // CELL + 1, (y1 - 1) // CELL + 1
    for y, x, step in ((bottom, left, 1), (bottom, right, -1), (top, left, -1), (top, right, 1)):
        np.add.at(steps, (y, x), step)
    return int(steps.cumsum(axis=0).cumsum(axis=1).max())
