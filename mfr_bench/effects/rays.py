"""The fragments of pixels in order, as the float64 models of effects read them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np


def by_rank(counts: np.ndarray) -> tuple[np.ndarray, Iterator[np.ndarray]]:
    """The pixels with most fragments first, and for each rank from the nearest the places of its fragments.

    counts: int64 (pixels,), of fragments that stand pixel by pixel, nearest first. The m places of a rank are those of
    the first m pixels in this order.
    """
    deepest_first = np.argsort(-counts, kind="stable")
    starts, deep = (np.cumsum(counts) - counts)[deepest_first], -counts[deepest_first]

    def places() -> Iterator[np.ndarray]:
        left = counts.size
        for rank in range(int(counts.max(initial=0))):
            left = int(np.searchsorted(deep[:left], -rank))  # pixels with more than `rank` fragments
            yield starts[:left] + rank

    return deepest_first, places()


@dataclass(frozen=True)
class Rays:
    """Fragments pixel by pixel, nearest first.

    counts: int64 (pixels,). depth: float64 (F,), window depths. rgba: uint8 (F, 4), payloads.
    """

    counts: np.ndarray
    depth: np.ndarray
    rgba: np.ndarray

    def ranks(self) -> Iterator[tuple[np.ndarray, np.ndarray, np.ndarray]]:
        """Give, for each rank from the nearest, the pixels (m,) that have it, and the depths and payloads there."""
        pixels, ranks = by_rank(self.counts)
        for at in ranks:
            yield pixels[:len(at)], self.depth[at], self.rgba[at]

    def image(self) -> np.ndarray:
        """float64 (pixels, 4): transparent black, to be filled."""
        return np.zeros((self.counts.size, 4))
