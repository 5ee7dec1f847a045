"""Makes the scenes of `kind: histogram`: depths by rank of a smooth noise, and every layer in rectangles."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ..errors import UsageError
from ..hashing import hash3
from .colours import rgba
from .flat import submission
from .layouts import depths
from .noise import heights
from .parameters import Scene
from .pieces import Pieces
from .spec.kind import MAX_PRIMITIVES
from .streams import HILL, PIXEL


def histogram(config: Scene, _frame: int = 0) -> Pieces:
    """The quads of a config. Raises UsageError where they are more than there are distinct depths."""
    rect = np.concatenate([np.empty((0, 4), np.int32), *_rectangles(depth_map(config))])
    if len(rect) > MAX_PRIMITIVES:
        raise UsageError(f"scene.pixels: {len(rect)} quads; allowed: at most {MAX_PRIMITIVES}, so that depths stay "
                         "distinct; take fewer fragments or a larger cluster")
    index = np.arange(len(rect), dtype=np.uint64)
    depth, colours = depths(index, config.seed), rgba(config, index, config.seed)
    order = submission(config.order, depth, index, config.seed)
    return Pieces(tuple(config.size), rect[order], depth[order], colours[order], 1.0, config.seed)


def depth_map(config: Scene) -> np.ndarray:
    """int64 (H, W): the depth complexity of each pixel; the histogram of all is `pixels`."""
    width, height = config.size
    pixel = np.arange(width * height, dtype=np.uint64)
    hills = heights(config.size, config.cluster, HILL, config.seed).ravel()
    rank = np.lexsort((hash3(pixel, PIXEL, config.seed), hills))
    found = np.empty(width * height, dtype=np.int64)
    found[rank] = np.repeat(np.arange(len(config.pixels)), config.pixels)
    return found.reshape(height, width)


def _rectangles(depth: np.ndarray) -> Iterator[np.ndarray]:
    """int32 (n, 4) for each layer: rectangles over the pixels that are deeper than the layers before."""
    for layer in range(1, int(depth.max(initial=0)) + 1):
        yield _runs(depth >= layer)


def _runs(mask: np.ndarray) -> np.ndarray:
    """int32 (n, 4): x0 y0 x1 y1 of the runs of a mask along its rows, equal ones above each other in one rectangle."""
    edges = np.diff(np.pad(mask, ((0, 0), (1, 1))).astype(np.int8), axis=1)
    y, x0 = np.nonzero(edges == 1)
    x1 = np.nonzero(edges == -1)[1]
    order = np.lexsort((y, x1, x0))  # equal runs side by side, from the lowest row
    x0, x1, y = x0[order], x1[order], y[order]
    goes_on = (x0[1:] == x0[:-1]) & (x1[1:] == x1[:-1]) & (y[1:] == y[:-1] + 1)
    first, last = np.flatnonzero(np.r_[True, ~goes_on][:len(y)]), np.flatnonzero(np.r_[~goes_on, True][:len(y)])
    return np.stack([x0[first], y[first], x1[first], y[last] + 1], axis=-1).astype(np.int32)
