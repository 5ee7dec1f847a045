"""The word that effects on objects store in place of a colour: object, facing, colour and opacity in RGBA8.

`numbers` has its layout; shaders/effects/fragment.glsl reads the same.
"""

from __future__ import annotations

import numpy as np

from .numbers import BLUE_BIT, COLOUR_BITS, FRONT_BIT, GREEN_BIT, OBJECT_BITS, OPACITY_BIT, RED_BIT

OBJECTS = 1 << OBJECT_BITS  # that a word tells apart
COLOUR_STEPS = (1 << COLOUR_BITS) - 1
CHANNEL_BITS = RED_BIT, GREEN_BIT, BLUE_BIT


def packed(rgba: np.ndarray, objects: np.ndarray, front: np.ndarray) -> np.ndarray:
    """uint8 (n, 4): the words of colours uint8 (n, 4), objects int (n,) modulo OBJECTS, and bool (n,)."""
    steps = np.rint(rgba[:, :3] / 255.0 * COLOUR_STEPS).astype("<u4")
    word = objects.astype("<u4") % OBJECTS + (front.astype("<u4") << FRONT_BIT)
    word += rgba[:, 3].astype("<u4") << OPACITY_BIT
    for channel, bit in enumerate(CHANNEL_BITS):
        word += steps[:, channel] << bit
    return np.ascontiguousarray(word, "<u4").view(np.uint8).reshape(-1, 4)


def words(rgba: np.ndarray) -> np.ndarray:
    """uint32 (n,): the payloads as words."""
    return np.ascontiguousarray(rgba).view("<u4").ravel()


def objects_of(rgba: np.ndarray) -> np.ndarray:
    """uint32 (n,): a bit for the object, 1 << its number."""
    return np.uint32(1) << (words(rgba) % OBJECTS)


def fronts_of(rgba: np.ndarray) -> np.ndarray:
    """bool (n,): whether the front of the face is seen."""
    return (words(rgba) >> FRONT_BIT & 1) > 0


def colours_of(rgba: np.ndarray) -> np.ndarray:
    """float64 (n, 3): red, green and blue from 0 to 1."""
    return np.stack([words(rgba) >> bit & COLOUR_STEPS for bit in CHANNEL_BITS], axis=-1) / COLOUR_STEPS


def inside_after(objects: np.ndarray, rgba: np.ndarray) -> np.ndarray:
    """uint32 (n,): the objects, a bit for each, that rays are inside of behind faces, if inside of `objects` before."""
    return np.where(fronts_of(rgba), objects | objects_of(rgba), objects & ~objects_of(rgba))
