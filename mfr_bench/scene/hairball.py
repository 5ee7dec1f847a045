"""A stand-in for the Hairball (kplus_2015 Fig. 3 and 10, occupancy_2015 Fig. 1 and 4): 180 layers at most."""

from __future__ import annotations

import numpy as np

from ..hashing import WORD, hash3
from .kinds.hairball import RINGS, sectors
from .objects import approach, direction, half_block, zoom
from .parameters import Scene
from .spec.kind import mean_depth
from .spec.layout import spread
from .streams import CUT, LENGTH, ROOT, TIP, TURN, WIGGLE
from .strips import Strips, orthographic, strips


def hairball(config: Scene, frame: int) -> Strips:
    """Hairs from the middle outwards, each a row of strips; those of a layer side by side around it.

    The squares of their lengths are spread so that the mean over what any hair covers is `mean_depth`.
    """
    layers, around, seed = config.depth_complexity, sectors(config), config.seed
    hair = np.arange(layers * around, dtype=np.uint64).reshape(layers, around)
    reach = _reach(config, hair, seed)
    x, y = _rim_points(config, layers, around, frame)
    half = half_block(config) * zoom(frame)
    xy = np.stack([x * half[0], y * half[1]], axis=-1)  # (layers, around, RINGS + 1, 2)
    place = _hair_depth(hair, reach, seed)
    left = orthographic(xy, place)
    right = orthographic(np.roll(xy, -1, axis=1), place)
    corners = np.stack([left[:, :, :-1], right[:, :, :-1], left[:, :, 1:], right[:, :, 1:]], axis=3)
    return strips(config, corners[np.arange(RINGS) < reach[..., None]], seed, part_of=np.repeat(hair, reach.ravel()))


def _reach(config: Scene, hair: np.ndarray, seed: int) -> np.ndarray:
    """Rings that each hair crosses: in the mean the square of its length, 1 at least."""
    layers, mean = config.depth_complexity, mean_depth(config)
    share = (mean - 1) / (layers - 1 + 1e-9) if layers > 1 else 1.0
    square = spread(share)(hash3(hair, LENGTH, seed) / WORD) * RINGS * RINGS
    below = np.floor(np.sqrt(square))
    further = (square - below * below) / (2 * below + 1) > hash3(hair, CUT, seed) / WORD
    return np.clip(below + further, 1, RINGS).astype(np.int64)


def _rim_points(config: Scene, layers: int, around: int, frame: int) -> tuple[np.ndarray, np.ndarray]:
    """Edges between the hairs of a layer, float64 (layers, around, RINGS + 1): curves that never cross."""
    layer = np.arange(layers, dtype=np.uint64)[:, None, None]
    edge = np.arange(around, dtype=np.uint64)[None, :, None]
    radius = np.arange(RINGS + 1) / RINGS
    noise = hash3(layer * around + edge, WIGGLE, config.seed) / WORD - 0.5
    turn = hash3(layer, TURN, config.seed) / WORD
    curl = (hash3(layer, TIP, config.seed) / WORD - 0.5) * (1.0 + approach(frame))
    cosine, sine = direction((edge + 0.7 * noise) / around + turn + 0.2 * curl * radius * radius)
    return radius * cosine, radius * sine


def _hair_depth(hair: np.ndarray, reach: np.ndarray, seed: int) -> np.ndarray:
    """Place in the depth range at each ring: a short hair points to the viewer or away, a long one to the side."""
    root = 0.25 + 0.5 * (hash3(hair, ROOT, seed) / WORD)
    length = reach / RINGS
    side = np.where(hash3(hair, TIP, seed) & 1, 1.0, -1.0)
    rise = side * 0.24 * np.sqrt(np.maximum(0.0, 1.0 - length * length)) + 0.02 * side
    along = np.minimum(1.0, np.arange(RINGS + 1) / (RINGS * length[..., None]))
    return root[..., None] + rise[..., None] * along
