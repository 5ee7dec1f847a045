"""Fragments that share their depth with others of their pixel; as shaders/effects/coplanar.glsl."""

from __future__ import annotations

import numpy as np

from . import Settings
from .numbers import MOST_SHOWN
from .rays import Rays


def model(rays: Rays, settings: Settings) -> np.ndarray:
    """float64 (pixels, 4): red is the share of the pixel's fragments that share a depth, green the largest group
    in sixteenths, opacity 1 where there is any fragment.
    """
    size, shared, largest = (np.zeros(rays.counts.size, dtype=np.int64) for _ in range(3))
    before = np.full(rays.counts.size, -1.0)
    for pixels, depth, _ in rays.ranks():
        again = depth == before[pixels]
        size[pixels] = np.where(again, size[pixels] + 1, 1)
        shared[pixels] += np.where(again, np.where(size[pixels] == 2, 2, 1), 0)
        largest[pixels] = np.maximum(largest[pixels], np.where(again, size[pixels], 0))
        before[pixels] = depth
    image = rays.image()
    image[:, 0] = shared / np.maximum(rays.counts, 1)
    image[:, 1] = np.minimum(largest, MOST_SHOWN) / MOST_SHOWN
    image[:, 3] = rays.counts > 0
    return image
