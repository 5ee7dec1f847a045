"""The middle fragment of a pixel, the nearer one of two; as shaders/effects/median.glsl."""

from __future__ import annotations

import numpy as np

from mfr_bench.effects import Case, Effect, Settings
from mfr_bench.effects.rays import Rays

FRAGMENTS = ((0.2, (255, 0, 0, 128)), (0.4, (0, 255, 0, 64)), (0.5, (0, 0, 255, 128)))
EFFECT = Effect("the middle fragment of a pixel alone, opaque; of an even number the nearer of the two", ordered=True,
                cases=(Case(FRAGMENTS, shows=(0.0, 1.0, 0.0, 1.0)), Case(FRAGMENTS[:2], shows=(1.0, 0.0, 0.0, 1.0))))


def model(rays: Rays, settings: Settings) -> np.ndarray:
    """float64 (pixels, 4), premultiplied: the middle fragment, and nothing where a pixel has none."""
    image, covered = rays.image(), rays.counts > 0
    first = np.cumsum(rays.counts) - rays.counts  # of each pixel's fragments, nearest first
    middle = (first + (rays.counts - 1) // 2)[covered]
    image[covered, :3], image[covered, 3] = rays.rgba[middle, :3] / 255.0, 1.0
    return image
