"""Constructive solid geometry: the first surface of a union, an intersection or a difference.

A is the object 0, B are all others together; as in shaders/effects/csg.glsl.
"""

from __future__ import annotations

import numpy as np

from . import Settings
from .rays import Rays
from .word import colours_of, inside_after


def model(rays: Rays, settings: Settings) -> np.ndarray:
    """float64 (pixels, 4): the colour of the face where a ray first enters the solid; transparent where none does."""
    inside, found = np.zeros(rays.counts.size, dtype=np.uint32), np.zeros(rays.counts.size, dtype=bool)
    image = rays.image()
    for pixels, _, rgba in rays.ranks():
        old = inside[pixels]
        new = inside_after(old, rgba)
        enters = ~found[pixels] & ~_within(old, settings.operation) & _within(new, settings.operation)
        image[pixels[enters], :3], image[pixels[enters], 3] = colours_of(rgba[enters]), 1.0
        found[pixels] |= enters
        inside[pixels] = new
    return image


def _within(objects: np.ndarray, operation: str) -> np.ndarray:
    """bool: whether a point inside these objects, as bits, is inside the solid."""
    a, b = (objects & 1) > 0, (objects & ~np.uint32(1)) > 0
    return {"union": a | b, "intersection": a & b, "difference": a & ~b}[operation]
