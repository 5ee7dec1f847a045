"""The look of primitives: their colours and opacities, 8 bits a channel, straight alpha."""

from __future__ import annotations

import numpy as np

from ..hashing import WORD, hash3
from .materials import MATERIALS, texels
from .parameters import Scene
from .streams import ALPHA, BLEND, COLOUR, LUMINANCE

# Two colours at the rim of the RGB cube, seen from black: what every colour of a `plane` is a blend of.
TEAL, ORANGE = np.array([0.0, 0.8, 1.0]), np.array([1.0, 0.45, 0.0])
DARKEST = 0.04  # light of a colour of a set, as a share of the brightest of its hue


def rgba(config: Scene, index: np.ndarray, seed: int) -> np.ndarray:
    """uint8 (n, 4) for the primitives of these indices."""
    found = np.empty((len(index), 4), dtype=np.uint8)
    found[:, :3] = _any(index, seed) if config.colours == "any" else _of_set(config.colours, index, seed)
    found[:, 3] = alphas(config.alpha, hash3(index, ALPHA, seed))
    return found


def _any(index: np.ndarray, seed: int) -> np.ndarray:
    """The whole cube, evenly."""
    colour = hash3(index, COLOUR, seed)
    return np.stack([colour >> (8 * channel) & 0xFF for channel in range(3)], axis=-1)


def _of_set(name: str, index: np.ndarray, seed: int) -> np.ndarray:
    """Hues of a set at hashed luminances: light adds up, and is the square of what 8 bits hold (gamma 2)."""
    if name in MATERIALS:
        return texels(name, index, seed)
    choice = hash3(index, BLEND, seed)
    if name == "plane":
        blend = (choice / WORD)[:, None]
        light = TEAL * (1 - blend) + ORANGE * blend
    else:
        light = hues(int(name.partition("-")[2]))[choice % int(name.partition("-")[2])]
    bright = DARKEST + (1 - DARKEST) * (hash3(index, LUMINANCE, seed) / WORD)
    return np.rint(255 * np.sqrt(light * bright[:, None])).astype(np.uint8)


def hues(count: int) -> np.ndarray:
    """float64 (count, 3): saturated colours at equal steps around the hexagon of hues, from red."""
    place = 6.0 * np.arange(count) / count
    distance = np.abs((place[:, None] - np.array([0.0, 2.0, 4.0]) + 3.0) % 6.0 - 3.0)
    return np.clip(2.0 - distance, 0.0, 1.0)


def alphas(bounds: tuple[float, float], noise: np.ndarray) -> np.ndarray:
    """uint8 of opacities between the bounds, by hashes."""
    low, high = (round(a * 255) for a in bounds)
    return (low + noise % (high - low + 1)).astype(np.uint8)
