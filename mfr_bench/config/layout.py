"""Where the quads of a scene go, in whole pixels: the rule that scenes follow, and that plans predict by."""

from __future__ import annotations

import math
import struct
from functools import lru_cache

from ..hashing import hash3
from .model import Scene

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
    """Pixels of the block or of the tiles."""
    if scene.layout == "tiles":
        return tiles(scene.size, scene.pixel_density, scene.seed)[1]
    return math.prod(block(scene.size, scene.pixel_density))


def quad_count(scene: Scene) -> int:
    """Quads submitted."""
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
