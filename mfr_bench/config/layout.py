"""Where the primitives of a scene go: the rules that scenes follow, and that plans predict by.

Only additions, multiplications, divisions and square roots, which every machine rounds alike.
"""

from __future__ import annotations

import math
import struct
from dataclasses import dataclass
from functools import lru_cache
from typing import TypeVar

from ..hashing import hash3
from .model import Scene

Number = TypeVar("Number")  # a float, or a float64 array

MOST_POWER = 60  # of a spread
TILE = 32  # pixels, side of a tile of layout `tiles`
TILES_STREAM = 6  # of the hash, by which tiles are shuffled; scene.quads has the others


@lru_cache(maxsize=256)
def block(size: tuple[int, int], density: float) -> tuple[int, int]:
    """Width and height of the block: the viewport's shape, its area nearest to density·W·H.

    Where several shapes are as near, the one closest to the viewport's own aspect ratio.
    """
    (width, height), scale = size, math.sqrt(density)
    target, ideal = density * width * height, width * scale
    shapes = [(w, _rest(target, w, height)) for w in _about(ideal, width)]
    shapes += [(_rest(target, h, width), h) for h in _about(height * scale, height)]
    return min(shapes, key=lambda s: (abs(s[0] * s[1] - target), abs(s[0] - ideal)))


def _about(ideal: float, most: int) -> range:
    """Lengths within a tenth of the ideal one."""
    return range(max(1, int(ideal * 0.9)), min(most, int(ideal * 1.1) + 1) + 1)


def _rest(area: float, side: int, most: int) -> int:
    """The other side that brings a rectangle nearest to the area."""
    return min(max(round(area / side), 1), most)


@lru_cache(maxsize=256)
def tiles(size: tuple[int, int], density: float, seed: int) -> tuple[int, int]:
    """How many hashed tiles bring their area nearest to density·W·H, and that area in pixels."""
    width, height = size
    target = density * width * height
    areas = [w * h for h in _cuts(height) for w in _cuts(width)]
    if width % TILE or height % TILE:  # else all are alike, and their order does not matter
        areas = [areas[i] for i in sorted(range(len(areas)), key=lambda i: hash3(i, TILES_STREAM, seed))]
    best, covered = (0, 0), 0
    for count, area in enumerate(areas, 1):
        covered += area
        if count == 1 or abs(covered - target) < abs(best[1] - target):
            best = count, covered
        if covered >= target:
            break
    return best


def _cuts(length: int) -> list[int]:
    return [min(TILE, length - start) for start in range(0, length, TILE)]


def quad_size(scene: Scene) -> tuple[int, int]:
    """Width and height of every quad of layout `random`, pixels: no larger than the block."""
    wanted = scene.quad_size or tuple(max(1, side // 4) for side in scene.size)
    w, h = block(scene.size, scene.pixel_density)
    return min(wanted[0], w), min(wanted[1], h)


def covered_pixels(scene: Scene) -> int:
    """Pixels of the block or of the tiles; of an object, about."""
    if scene.kind != "quads":
        return max(1, round(_object_pixels(scene)))
    if scene.layout == "tiles":
        return tiles(scene.size, scene.pixel_density, scene.seed)[1]
    return _block_pixels(scene)


def quad_count(scene: Scene) -> int:
    """Quads submitted; of an object its strips, about."""
    if scene.kind != "quads":
        return _object_strips(scene)
    if scene.layout == "tiles":
        return scene.depth_complexity * tiles(scene.size, scene.pixel_density, scene.seed)[0]
    if scene.layout == "random":
        return round(scene.depth_complexity * covered_pixels(scene) / math.prod(quad_size(scene)))
    return scene.depth_complexity


def clustered_depths(scene: Scene) -> list[float]:
    """Depths in steps of the scene's gap about `depth_at`: from 0 upwards, from 1 downwards, else on both sides."""
    quads, gap, at = quad_count(scene), 2.0 ** scene.depth_gap_log2, scene.depth_at
    below = 0 if at == 0 else quads - 1 if at == 1 else quads // 2
    return [at + (i - below) * gap for i in range(quads)]


def is_float32(value: float) -> bool:
    """Whether a float32 holds the value without rounding."""
    return struct.unpack("<f", struct.pack("<f", value))[0] == value


# Most mean depth of a kind, as a share of its depth complexity: beyond it the shapes leave too few gaps.
FULLEST = {"quads": 1.0, "hairball": 0.95, "needles": 0.7, "temple": 0.65}

RINGS = 16  # of a hairball: a hair is a row of strips, one in each ring
NEEDLE_LENGTH = 8  # in widths of a needle
TREE = 0.5  # of the block that the silhouette of a needle tree takes: a triangle


def is_flat(scene: Scene) -> bool:
    """Whether every primitive has one depth, on the grid that makes the analytic oracle exact."""
    return scene.kind == "quads" and scene.slant == 0


def has_mean_depth(scene: Scene) -> bool:
    """Whether depth_complexity is the maximum over the pixels, and mean_depth the mean over the covered ones."""
    return scene.kind != "quads" or scene.layout == "mixed"


def least_layers(scene: Scene) -> int:
    """Fewest fragments that a covered pixel draws before any is discarded; 0 where every pixel has all."""
    wanted = max(1, round((scene.least_depth or 0) * scene.depth_complexity))
    return min(wanted, scene.depth_complexity) if scene.least_depth else 0


def mean_depth(scene: Scene) -> float:
    """Fragments per covered pixel that a scene with a mean depth aims at."""
    return scene.mean_depth or max(1.0, 0.4 * scene.depth_complexity)


@dataclass(frozen=True)
class Spread:
    """Numbers in [0, 1] of a given mean, from numbers spread evenly there: a blend of two whole powers."""

    power: int
    blend: float

    def __call__(self, even: Number) -> Number:
        low = 1.0
        for _ in range(self.power):
            low = low * even
        return low * (1 - self.blend) + low * even * self.blend


def spread(mean: float) -> Spread:
    """The spread of a mean in [0, 1]; x**p has the mean 1 / (p + 1). Means below 1 / 61 become that."""
    exponent = min(MOST_POWER, max(0.0, 1 / max(mean, 1e-9) - 1))
    power = int(exponent)
    return Spread(power, (1 / (power + 1) - 1 / (exponent + 1)) * (power + 1) * (power + 2))


def shares(layers: int, mean: float) -> list[float]:
    """Share of the covered pixels that each layer covers, from 1 downwards; they add up to `mean`, at most `layers`."""
    if layers < 2:
        return [1.0] * layers
    rest = min(1.0, (mean - 1) / (layers - 1))
    raw = [spread(rest)((layers - i - 0.5) / (layers - 1)) for i in range(1, layers)]
    scale = rest * (layers - 1) / sum(raw)
    return [1.0, *(min(1.0, share * scale) for share in raw)]


def sectors(scene: Scene) -> int:
    """Hairs side by side around a layer of a hairball."""
    return max(12, min(96, min(scene.size) // 8))


def needle_width(scene: Scene) -> int:
    """Mean width of a needle, pixels."""
    return max(2, min(scene.size) // 128)


@lru_cache(maxsize=256)
def needle_fill(scene: Scene) -> float:
    """Share of a layer that needles cover, by which the mean over the pixels that any layer covers is mean_depth."""
    layers, low, high = scene.depth_complexity, 1e-6, FULLEST["needles"]
    mean = mean_depth(scene) * _needles_beyond(scene)
    for _ in range(50):
        fill, bare = (low + high) / 2, 1.0
        for _ in range(layers):
            bare *= 1 - fill
        low, high = (fill, high) if layers * fill < mean * (1 - bare) else (low, fill)
    return low


def _needles_beyond(scene: Scene) -> float:
    """What needles cover, as a multiple of the silhouette that their middles keep to: three tenths beyond its edge."""
    w, h = block(scene.size, scene.pixel_density)
    edge = w + 2 * math.sqrt(h * h + w * w / 4)
    return 1 + 0.3 * NEEDLE_LENGTH * needle_width(scene) * edge / (TREE * w * h)


def facade_pieces(scene: Scene) -> int:
    """Strips of a facade of a temple: a frieze in eight, a gable, steps, and four for each of eight columns."""
    return 8 + 1 + 1 + 8 * 4


def _block_pixels(scene: Scene) -> int:
    return math.prod(block(scene.size, scene.pixel_density))


def _object_pixels(scene: Scene) -> float:
    """About the pixels that the silhouette of an object takes of its block."""
    taken = {"hairball": 0.78, "needles": TREE * _needles_beyond(scene), "temple": 0.57}
    return min(1.0, taken[scene.kind]) * _block_pixels(scene)


def _object_strips(scene: Scene) -> int:
    """About the strips of an object; never less than a third of them."""
    if scene.kind == "hairball":
        return scene.depth_complexity * sectors(scene) * RINGS
    if scene.kind == "temple":
        return scene.depth_complexity * facade_pieces(scene)
    cell = needle_width(scene) ** 2 * NEEDLE_LENGTH / needle_fill(scene)
    return round(scene.depth_complexity * (1 + TREE * _block_pixels(scene) / cell))
