"""Finds where the insides of two or more objects overlap along a ray; as shaders/effects/collision.glsl."""

from __future__ import annotations

import numpy as np

from . import Settings
from .numbers import GREY, MOST_SHOWN
from .rays import Rays
from .word import inside_after


def model(rays: Rays, settings: Settings) -> np.ndarray:
    """float64 (pixels, 4): where objects overlap, red is 1, green the length of depth in which they do, blue the
    number of intervals in sixteenths; elsewhere grey. Opacity is 1 where there is any fragment.
    """
    inside = np.zeros(rays.counts.size, dtype=np.uint32)
    began, length = (np.zeros(rays.counts.size) for _ in range(2))
    intervals = np.zeros(rays.counts.size, dtype=np.int64)
    for pixels, depth, rgba in rays.ranks():
        old = inside[pixels]
        new = inside_after(old, rgba)
        before, now = _several(old), _several(new)
        ends = before & ~now & (depth > began[pixels])
        length[pixels] += np.where(ends, depth - began[pixels], 0.0)
        intervals[pixels] += ends
        began[pixels] = np.where(now & ~before, depth, began[pixels])
        inside[pixels] = new
    image = rays.image()
    shown = np.minimum(intervals, MOST_SHOWN) / MOST_SHOWN
    found = np.stack([np.ones_like(length), np.minimum(length, 1.0), shown], axis=-1)
    image[:, :3] = np.where((intervals > 0)[:, None], found, GREY * (rays.counts > 0)[:, None])
    image[:, 3] = rays.counts > 0
    return image


def _several(objects: np.ndarray) -> np.ndarray:
    """bool: whether more than one bit is set."""
    return (objects & (objects - np.uint32(1))) > 0
