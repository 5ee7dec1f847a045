"""The fragments of pixels in order, as the float64 models of effects read them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Rays:
    """Fragments pixel by pixel, nearest first.

    counts: int64 (pixels,). depth: float64 (F,), window depths. rgba: uint8 (F, 4), payloads.
    """

    counts: np.ndarray
    depth: np.ndarray
    rgba: np.ndarray

    def ranks(self) -> Iterator[tuple[np.ndarray, np.ndarray, np.ndarray]]:
        """For each rank from the nearest: the pixels (m,) that have it, and the depths and payloads there."""
        deepest_first = np.argsort(-self.counts, kind="stable")
        starts, deep = (np.cumsum(self.counts) - self.counts)[deepest_first], -self.counts[deepest_first]
        left = self.counts.size
        for rank in range(int(self.counts.max(initial=0))):
            left = int(np.searchsorted(deep[:left], -rank))
            at = starts[:left] + rank
            yield deepest_first[:left], self.depth[at], self.rgba[at]

    def image(self) -> np.ndarray:
        """float64 (pixels, 4): transparent black, to be filled."""
        return np.zeros((self.counts.size, 4))
