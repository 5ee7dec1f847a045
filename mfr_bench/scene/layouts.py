"""Places the quads of each layout, and gives them depths.

Depths lie on multiples of 2**-23 in (0, 1): float32 holds them exactly, so do 2d - 1 (the normalized
device depth) and the way back, and no two quads of a scene share one.
"""

from __future__ import annotations

import numpy as np

from ..hashing import WORD, hash3
from .kinds.quads import KIND, TILE, TILES_STREAM, quad_size, tiles
from .parameters import Scene
from .spec.kind import mean_depth
from .spec.layout import block, shares
from .streams import DEPTH, DEPTH_ORDER, PLACE_X, PLACE_Y, SIDE

DEPTH_GRID = 2**23


def rectangles(config: Scene, seed: int) -> np.ndarray:
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


def _block_layout(config: Scene, seed: int) -> np.ndarray:
    """One centred block, every quad over all of it."""
    return np.tile(np.array(_block_rect(config), dtype=np.int32), (config.depth_complexity, 1))


def _block_rect(config: Scene) -> tuple[int, int, int, int]:
    (width, height), (w, h) = config.size, block(config.size, config.pixel_density)
    x0, y0 = (width - w) // 2, (height - h) // 2
    return x0, y0, x0 + w, y0 + h


def _tiles_layout(config: Scene, seed: int) -> np.ndarray:
    """Hashed tiles of the viewport, every one with the same number of quads of its own."""
    width, height = config.size
    x0, y0 = np.meshgrid(np.arange(0, width, TILE), np.arange(0, height, TILE))
    every = np.stack([x0, y0, np.minimum(x0 + TILE, width), np.minimum(y0 + TILE, height)], axis=-1).reshape(-1, 4)
    index = np.arange(len(every), dtype=np.uint64)
    shuffled = every[np.argsort(hash3(index, TILES_STREAM, seed), kind="stable")]
    count, _ = tiles(config.size, config.pixel_density, seed)
    return np.repeat(shuffled[:count].astype(np.int32), config.depth_complexity, axis=0)


def _random_layout(config: Scene, seed: int) -> np.ndarray:
    """Quads of a given size at hashed places within the block, so many that its mean depth is the config's."""
    x0, y0, x1, y1 = _block_rect(config)
    w, h = quad_size(config)
    index = np.arange(KIND.primitives(config), dtype=np.uint64)
    x = x0 + (hash3(index, PLACE_X, seed) % (x1 - x0 - w + 1)).astype(np.int32)
    y = y0 + (hash3(index, PLACE_Y, seed) % (y1 - y0 - h + 1)).astype(np.int32)
    return np.stack([x, y, x + w, y + h], axis=-1).astype(np.int32)


def _mixed_layout(config: Scene, seed: int) -> np.ndarray:
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
