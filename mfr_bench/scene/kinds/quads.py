"""`kind: quads`, the papers' synthetic scenes (kplus_2015 §5.1, gpupro5_ch1 §1.7.2): pixel-aligned rectangles."""

from __future__ import annotations

import math
import struct
from collections import defaultdict
from dataclasses import dataclass, fields
from functools import lru_cache
from typing import Annotated, Literal

from annotated_types import Interval

from ...hashing import hash3
from ..spec.expected import binomial_mix, even_counts, layered_counts, placed_chances
from ..spec.kind import MAX_PRIMITIVES, CommonKeys, Described, Fault, Kind, flat_geometry, late, mean_depth
from ..spec.layered import block_pixels
from ..spec.layout import block
from ..spec.values import Allowed, Share, Size, Unit, Whole

TILE = 32  # pixels, side of a tile of layout `tiles`
TILES_STREAM = 6  # of the hash, by which tiles are shuffled; scene.streams has the others
MAX_OVERHANG = 2**24  # pixels: a float32 holds every corner
CLIPPED_PER_PIXEL = 2**23 - 1  # pixels of overhang that are clipped rightly, per pixel of the viewport's shorter side
OF_ONE_DEPTH = ("depth_at", "depth_copies", "odd_depth", "alpha_order", "overhang")  # keys of quads without slant


@dataclass(frozen=True, kw_only=True)
class QuadKeys:
    """The keys of quads.

    least_depth: each pixel of a block of flat quads draws its number of fragments evenly from this share of
    depth_complexity up to all of it; None: every pixel has all. slant: most change of depth across a quad, share of
    the depth range. quad_size: pixels, layout `random` only; None means a quarter of each side of the viewport.

    What puts methods under stress: depth_at: depths lie about this one in steps of 2**depth_gap_log2, instead of all
    over the range. depth_copies: quads that share a depth; copies: whether they share their colour as well.
    odd_depth: what the quad submitted first has for a depth. alpha_order: falling, the nearest quad has the highest
    alpha; rising, the lowest. overhang: pixels by which every quad reaches beyond its place, on each side.
    """

    layout: Literal["block", "tiles", "random", "mixed"] = "block"
    least_depth: Share | None = late(None)
    slant: Unit = 0.0
    quad_size: Size | None = None
    depth_at: Unit | None = None
    depth_gap_log2: Annotated[int, Interval(ge=-126, le=-1), Allowed("a whole number from -126 to -1")] = -4
    depth_copies: Whole = 1
    copies: Literal["alike", "different"] = "alike"
    odd_depth: Literal["none", "zero", "minus_zero", "one", "below", "beyond", "far_below", "far_beyond", "infinity",
                       "minus_infinity", "nan"] = "none"
    alpha_order: Literal["random", "falling", "rising"] = "random"
    overhang: Annotated[int, Interval(ge=0, le=MAX_OVERHANG), Allowed(f"pixels from 0 to {MAX_OVERHANG}")] = 0


@lru_cache(maxsize=256)
def tiles(size: tuple[int, int], density: float, seed: int) -> tuple[int, int]:
    """The number of hashed tiles that brings their area nearest to density·W·H, and that area in pixels."""
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


def quad_size(scene: CommonKeys) -> tuple[int, int]:
    """Width and height of every quad of layout `random`, pixels: no larger than the block."""
    wanted = scene.quad_size or tuple(max(1, side // 4) for side in scene.size)
    w, h = block(scene.size, scene.pixel_density)
    return min(wanted[0], w), min(wanted[1], h)


def is_flat(scene: CommonKeys) -> bool:
    """Whether every quad has one depth, on the grid that makes the analytic oracle exact."""
    return scene.slant == 0


def clustered_depths(scene: CommonKeys) -> list[float]:
    """Depths in steps of the scene's gap about `depth_at`: from 0 upwards, from 1 downwards, else on both sides."""
    quads, gap, at = KIND.primitives(scene), 2.0 ** scene.depth_gap_log2, scene.depth_at
    below = 0 if at == 0 else quads - 1 if at == 1 else quads // 2
    return [at + (i - below) * gap for i in range(quads)]


def is_float32(value: float) -> bool:
    """Whether a float32 represents the value without rounding."""
    return struct.unpack("<f", struct.pack("<f", value))[0] == value


def _quad_size_unused(scene: CommonKeys) -> Fault | None:
    unused = scene.quad_size and scene.layout != "random"
    what = f"quad_size has no use in layout {scene.layout}; allowed: with layout random"
    return (("scene.quad_size", "scene.layout"), what) if unused else None


def _needs_one_depth(scene: CommonKeys) -> Fault | None:
    changed = [f.name for f in fields(QuadKeys) if f.name in OF_ONE_DEPTH and getattr(scene, f.name) != f.default]
    if is_flat(scene) or not changed:
        return None
    return (f"scene.{changed[0]}",), f"{changed[0]} has no use but for quads without slant; allowed: its default"


def _no_such_depths(scene: CommonKeys) -> Fault | None:
    quads = KIND.primitives(scene)
    if scene.depth_at is None or quads > MAX_PRIMITIVES:
        return None
    keys = ("scene.depth_gap_log2", "scene.depth_at")
    where = f"{quads} quads in steps of 2^{scene.depth_gap_log2} about {scene.depth_at:g}"
    depths = clustered_depths(scene)
    if depths and not 0 <= depths[0] <= depths[-1] <= 1:
        return keys, f"{where} leave the depth range; allowed: smaller steps or fewer quads"
    if not all(map(is_float32, depths)):
        return keys, f"{where} are finer than a float32 there; allowed: larger steps"
    return None


def _least_depth_unused(scene: CommonKeys) -> Fault | None:
    unused = scene.least_depth is not None and not (is_flat(scene) and scene.layout == "block")
    what = "least_depth has no use but for quads without slant in one block; allowed: with layout block"
    return (("scene.least_depth", "scene.layout", "scene.kind"), what) if unused else None


def _cannot_be_clipped(scene: CommonKeys) -> Fault | None:
    """A corner at 2^24 half viewports or more has float32 coordinates whose edges the clipping loses."""
    most = min(MAX_OVERHANG, min(scene.size) * CLIPPED_PER_PIXEL)
    side = "1 pixel" if min(scene.size) == 1 else f"{min(scene.size)} pixels"
    what = (f"an overhang of {scene.overhang} beyond a viewport whose shorter side has {side}, which "
            f"float32 cannot clip; allowed: up to {most}")
    return (("scene.overhang", "scene.size"), what) if scene.overhang > most else None


class Quads(Kind):
    """Pixel-aligned, front-facing rectangles of constant colour."""

    name = "quads"
    noun = "quads"
    Keys = QuadKeys
    generator = "flat.quads"
    rules = (_quad_size_unused, _needs_one_depth, _no_such_depths, _least_depth_unused, _cannot_be_clipped)
    rows = (
        Described("`quads`, `layout: block`", "one centred block, every quad over all of it",
                  "of every covered pixel", "the same", "the papers' synthetic scenes"),
        Described("`quads`, `layout: tiles`", "the same density scattered in tiles of 32 x 32",
                  "of every covered pixel", "the same", "sparse views"),
        Described("`quads`, `layout: random`", "quads of `quad_size` at random places", "the mean over the block",
                  "the same", "GPU Pro 5, §1.7.2"),
        Described("`quads`, `layout: mixed`", "rectangles of many sizes, all over the middle", "the exact maximum",
                  "`mean_depth`, to a part of a percent", "GPU Pro 5, Fig. 1.3: mean 10.3, maximum 46"),
    )
    key_words = """\
- `slant`, 0 to 1: depth changes across each quad by this share of the depth range, in a direction of its own, so that
  quads cross. Their edges stay those of pixels.
- `least_depth`, blocks of flat quads only: each pixel draws its number of fragments evenly from this share of the depth
  complexity up to all of it, by the hash; which quads those are is a run of the order of submission that begins at a
  hashed place. kplus_2015 §5.1.1 makes pixels with fewer than k fragments so: n from k to 10 k is a share of 0.1.
  `fragment_probability` then decides for each of them.
- `quad_size`, layout `random` only: width and height in pixels; a quarter of the viewport's sides where it is left out.
- `depth_at`, `depth_gap_log2`, `depth_copies`, `copies`, `odd_depth`, `alpha_order`, `overhang`, flat quads only: what
  puts methods under stress ([stress.md](stress.md)).
"""

    def covered_pixels(self, scene: CommonKeys) -> int:
        if scene.layout == "tiles":
            return tiles(scene.size, scene.pixel_density, scene.seed)[1]
        return block_pixels(scene)

    def primitives(self, scene: CommonKeys) -> int:
        if scene.layout == "tiles":
            return scene.depth_complexity * tiles(scene.size, scene.pixel_density, scene.seed)[0]
        if scene.layout == "random":
            return round(scene.depth_complexity * block_pixels(scene) / math.prod(quad_size(scene)))
        return scene.depth_complexity

    def geometry_of(self, scene: CommonKeys) -> str:
        return flat_geometry(scene) if is_flat(scene) else "strip"

    def has_mean_depth(self, scene: CommonKeys) -> bool:
        return scene.layout == "mixed"

    def least_layers(self, scene: CommonKeys) -> int:
        wanted = max(1, round((scene.least_depth or 0) * scene.depth_complexity))
        return min(wanted, scene.depth_complexity) if scene.least_depth else 0

    def where(self, scene: CommonKeys) -> str:
        return f"in layout {scene.layout}"

    def expected_counts(self, scene: CommonKeys) -> list[float]:
        covered, layers, probability = self.covered_pixels(scene), scene.depth_complexity, scene.fragment_probability
        if scene.layout == "mixed":
            return layered_counts(layers, mean_depth(scene), covered, probability)
        if scene.least_depth:
            return even_counts(self.least_layers(scene), layers, covered, probability)
        if scene.layout == "random":
            return self._random_counts(scene)
        return binomial_mix(layers, {probability: covered})

    def _random_counts(self, scene: CommonKeys) -> list[float]:
        chances: dict[float, float] = defaultdict(float)
        (width, height), (w, h) = block(scene.size, scene.pixel_density), quad_size(scene)
        across, down = placed_chances(width, w), placed_chances(height, h)
        for x in across:
            for y in down:
                share = self.covered_pixels(scene) / (len(across) * len(down))
                chances[x * y * scene.fragment_probability] += share
        return binomial_mix(self.primitives(scene), chances)


KIND = Quads()
