"""The float64 answer to a scene whose effect is another than transparency."""

from __future__ import annotations

from importlib import import_module

import numpy as np

from ..effects import Settings
from ..effects.rays import Rays
from .composite import Fragments, in_chunks, taken
from .ties import ANY, Answer


def answer_of_effect(fragments: Fragments, settings: Settings, layers: int | None = None,
                     criterion: str = "nearest") -> Answer:
    """The images that are right of an effect on every fragment, or on the best `layers` of each pixel.

    Equal depths leave a pixel open where the effect, or the choice of fragments, tells those of one depth apart.
    """
    flat, rgba, image = fragments.counts.ravel(), fragments.scene.rgba, np.empty((fragments.counts.size, 4))
    model = import_module(f"..effects.{settings.name}", __package__).model
    for pixels, part in in_chunks(flat):
        counts, primitive, depth = flat[pixels], fragments.primitive[part], fragments.depth[part]
        if layers is not None:
            chosen = taken(counts, rgba[primitive, 3], layers, criterion)
            primitive, depth, counts = primitive[chosen], depth[chosen], np.minimum(counts, layers)
        image[pixels] = model(Rays(counts, depth.view(np.float32).astype(np.float64), rgba[primitive]), settings)
    image = image.reshape(*fragments.counts.shape, 4)
    if not settings.effect.ordered and layers is None:
        return Answer.only(image)
    unlike = _unlike_at_one_depth(fragments)
    if not unlike.any():
        return Answer.only(image)
    return Answer(image, *(np.where(unlike[..., None], bound, image) for bound in (-ANY, ANY)))


def _unlike_at_one_depth(fragments: Fragments) -> np.ndarray:
    """bool (H, W): pixels with two fragments of one depth whose payloads differ."""
    counts = fragments.counts.ravel()
    pixel = np.repeat(np.arange(counts.size), counts)
    rgba = fragments.scene.rgba[fragments.primitive]
    beside = (pixel[1:] == pixel[:-1]) & (fragments.depth[1:] == fragments.depth[:-1])
    found = np.zeros(counts.size, dtype=bool)
    found[pixel[1:][beside & (rgba[1:] != rgba[:-1]).any(axis=-1)]] = True
    return found.reshape(fragments.counts.shape)
