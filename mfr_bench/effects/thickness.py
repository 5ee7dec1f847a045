"""Measures how much of a ray lies within at least one object; as shaders/effects/thickness.glsl."""

from __future__ import annotations

import numpy as np

from . import Settings
from .rays import Rays
from .word import fronts_of


def model(rays: Rays, settings: Settings) -> np.ndarray:
    """float64 (pixels, 4): grey is the length within objects, in window depth."""
    inside, before, length = (np.zeros(rays.counts.size) for _ in range(3))
    for pixels, depth, rgba in rays.ranks():
        length[pixels] += np.where(inside[pixels] > 0, depth - before[pixels], 0.0)
        inside[pixels] += np.where(fronts_of(rgba), 1, -1)
        before[pixels] = depth
    image = rays.image()
    image[:, :3], image[:, 3] = np.minimum(length, 1.0)[:, None], rays.counts > 0
    return image
