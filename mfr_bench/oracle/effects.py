"""The float64 answer to a scene whose effect is another than transparency."""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module

import numpy as np

from ..effects import Settings
from ..effects.rays import Rays
from . import foreign
from .composite import Fragments, in_chunks, taken
from .samples import open_pixels
from .ties import ANY, Answer


def answer_of_effect(fragments: Fragments, settings: Settings, layers: int | None = None,
                     criterion: str = "nearest") -> Answer:
    """The images that are right of an effect on every fragment, or on the best `layers` of each pixel.

    Equal depths leave a pixel open where the effect, or the choice of fragments, tells those of one depth apart.
    """
    flat, image = fragments.counts.ravel(), np.empty((fragments.counts.size, 4))
    model = model_of(settings)
    for pixels, part in in_chunks(flat):
        counts, payloads, depth = flat[pixels], fragments.payloads(part), fragments.depth[part]
        if layers is not None:
            chosen = taken(counts, payloads[:, 3], layers, criterion)
            payloads, depth, counts = payloads[chosen], depth[chosen], np.minimum(counts, layers)
        image[pixels] = model(Rays(counts, depth.view(np.float32).astype(np.float64), payloads), settings)
    image = image.reshape(*fragments.counts.shape, 4)
    unlike = _open_pixels(fragments, settings, layers, criterion)
    if not unlike.any():
        return Answer.only(image)
    return Answer(image, *(np.where(unlike[..., None], bound, image) for bound in (-ANY, ANY)))


def model_of(settings: Settings) -> Callable[[Rays, Settings], np.ndarray]:
    """The function that gives the right image of rays, float64 (pixels, 4)."""
    if settings.msaa == 1 and settings.effect.package:
        return foreign.image_of
    return import_module(f"..effects.{settings.module}", __package__).model


def _open_pixels(fragments: Fragments, settings: Settings, layers: int | None, criterion: str) -> np.ndarray:
    """bool (H, W): pixels that equal depths leave open."""
    if settings.msaa > 1:
        return open_pixels(fragments, settings, layers, criterion)
    if settings.effect.ordered or layers is not None:
        return _unlike_at_one_depth(fragments)
    return np.zeros(fragments.counts.shape, dtype=bool)


def _unlike_at_one_depth(fragments: Fragments) -> np.ndarray:
    """bool (H, W): pixels with two fragments of one depth whose payloads differ."""
    counts, pixel = fragments.counts.ravel(), fragments.of_pixels()
    rgba = fragments.scene.rgba[fragments.primitive]
    beside = (pixel[1:] == pixel[:-1]) & (fragments.depth[1:] == fragments.depth[:-1])
    found = np.zeros(counts.size, dtype=bool)
    found[pixel[1:][beside & (rgba[1:] != rgba[:-1]).any(axis=-1)]] = True
    return found.reshape(fragments.counts.shape)
