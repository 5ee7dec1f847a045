"""The small scenes of the race machine: a row of pixels, each with a few fragments of its own."""

from __future__ import annotations

import re
from collections.abc import Sequence

import numpy as np

from ..errors import UsageError
from ..hashing import hash3
from ..scene.quads import Quads

DEPTH_STEPS = 64  # depths are multiples of 1/64: exact in every format that stores them, 16 bits and more
MOST_FRAGMENTS, MOST_PIXELS = 24, 64
ORDER_STREAM, COLOUR_STREAM, ALPHA_STREAM = 1, 2, 5  # of the hash


def parse_counts(text: str) -> tuple[int, ...]:
    """The fragments of each pixel, as in `3,2`. Raises UsageError."""
    if not re.fullmatch(r"\d+(,\d+)*", text):
        raise UsageError(f"--fragments: {text!r} is not allowed; allowed: the fragments of each pixel, such as 3,2")
    counts = tuple(map(int, text.split(",")))
    if sum(counts) > MOST_FRAGMENTS or len(counts) > MOST_PIXELS or not sum(counts):
        raise UsageError(f"--fragments: {text!r} is not allowed; allowed: 1 to {MOST_FRAGMENTS} fragments in all, and "
                         f"at most {MOST_PIXELS} pixels")
    return counts


def row_of(counts: Sequence[int], seed: int = 1, ties: bool = False) -> Quads:
    """One pixel for each count, side by side; colours and the order of submission are drawn from `seed`.

    ties: the two nearest fragments of each pixel have one depth.
    """
    pixel = np.repeat(np.arange(len(counts)), counts)
    layer = np.concatenate([np.arange(count) for count in counts]).astype(np.int64)
    depth = np.float32((np.maximum(layer, 1) if ties else layer) + 8) / np.float32(DEPTH_STEPS)
    drawn = np.array([hash3(i, seed, ORDER_STREAM) for i in range(len(pixel))], dtype=np.uint32)
    order = np.argsort(drawn, kind="stable")
    rect = np.stack([pixel, np.zeros_like(pixel), pixel + 1, np.ones_like(pixel)], axis=-1).astype(np.int32)
    return Quads((len(counts), 1), rect[order], depth[order], _colours(len(pixel), seed)[order], 1.0, seed)


def _colours(count: int, seed: int) -> np.ndarray:
    """uint8 (count, 4): alphas from faint to dense, no two alike, dealt out by the seed."""
    drawn = np.array([[hash3(i, seed, COLOUR_STREAM + c) for c in range(3)] for i in range(count)], dtype=np.uint32)
    alphas = 16 + 232 * np.arange(MOST_FRAGMENTS) // (MOST_FRAGMENTS - 1)
    dealt = np.argsort([hash3(i, seed, ALPHA_STREAM) for i in range(MOST_FRAGMENTS)])[:count]
    return np.concatenate([drawn % 224 + 32, alphas[dealt, None]], axis=-1).astype(np.uint8)
