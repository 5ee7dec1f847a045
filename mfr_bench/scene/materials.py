"""Materials of few hues, as textures have them: grass and dirt, rock and stone, sand with dead grass.

They stand for the photographs of gpupro5_ch2, Figs. 2.4 to 2.6, which are not free: made of noise, the same on every
machine.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ..hashing import WORD, hash3
from .noise import noise
from .streams import BLEND, LUMINANCE, SHADE, SPECK

# Colours of 8 bits, from one end of the material to the other; what lies between two is a blend of their light.
MATERIALS: Mapping[str, tuple[tuple[int, int, int], ...]] = {
    "grass": ((60, 45, 32), (92, 70, 48), (122, 98, 66), (74, 92, 36), (96, 118, 46), (128, 146, 66)),
    "rock": ((78, 80, 86), (104, 102, 100), (134, 128, 120), (160, 152, 140), (146, 138, 92)),
    "sand": ((90, 84, 80), (126, 116, 106), (140, 112, 62), (178, 152, 88), (198, 174, 130), (216, 198, 156)),
}
DARKEST, BRIGHTEST = 0.35, 1.0  # light of a texel, as a share of its colour's


def texels(name: str, index: np.ndarray, seed: int) -> np.ndarray:
    """uint8 (n, 3): colours of single texels of a material, by hash."""
    return _colours(name, hash3(index, BLEND, seed) / WORD, hash3(index, LUMINANCE, seed) / WORD)


def picture(name: str, size: tuple[int, int], seed: int = 1) -> np.ndarray:
    """uint8 (H, W, 3): a material as a texture: patches, tufts in them, and light and shade of single grains."""
    place = 0.55 * noise(size, 48, BLEND, seed) + 0.3 * noise(size, 11, SPECK, seed)
    place += 0.15 * noise(size, 3, SHADE, seed)
    bright = 0.5 * noise(size, 4, LUMINANCE, seed) + 0.5 * noise(size, 1, SHADE, seed)
    contrast = np.clip(1.8 * (place - 0.5) + 0.5, 0.0, 1.0)
    return _colours(name, contrast.ravel(), bright.ravel()).reshape(*place.shape, 3)


def _colours(name: str, place: np.ndarray, bright: np.ndarray) -> np.ndarray:
    """uint8 (n, 3) at places from 0 to 1 along a material's colours, with a brightness from 0 to 1."""
    light = np.square(np.array(MATERIALS[name]) / 255.0)
    at = place * (len(light) - 1)
    first = np.minimum(at.astype(np.int64), len(light) - 2)
    share = (at - first)[:, None]
    blended = light[first] * (1 - share) + light[first + 1] * share
    return np.rint(255 * np.sqrt(blended * (DARKEST + (BRIGHTEST - DARKEST) * bright[:, None]))).astype(np.uint8)
