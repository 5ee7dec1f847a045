"""The n-th layer alone, or with layer 0 all of them as an x-ray shows them; as shaders/effects/layers.glsl."""

from __future__ import annotations

import numpy as np

from . import Settings
from .numbers import LET_THROUGH
from .rays import Rays


def model(rays: Rays, settings: Settings) -> np.ndarray:
    """float64 (pixels, 4), premultiplied: the fragment of the layer, or the share of the light that all take."""
    image = rays.image()
    if not settings.layer:
        image[:, :3], image[:, 3] = (1.0 - LET_THROUGH ** rays.counts)[:, None], rays.counts > 0
        return image
    for rank, (pixels, _, rgba) in enumerate(rays.ranks(), start=1):
        if rank == settings.layer:
            image[pixels, :3], image[pixels, 3] = rgba[:, :3] / 255.0, 1.0
    return image
