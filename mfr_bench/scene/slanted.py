"""Quads with a depth gradient: the rectangles of every layout, tilted about their middles, so that they cross."""

from __future__ import annotations

import numpy as np

from ..hashing import WORD, hash3
from .layouts import depths, rectangles
from .parameters import Scene
from .streams import SLANT, TILT
from .strips import Strips, orthographic, strips


def slanted(config: Scene, seed: int) -> Strips:
    """Across a quad depth changes by `slant` of the depth range: a hashed part of it along x, the rest along y."""
    rect = rectangles(config, seed)
    index = np.arange(len(rect), dtype=np.uint64)
    middle = depths(index, seed).astype(np.float64)
    part, signs = hash3(index, SLANT, seed) / WORD, hash3(index, TILT, seed)
    along_x = config.slant * part * np.where(signs & 1, 1.0, -1.0)
    along_y = config.slant * (1.0 - part) * np.where(signs & 2, 1.0, -1.0)
    edges = 2.0 * rect / np.tile(np.array(config.size, dtype=np.float64), 2) - 1.0
    xy = np.stack([edges[:, (0, 2, 0, 2)], edges[:, (1, 1, 3, 3)]], axis=-1)
    tilt = along_x[:, None] * np.array([-0.5, 0.5, -0.5, 0.5]) + along_y[:, None] * np.array([-0.5, -0.5, 0.5, 0.5])
    place = config.slant / 2 + (1.0 - config.slant) * middle[:, None] + tilt
    return strips(config, orthographic(xy, place), seed)
