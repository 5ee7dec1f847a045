"""White light from behind, after what closed objects absorb of it; as shaders/effects/translucency.glsl.

Along a length d within an object of colour c and opacity a, a channel is multiplied by exp(-absorption·a·(1 - c)·d):
the law of Beer and Lambert. Where objects overlap, each absorbs.
"""

from __future__ import annotations

import numpy as np

from . import Settings
from .rays import Rays
from .word import colours_of, fronts_of


def model(rays: Rays, settings: Settings) -> np.ndarray:
    """float64 (pixels, 4): the light that is left, opacity 1 where there is any fragment."""
    medium, optical = (np.zeros((rays.counts.size, 3)) for _ in range(2))
    before = np.zeros(rays.counts.size)
    for pixels, depth, rgba in rays.ranks():
        optical[pixels] += np.maximum(medium[pixels], 0.0) * (depth - before[pixels])[:, None]
        of_face = settings.absorption * (rgba[:, 3:] / 255.0) * (1.0 - colours_of(rgba))
        medium[pixels] += np.where(fronts_of(rgba)[:, None], of_face, -of_face)
        before[pixels] = depth
    image = rays.image()
    image[:, :3], image[:, 3] = np.exp(-optical) * (rays.counts > 0)[:, None], rays.counts > 0
    return image
