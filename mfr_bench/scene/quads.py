"""Pixel-aligned rectangles of one depth and one colour each, and which of their fragments are generated."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from ..effects import PLAIN, Settings
from ..hashing import hash3
from .overlap import bounds_of, most_over
from .primitives import Primitives
from .streams import FIRST_DRAWN, LAYERS_DRAWN


@dataclass(frozen=True)
class Quads(Primitives):
    """Quads in submission order.

    rect: int32 (n, 4), x0 y0 x1 y1, half-open pixels, origin lower left; it may reach beyond the viewport.
    depth: float32 (n,); outside [0, 1] there is nothing to see.
    rgba: uint8 (n, 4), straight alpha. seed decides which fragments are rejected.
    least: where above 0, each pixel draws how many of all quads it receives, at least this many. shading: steps of
    each fragment that is shaded. effect: what is done with the fragments of a pixel.
    """

    viewport: tuple[int, int]
    rect: np.ndarray
    depth: np.ndarray
    rgba: np.ndarray
    fragment_probability: float
    seed: int
    least: int = 0
    shading: int = field(default=0, kw_only=True)
    effect: Settings = field(default=PLAIN, kw_only=True)

    def __len__(self) -> int:
        return len(self.depth)

    @property
    def geometry(self) -> str:
        """How the quads reach the device: with masks of all samples where a pixel has several, as they cover each."""
        return "masked" if self.effect.msaa > 1 else "quad"

    @cached_property
    def bounds(self) -> tuple[int, int, int, int]:
        """Left, bottom, width and height in pixels of what bounds the quads in the viewport."""
        rect = self.rasterized
        return bounds_of(rect[(rect[:, 2] > rect[:, 0]) & (rect[:, 3] > rect[:, 1])])

    @cached_property
    def depth_bounds(self) -> tuple[float, float]:
        """Window depths between which the quads lie that can be seen; the whole range where there is none."""
        inside = self.depth[(self.depth >= 0) & (self.depth <= 1)]
        return (float(inside.min()), float(inside.max())) if len(inside) else (0.0, 1.0)

    @cached_property
    def layers(self) -> int:
        """Most fragments that a pixel can have, by the rectangles alone."""
        return most_over(self.rasterized, self.viewport)

    @cached_property
    def reach(self) -> int:
        """Pixels that the quads cover, each as often as it is covered: most fragments of a frame."""
        sides = np.clip(self.rasterized[:, 2:].astype(np.int64) - self.rasterized[:, :2], 0, None)
        return int(sides.prod(axis=1).sum())

    @property
    def expected(self) -> int:
        """Fragments to expect of a frame."""
        return self.reach

    @cached_property
    def depth_order(self) -> np.ndarray:
        """Quad indices from the nearest to the furthest; equal depths stay in submission order."""
        return np.argsort(self.depth, kind="stable")

    @cached_property
    def rasterized(self) -> np.ndarray:
        """int32 (n, 4): the pixels that each quad covers; none at depths that GL clips, or that are no number."""
        width, height = self.viewport
        inside = np.clip(self.rect, 0, np.array([width, height, width, height], dtype=np.int32))
        return np.where(((self.depth >= 0) & (self.depth <= 1))[:, None], inside, np.int32(0))

    @property
    def rejects(self) -> bool:
        """Whether some fragments of the rectangles are not generated."""
        return self.keep_threshold < 2**32 or self.least > 0

    def arrays(self) -> dict[str, np.ndarray]:
        """The arrays that `mfr-bench scene` writes."""
        return {"rect": self.rect, "depth": self.depth, "rgba": self.rgba}

    def kept(self, quad: int, x0: int, y0: int, x1: int, y1: int) -> np.ndarray:
        """bool (y1-y0, x1-x0): which pixels of the rectangle receive the quad's fragment."""
        width = self.viewport[0]
        pixel = np.arange(y0, y1, dtype=np.uint64)[:, None] * width + np.arange(x0, x1, dtype=np.uint64)
        return self.kept_at(pixel, int(quad))

    def kept_at(self, pixel: np.ndarray, quad: np.ndarray | int) -> np.ndarray:
        """bool, as `pixel`: whether these pixels (uint64) receive the fragments of these quads, which cover them."""
        kept = hash3(pixel, quad, self.seed) < min(self.keep_threshold, 2**32 - 1)  # a uniform's largest
        return kept & self._drawn(pixel, quad) if self.least else kept

    def _drawn(self, pixel: np.ndarray, quad: np.ndarray | int) -> np.ndarray:
        """bool, as `pixel`: whether the quad is among those that the pixel draws, a run of the order of submission."""
        count = len(self)
        layers = self.least + hash3(pixel, LAYERS_DRAWN, self.seed) % (count - self.least + 1)
        return (hash3(pixel, FIRST_DRAWN, self.seed) % count + quad) % count < layers
