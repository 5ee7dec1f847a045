"""Samples of a pixel: the words of fragments with coverage masks, and what is made of the samples that they cover.

`numbers` has the layout of the word; shaders/effects/coverage.glsl reads the same.
"""

from __future__ import annotations

import numpy as np

from . import Settings
from .numbers import MASK_BITS, SHADE_BITS, SHADES
from .rays import Rays
from .word import words

ALL_SAMPLES = (1 << MASK_BITS) - 1
CHANNEL_BITS = tuple(MASK_BITS + SHADE_BITS * channel for channel in range(4))  # of red, green, blue, opacity
MASK_BYTE = 0  # of a word's four bytes, the lowest first


def packed(rgba: np.ndarray, masks: np.ndarray | int = ALL_SAMPLES) -> np.ndarray:
    """uint8 (n, 4): the words of colours uint8 (n, 4), straight alpha, and of masks uint8 (n,)."""
    shades = np.rint(rgba / 255.0 * SHADES).astype("<u4")
    word = np.zeros(len(rgba), "<u4") | np.asarray(masks, "<u4")
    for channel, bit in enumerate(CHANNEL_BITS):
        word |= shades[:, channel] << bit
    return np.ascontiguousarray(word, "<u4").view(np.uint8).reshape(-1, 4)


def covered(payloads: np.ndarray, masks: np.ndarray | None) -> np.ndarray:
    """uint8 (n, 4): payloads of which each covers no other samples than those of its mask, uint8 (n,)."""
    if masks is None:
        return payloads
    found = payloads.copy()
    found[:, MASK_BYTE] &= masks
    return found


def straight_of(payloads: np.ndarray) -> np.ndarray:
    """float64 (n, 4): red, green, blue and opacity from 0 to 1, straight alpha."""
    return np.stack([words(payloads) >> bit & SHADES for bit in CHANNEL_BITS], axis=-1) / SHADES


def samples_of(payloads: np.ndarray, msaa: int) -> np.ndarray:
    """bool (n, msaa): the samples that each payload covers."""
    return (payloads[:, MASK_BYTE, None] >> np.arange(msaa, dtype=np.uint8) & 1) > 0


def model(rays: Rays, settings: Settings) -> np.ndarray:
    """float64 (pixels, 4): the fragments of each pixel composited as `settings.coverage` says, premultiplied."""
    stacks = settings.msaa if settings.coverage == "samples" else 1  # that a pixel is composited in
    colour, through = np.zeros((rays.counts.size, stacks, 3)), np.ones((rays.counts.size, stacks))
    for pixels, _, payloads in rays.ranks():
        straight = straight_of(payloads)
        opacity = straight[:, 3:] * _parts(payloads, settings)
        colour[pixels] += (through[pixels] * opacity)[..., None] * straight[:, None, :3]
        through[pixels] *= 1.0 - opacity
    return np.concatenate([colour.mean(axis=1), 1.0 - through.mean(axis=1, keepdims=True)], axis=-1)


def _parts(payloads: np.ndarray, settings: Settings) -> np.ndarray:
    """float64 (n, stacks): the share of its opacity that each payload has in each stack of its pixel."""
    samples = samples_of(payloads, settings.msaa)
    if settings.coverage == "samples":
        return samples.astype(np.float64)
    return samples.mean(axis=1, keepdims=True) if settings.coverage == "alpha" else np.ones((len(samples), 1))
