"""What effects on objects store in place of a colour: object, facing, colour and opacity in one RGBA8 word.

From the lowest bit: 5 bits of the object's number, 1 for the front, 6 each of red, green and blue, 8 of opacity.
shaders/effects/fragment.glsl reads the same.
"""

from __future__ import annotations

import numpy as np

OBJECTS = 32  # that a word tells apart
FRONT, COLOUR_STEPS = 32, 63


def packed(rgba: np.ndarray, objects: np.ndarray, front: np.ndarray) -> np.ndarray:
    """uint8 (n, 4): the words of colours uint8 (n, 4), objects int (n,), of which 5 bits count, and bool (n,)."""
    steps = np.rint(rgba[:, :3] / 255.0 * COLOUR_STEPS).astype("<u4")
    word = (objects.astype("<u4") % OBJECTS) + FRONT * front.astype("<u4") + (rgba[:, 3].astype("<u4") << 24)
    for channel, shift in enumerate((6, 12, 18)):
        word += steps[:, channel] << shift
    return np.ascontiguousarray(word, "<u4").view(np.uint8).reshape(-1, 4)


def words(rgba: np.ndarray) -> np.ndarray:
    """uint32 (n,): the payloads as words."""
    return np.ascontiguousarray(rgba).view("<u4").ravel()


def objects_of(rgba: np.ndarray) -> np.ndarray:
    """uint32 (n,): a bit for the object, 1 << its number."""
    return np.uint32(1) << (words(rgba) % OBJECTS)


def fronts_of(rgba: np.ndarray) -> np.ndarray:
    """bool (n,): whether the front of the face is seen."""
    return (words(rgba) & FRONT) > 0


def colours_of(rgba: np.ndarray) -> np.ndarray:
    """float64 (n, 3): red, green and blue from 0 to 1."""
    return np.stack([words(rgba) >> shift & COLOUR_STEPS for shift in (6, 12, 18)], axis=-1) / COLOUR_STEPS
