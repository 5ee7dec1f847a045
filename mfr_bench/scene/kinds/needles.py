"""`kind: needles`, a stand-in for the needle tree (occupancy_2015 Fig. 4): many thin strips."""

from __future__ import annotations

import math
from functools import lru_cache

from ..spec.kind import CommonKeys, Described, mean_depth
from ..spec.layered import Layered, block_pixels
from ..spec.layout import block

FULLEST = 0.7  # beyond this mean, as a share of the layers, needles leave too few gaps
NEEDLE_LENGTH = 8  # in widths of a needle
TREE = 0.5  # of the block that the silhouette takes: a triangle


class Needles(Layered):
    """Needles in layers of all directions, in the shape of a tree."""

    name = "needles"
    generator = "needles.needles"
    fullest = FULLEST
    rows = (Described("`needles`", "needles in layers of all directions, in the shape of a tree", "the maximum",
                      "`mean_depth`", "the needle tree: mean 100"),)

    def silhouette(self, scene: CommonKeys) -> float:
        return TREE * _beyond(scene)

    def primitives(self, scene: CommonKeys) -> int:
        patch = needle_width(scene) ** 2 * NEEDLE_LENGTH / needle_fill(scene)  # pixels of a layer for each needle
        return round(scene.depth_complexity * (1 + TREE * block_pixels(scene) / patch))


def needle_width(scene: CommonKeys) -> int:
    """Mean width of a needle, pixels."""
    return max(2, min(scene.size) // 128)


@lru_cache(maxsize=256)
def needle_fill(scene: CommonKeys) -> float:
    """Share of a layer that needles cover, by which the mean over the pixels that any layer covers is mean_depth."""
    layers, low, high = scene.depth_complexity, 1e-6, FULLEST
    mean = mean_depth(scene) * _beyond(scene)
    for _ in range(50):
        fill, bare = (low + high) / 2, 1.0
        for _ in range(layers):
            bare *= 1 - fill
        low, high = (fill, high) if layers * fill < mean * (1 - bare) else (low, fill)
    return low


def _beyond(scene: CommonKeys) -> float:
    """The area that needles cover, over the silhouette that their middles keep to: three tenths beyond its edge."""
    w, h = block(scene.size, scene.pixel_density)
    edge = w + 2 * math.sqrt(h * h + w * w / 4)
    return 1 + 0.3 * NEEDLE_LENGTH * needle_width(scene) * edge / (TREE * w * h)


KIND = Needles()
