"""A stand-in for the needle tree (occupancy_2015 Fig. 4): many thin strips, 100 layers in the mean."""

from __future__ import annotations

import numpy as np

from ..hashing import WORD, hash3
from .kinds.needles import NEEDLE_LENGTH, needle_fill, needle_width
from .objects import direction, zoom
from .parameters import Scene
from .spec.layout import block
from .streams import PLACE, ROOT, SHIFT, TIP, TURN
from .strips import Strips, orthographic, strips


def needles(config: Scene, frame: int) -> Strips:
    """Layers of parallel needles within the silhouette of a tree, each layer in a direction of its own.

    A layer is cut into cells; a needle lies somewhere across its cell, the one in the middle on the middle.
    """
    parts = [_needle_layer(config, layer, frame) for layer in range(config.depth_complexity)]
    return strips(config, np.concatenate(parts) if parts else np.empty((0, 4, 4)), config.seed)


def _needle_layer(config: Scene, layer: int, frame: int) -> np.ndarray:
    width = needle_width(config)
    across, along = width / needle_fill(config), float(width * NEEDLE_LENGTH)
    cosine, sine = direction(np.array((hash3(layer, TURN, config.seed) + 0.5) / 2**32 / 2))
    a, b = _tree_cells(config, across, along, cosine, sine)
    cell = hash3((a.astype(np.int64) + 2**20).astype(np.uint64), (b.astype(np.int64) + 2**20).astype(np.uint64),
                 hash3(layer, SHIFT, config.seed))
    room = np.maximum(0.0, across - 1.3 * width)
    middle = a * across + np.where((a == 0) & (b == 0), 0.0, room * (hash3(cell, PLACE, 0) / WORD - 0.5))
    ends = np.array([-0.5, -0.5, 0.5, 0.5]) * along + (b * along)[:, None]
    sides = middle[:, None] + width * np.array([-0.65, 0.65, -0.35, 0.35])
    xy = np.stack([cosine * ends - sine * sides, sine * ends + cosine * sides], axis=-1)
    root, rise = 0.15 + 0.7 * (hash3(cell, ROOT, 0) / WORD), 0.25 * (hash3(cell, TIP, 0) / WORD - 0.5)
    place = root[:, None] + rise[:, None] * np.array([-1.0, -1.0, 1.0, 1.0])
    return orthographic(_to_device(config, xy, frame), place)


def _tree_cells(config: Scene, across: float, along: float, cosine: np.ndarray,
                sine: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Cells whose middles lie in the silhouette: a triangle on the block's lower edge with its tip on the upper."""
    w, h = block(config.size, config.pixel_density)
    reach = np.sqrt(float(w * w + h * h)) / 2
    a, b = np.meshgrid(_whole(reach / across), _whole(reach / along), indexing="ij")
    x, y = cosine * b * along - sine * a * across, sine * b * along + cosine * a * across
    inside = (np.abs(y) <= h / 2) & (np.abs(x) <= (h / 2 - y) / h * w / 2)
    inside |= (a == 0) & (b == 0)
    return a[inside], b[inside]


def _whole(reach: float) -> np.ndarray:
    return np.arange(-int(reach) - 1, int(reach) + 2, dtype=np.float64)


def _to_device(config: Scene, xy: np.ndarray, frame: int) -> np.ndarray:
    """Normalized device coordinates of pixels, counted from the middle of the pixel in the middle."""
    size = np.array(config.size, dtype=np.float64)
    odd = np.array([(side % 2 == 0) / 2 for side in config.size])
    return 2.0 * (xy * zoom(frame) + odd) / size
