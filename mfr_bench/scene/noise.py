"""Smooth noise over a viewport: hashed heights at the corners of a lattice, linear between them."""

from __future__ import annotations

import numpy as np

from ..hashing import hash3

FINE = 2**12  # heights at a corner of the lattice: their products with two weights stay whole in 64 bits


def heights(size: tuple[int, int], step: int, stream: int, seed: int) -> np.ndarray:
    """int64 (H, W), from 0 to below step² · FINE, with hills `step` pixels apart; step 1: every pixel for itself."""
    width, height = size
    columns = width // step + 2
    y, x = np.divmod(np.arange(height), step), np.divmod(np.arange(width), step)
    found = np.zeros((height, width), dtype=np.int64)
    for down in (0, 1):
        for across in (0, 1):
            corner = (y[0][:, None] + down) * columns + x[0] + across
            weight = (y[1] if down else step - y[1])[:, None] * (x[1] if across else step - x[1])
            found += weight * (hash3(corner.astype(np.uint64), stream, seed) % FINE).astype(np.int64)
    return found


def noise(size: tuple[int, int], step: int, stream: int, seed: int) -> np.ndarray:
    """float64 (H, W) in [0, 1): the heights as a share of the highest that can be."""
    return heights(size, step, stream, seed) / (step * step * FINE)
