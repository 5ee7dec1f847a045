"""Kinds of objects made of layers: what the stand-ins for the papers' meshes share without being made.

A layer covers a pixel once at most, and every layer covers the middle of the viewport, so that the maximum is the
number of layers; how much the layers leave bare gives the mean.
"""

from __future__ import annotations

import math

from .expected import layered_counts
from .kind import CommonKeys, Kind, mean_depth
from .layout import block


class Layered(Kind):
    """An object of `depth_complexity` layers, whose mean over the covered pixels is mean_depth."""

    def silhouette(self, scene: CommonKeys) -> float:
        """About the share of its block that the object takes."""
        raise NotImplementedError

    def covered_pixels(self, scene: CommonKeys) -> int:
        return max(1, round(min(1.0, self.silhouette(scene)) * block_pixels(scene)))

    def has_mean_depth(self, scene: CommonKeys) -> bool:
        return True

    def expected_counts(self, scene: CommonKeys) -> list[float]:
        return layered_counts(scene.depth_complexity, mean_depth(scene), self.covered_pixels(scene),
                              scene.fragment_probability)


def block_pixels(scene: CommonKeys) -> int:
    """Pixels of the block in the middle of the viewport."""
    return math.prod(block(scene.size, scene.pixel_density))
