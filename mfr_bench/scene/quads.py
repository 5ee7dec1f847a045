"""Synthetic scenes of pixel-aligned quads (kplus_2015 §5.1, gpupro5_ch1 §1.7.2), bit for bit the same per seed.

Depths lie on multiples of 2**-23 in (0, 1): float32 holds them exactly, so do 2d - 1 (the normalized
device depth) and the way back, and no two quads of a scene share one.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

import numpy as np

from ..config.layout import TILE, TILES_STREAM, block, least_layers, mean_depth, quad_count, quad_size, shares, tiles
from ..config.model import Scene as SceneConfig
from ..hashing import WORD, hash3
from . import stress
from .colours import rgba
from .overlap import most_over
from .streams import DEPTH, DEPTH_ORDER, FIRST_DRAWN, LAYERS_DRAWN, ORDER, PLACE_X, PLACE_Y, SIDE

DEPTH_GRID = 2**23


@dataclass(frozen=True)
class Scene:
    """Quads in submission order.

    rect: int32 (n, 4), x0 y0 x1 y1, half-open pixels, origin lower left; it may reach beyond the viewport.
    depth: float32 (n,); outside [0, 1] there is nothing to see.
    rgba: uint8 (n, 4), straight alpha. seed decides which fragments are rejected.
    least: where above 0, each pixel draws how many of all quads it receives, at least this many.
    """

    geometry: ClassVar[str] = "quad"  # how primitives reach the device: shaders/scene/<geometry>.vert
    occluded: ClassVar[bool] = False  # nothing opaque is drawn first

    viewport: tuple[int, int]
    rect: np.ndarray
    depth: np.ndarray
    rgba: np.ndarray
    fragment_probability: float
    seed: int
    least: int = 0

    def __len__(self) -> int:
        return len(self.depth)

    @cached_property
    def bounds(self) -> tuple[int, int, int, int]:
        """Left, bottom, width and height in pixels of what bounds the quads in the viewport."""
        rect = self.rasterized
        rect = rect[(rect[:, 2] > rect[:, 0]) & (rect[:, 3] > rect[:, 1])]
        if not len(rect):
            return 0, 0, 0, 0
        (left, bottom), (right, top) = rect[:, :2].min(axis=0), rect[:, 2:].max(axis=0)
        return int(left), int(bottom), int(right - left), int(top - bottom)

    @cached_property
    def layers(self) -> int:
        """Most fragments that a pixel can have, by the rectangles alone."""
        return most_over(self.rasterized, self.viewport)

    @cached_property
    def reach(self) -> int:
        """Pixels that the quads cover, each as often as it is covered: most fragments of a frame."""
        sides = np.clip(self.rasterized[:, 2:].astype(np.int64) - self.rasterized[:, :2], 0, None)
        return int(sides.prod(axis=1).sum())

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
    def keep_threshold(self) -> int:
        """A fragment is generated where its hash is below this; 2**32 means always."""
        return min(2**32, round(self.fragment_probability * 2**32))

    @property
    def rejects(self) -> bool:
        """Whether some fragments of the rectangles are not generated."""
        return self.keep_threshold < 2**32 or self.least > 0

    def arrays(self) -> dict[str, np.ndarray]:
        """What `mfr-bench scene` writes."""
        return {"rect": self.rect, "depth": self.depth, "rgba": self.rgba}

    def kept(self, quad: int, x0: int, y0: int, x1: int, y1: int) -> np.ndarray:
        """bool (y1-y0, x1-x0): which pixels of the rectangle receive the quad's fragment."""
        width = self.viewport[0]
        pixel = np.arange(y0, y1, dtype=np.uint64)[:, None] * width + np.arange(x0, x1, dtype=np.uint64)
        kept = hash3(pixel, int(quad), self.seed) < min(self.keep_threshold, 2**32 - 1)  # a uniform's largest
        return kept & self._drawn(pixel, quad) if self.least else kept

    def _drawn(self, pixel: np.ndarray, quad: int) -> np.ndarray:
        """bool, as `pixel`: whether the quad is among those that the pixel draws, a run of the order of submission."""
        count = len(self)
        layers = self.least + hash3(pixel, LAYERS_DRAWN, self.seed) % (count - self.least + 1)
        return (hash3(pixel, FIRST_DRAWN, self.seed) % count + quad) % count < layers


def flat_quads(config: SceneConfig, seed: int) -> Scene:
    """The quads of a layout, each of one depth."""
    rect = rectangles(config, seed)
    index = np.arange(len(rect), dtype=np.uint64)
    depth, colours = stress.values(config, depths(index, seed), rgba(config, index, seed))
    order = _submission(config.order, depth, index, seed)
    rect, depth = stress.reaching(config, rect[order]), stress.odd(config, depth[order])
    return Scene(tuple(config.size), rect, depth, colours[order], config.fragment_probability, seed,
                 least_layers(config))


def rectangles(config: SceneConfig, seed: int) -> np.ndarray:
    """int32 (n, 4): where the quads of a layout go, in no order that matters."""
    return _LAYOUTS[config.layout](config, seed)


def depths(index: np.ndarray, seed: int) -> np.ndarray:
    """Distinct depths: one per equal slice of (0, 1), at a hashed place within its slice."""
    count = max(1, len(index))
    start = index * (DEPTH_GRID - 1) // count + 1
    room = (index + 1) * (DEPTH_GRID - 1) // count + 1 - start
    grid = start + hash3(index, DEPTH, seed) % room
    scattered = np.argsort(hash3(index, DEPTH_ORDER, seed), kind="stable")
    return (grid[scattered] / DEPTH_GRID).astype(np.float32)


def _submission(order: str, depth: np.ndarray, index: np.ndarray, seed: int) -> np.ndarray:
    if order == "front_to_back":
        return np.argsort(depth, kind="stable")
    if order == "back_to_front":
        return np.argsort(-depth, kind="stable")
    return np.argsort(hash3(index, ORDER, seed), kind="stable")


def _block_layout(config: SceneConfig, seed: int) -> np.ndarray:
    """One centred block, every quad over all of it."""
    return np.tile(np.array(_block_rect(config), dtype=np.int32), (config.depth_complexity, 1))


def _block_rect(config: SceneConfig) -> tuple[int, int, int, int]:
    (width, height), (w, h) = config.size, block(config.size, config.pixel_density)
    x0, y0 = (width - w) // 2, (height - h) // 2
    return x0, y0, x0 + w, y0 + h


def _tiles_layout(config: SceneConfig, seed: int) -> np.ndarray:
    """Hashed tiles of the viewport, every one with the same number of quads of its own."""
    width, height = config.size
    x0, y0 = np.meshgrid(np.arange(0, width, TILE), np.arange(0, height, TILE))
    every = np.stack([x0, y0, np.minimum(x0 + TILE, width), np.minimum(y0 + TILE, height)], axis=-1).reshape(-1, 4)
    index = np.arange(len(every), dtype=np.uint64)
    shuffled = every[np.argsort(hash3(index, TILES_STREAM, seed), kind="stable")]
    count, _ = tiles(config.size, config.pixel_density, seed)
    return np.repeat(shuffled[:count].astype(np.int32), config.depth_complexity, axis=0)


def _random_layout(config: SceneConfig, seed: int) -> np.ndarray:
    """Quads of a given size at hashed places within the block, so many that its mean depth is the config's."""
    x0, y0, x1, y1 = _block_rect(config)
    w, h = quad_size(config)
    index = np.arange(quad_count(config), dtype=np.uint64)
    x = x0 + (hash3(index, PLACE_X, seed) % (x1 - x0 - w + 1)).astype(np.int32)
    y = y0 + (hash3(index, PLACE_Y, seed) % (y1 - y0 - h + 1)).astype(np.int32)
    return np.stack([x, y, x + w, y + h], axis=-1).astype(np.int32)


def _mixed_layout(config: SceneConfig, seed: int) -> np.ndarray:
    """Rectangles within the block, all over its middle: the first is the block, the areas add up to the mean depth.

    What rounding to whole pixels takes from one, the next gets.
    """
    x0, y0, x1, y1 = _block_rect(config)
    w, h = x1 - x0, y1 - y0
    made, owed = [], 0.0
    for layer, share in enumerate(shares(config.depth_complexity, mean_depth(config))):
        wanted = share * w * h + owed
        longest = min(1.0, wanted / (w * h))
        side = longest + (1.0 - longest) * (hash3(layer, SIDE, seed) / WORD)  # of the block's width
        width = max(1, min(w, int(wanted), max(round(side * w), -(-int(wanted) // h))))
        height = min(h, max(1, round(wanted / width)))
        owed = wanted - width * height
        x, y = (_over_middle(length, whole, hash3(layer, stream, seed))
                for length, whole, stream in ((width, w, PLACE_X), (height, h, PLACE_Y)))
        made.append((x0 + x, y0 + y, x0 + x + width, y0 + y + height))
    return np.array(made, dtype=np.int32).reshape(-1, 4)


def _over_middle(length: int, whole: int, noise: int) -> int:
    """A hashed start at which so many pixels of a row hold the one in the middle."""
    first, last = max(0, whole // 2 - length + 1), min(whole // 2, whole - length)
    return first + noise % (last - first + 1)


_LAYOUTS = {"block": _block_layout, "tiles": _tiles_layout, "random": _random_layout, "mixed": _mixed_layout}
