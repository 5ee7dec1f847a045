"""Stand-ins for the meshes of the papers, of a given maximum and mean depth complexity (kplus_2015, occupancy_2015).

An object is made of `depth_complexity` layers. A layer covers a pixel once at most, and every layer covers the middle
of the viewport, so that the maximum is the number of layers; how much the layers leave bare gives the mean.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from ..config.layout import (
    NEEDLE_LENGTH,
    RINGS,
    block,
    mean_depth,
    needle_fill,
    needle_width,
    sectors,
    shares,
    spread,
)
from ..config.model import Scene as SceneConfig
from ..hashing import WORD, hash3
from .streams import CUT, LENGTH, PLACE, ROOT, SHIFT, TIP, TURN, WIGGLE
from .strips import Strips, orthographic, strips, window_depth

CYCLE = 8  # frames of an animation: the camera comes twice as near, and goes back
NEARER = 1.0  # of the way to the middle, on top of where it starts


def hairball(config: SceneConfig, frame: int) -> Strips:
    """Hairs from the middle outwards, each a row of strips; those of a layer side by side around it.

    The squares of their lengths are spread so that the mean over what any hair covers is `mean_depth`.
    """
    layers, around, seed = config.depth_complexity, sectors(config), config.seed
    hair = np.arange(layers * around, dtype=np.uint64).reshape(layers, around)
    reach = _reach(config, hair, seed)
    x, y = _rim_points(config, layers, around, frame)
    half = _half_block(config) * _zoom(frame)
    xy = np.stack([x * half[0], y * half[1]], axis=-1)  # (layers, around, RINGS + 1, 2)
    place = _hair_depth(hair, reach, seed)
    left = orthographic(xy, place)
    right = orthographic(np.roll(xy, -1, axis=1), place)
    corners = np.stack([left[:, :, :-1], right[:, :, :-1], left[:, :, 1:], right[:, :, 1:]], axis=3)
    return strips(config, corners[np.arange(RINGS) < reach[..., None]], seed, part_of=np.repeat(hair, reach.ravel()))


def _reach(config: SceneConfig, hair: np.ndarray, seed: int) -> np.ndarray:
    """Rings that each hair crosses: in the mean the square of its length, 1 at least."""
    layers, mean = config.depth_complexity, mean_depth(config)
    share = (mean - 1) / (layers - 1 + 1e-9) if layers > 1 else 1.0
    square = spread(share)(hash3(hair, LENGTH, seed) / WORD) * RINGS * RINGS
    below = np.floor(np.sqrt(square))
    further = (square - below * below) / (2 * below + 1) > hash3(hair, CUT, seed) / WORD
    return np.clip(below + further, 1, RINGS).astype(np.int64)


def _rim_points(config: SceneConfig, layers: int, around: int, frame: int) -> tuple[np.ndarray, np.ndarray]:
    """Edges between the hairs of a layer, float64 (layers, around, RINGS + 1): curves that never cross."""
    layer = np.arange(layers, dtype=np.uint64)[:, None, None]
    edge = np.arange(around, dtype=np.uint64)[None, :, None]
    radius = np.arange(RINGS + 1) / RINGS
    noise = hash3(layer * around + edge, WIGGLE, config.seed) / WORD - 0.5
    turn = hash3(layer, TURN, config.seed) / WORD
    curl = (hash3(layer, TIP, config.seed) / WORD - 0.5) * (1.0 + _approach(frame))
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


def needles(config: SceneConfig, frame: int) -> Strips:
    """Layers of parallel needles within the silhouette of a tree, each layer in a direction of its own.

    A layer is cut into cells; a needle lies somewhere across its cell, the one in the middle on the middle.
    """
    parts = [_needle_layer(config, layer, frame) for layer in range(config.depth_complexity)]
    return strips(config, np.concatenate(parts) if parts else np.empty((0, 4, 4)), config.seed)


def _needle_layer(config: SceneConfig, layer: int, frame: int) -> np.ndarray:
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


def _tree_cells(config: SceneConfig, across: float, along: float, cosine: np.ndarray,
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


def _to_device(config: SceneConfig, xy: np.ndarray, frame: int) -> np.ndarray:
    """Normalized device coordinates of pixels, counted from the middle of the pixel in the middle."""
    size = np.array(config.size, dtype=np.float64)
    odd = np.array([(side % 2 == 0) / 2 for side in config.size])
    return 2.0 * (xy * _zoom(frame) + odd) / size


FRIEZE, GABLE, STEPS = (-0.12, 0.15), (0.16, 0.55), (-1.0, -0.82)  # heights; the eye is at the frieze
COLUMNS, COLUMN = 8, (-0.76, -0.13)
FACETS = np.array([0.0, 0.15, 0.5, 0.85, 1.0])  # across a column
BULGE = np.array([0.0, 0.02, 0.03, 0.02, 0.0])  # how much nearer a column is there
SOLID = 0.68  # mean depth / sum of the facades' areas, as shares of the largest


def temple(config: SceneConfig, frame: int) -> Strips:
    """Facades one behind the other in perspective, slightly turned; the eye is at their frieze."""
    layers = config.depth_complexity
    areas = shares(layers, min(float(layers), mean_depth(config) / SOLID))
    parts = [_facade(config, layer, area, frame) for layer, area in enumerate(areas)]
    return strips(config, np.concatenate(parts) if parts else np.empty((0, 4, 4)), config.seed)


def _facade(config: SceneConfig, layer: int, area: float, frame: int) -> np.ndarray:
    """Corners of one facade, (pieces, 4, 4); its area on the screen is a share of the first one's."""
    fill = 0.4 + 0.2 * (hash3(layer, WIGGLE, config.seed) / WORD)
    yaw = 0.2 * (hash3(layer, TURN, config.seed) / WORD - 0.5)
    distance = 1.0 / np.sqrt(max(area, 1e-4))
    xyd = np.concatenate([_beams(), _columns(fill)])  # across and up in the facade, and how much nearer
    w = distance * (1.0 + yaw * xyd[..., 0]) * (1.0 - xyd[..., 2])
    half = _half_block(config) * _zoom(frame)
    nearest = 0.85
    place = (1.0 - nearest / w) * 0.98
    clip = np.empty((len(xyd), 4, 4))
    clip[..., 0], clip[..., 1] = xyd[..., 0] * half[0] / 1.12, xyd[..., 1] * half[1] / 1.12
    clip[..., 2], clip[..., 3] = (2.0 * window_depth(place) - 1.0) * w, w
    return clip


def _beams() -> np.ndarray:
    """The frieze in eight strips, the gable and the steps: (10, 4, 3)."""
    edges = np.linspace(-8, 8, 9) / 8
    frieze = [_quad(left, right, *FRIEZE) for left, right in pairwise(edges)]
    gable = [[-1.0, GABLE[0], 0.0], [1.0, GABLE[0], 0.0], [0.0, GABLE[1], 0.0], [0.0, GABLE[1], 0.0]]
    return np.array([*frieze, gable, _quad(-1.0, 1.0, *STEPS)])


def _columns(fill: float) -> np.ndarray:
    """Columns of four facets, whose edges are shared: (32, 4, 3)."""
    found = []
    for column in range(COLUMNS):
        x = -1.0 + 2.0 * (column + (1.0 - fill) / 2 + fill * FACETS) / COLUMNS
        found += [_quad(x[i], x[i + 1], *COLUMN, BULGE[i], BULGE[i + 1]) for i in range(len(x) - 1)]
    return np.array(found)


def _quad(left: float, right: float, low: float, high: float, near_left: float = 0.0, near_right: float = 0.0) -> list:
    return [[left, low, near_left], [right, low, near_right], [left, high, near_left], [right, high, near_right]]


def _half_block(config: SceneConfig) -> np.ndarray:
    """Half the block's sides in normalized device coordinates."""
    return np.array(block(config.size, config.pixel_density)) / np.array(config.size, dtype=np.float64)


def _approach(frame: int) -> float:
    """How far an animation's camera has come, from 0 to 1 and back over a cycle."""
    step = frame % CYCLE
    return min(step, CYCLE - step) / (CYCLE / 2)


def _zoom(frame: int) -> float:
    return 1.0 + NEARER * _approach(frame)


def direction(turns: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Cosine and sine of whole turns, by operations that every machine rounds alike; within 1e-7 of a circle's."""
    turns = turns - np.floor(turns)
    quarter = np.floor(4.0 * turns + 0.5)
    x = (turns - quarter / 4.0) * 6.283185307179586
    square = x * x
    sine = x * (1.0 - square / 6.0 * (1.0 - square / 20.0 * (1.0 - square / 42.0 * (1.0 - square / 72.0))))
    cosine = 1.0 - square / 2.0 * (1.0 - square / 12.0 * (1.0 - square / 30.0 * (1.0 - square / 56.0)))
    quarter = quarter % 4.0
    return (np.select([quarter == 0, quarter == 1, quarter == 2], [cosine, -sine, -cosine], sine),
            np.select([quarter == 0, quarter == 1, quarter == 2], [sine, cosine, -sine], -cosine))
