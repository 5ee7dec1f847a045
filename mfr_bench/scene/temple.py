"""A stand-in for the Greek temple (occupancy_2015 Fig. 5): large faces in perspective, 8 layers in the mean."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from ..hashing import WORD, hash3
from .objects import half_block, zoom
from .parameters import Scene
from .spec.kind import mean_depth
from .spec.layout import shares
from .streams import TURN, WIGGLE
from .strips import Strips, strips, window_depth

FRIEZE, GABLE, STEPS = (-0.12, 0.15), (0.16, 0.55), (-1.0, -0.82)  # heights; the eye is at the frieze
COLUMNS, COLUMN = 8, (-0.76, -0.13)
FACETS = np.array([0.0, 0.15, 0.5, 0.85, 1.0])  # across a column
BULGE = np.array([0.0, 0.02, 0.03, 0.02, 0.0])  # how much nearer a column is there
EYE = 0.85  # distance of what is nearest to the eye; the first facade is at 1
MARGIN = 1.12  # of the block to the first facade, whose columns and turn reach beyond it
SOLID = 0.68  # mean depth / sum of the facades' areas, as shares of the largest


def temple(config: Scene, frame: int) -> Strips:
    """Facades one behind the other in perspective, slightly turned; the eye is at their frieze."""
    layers = config.depth_complexity
    areas = shares(layers, min(float(layers), mean_depth(config) / SOLID))
    parts = [_facade(config, layer, area, frame) for layer, area in enumerate(areas)]
    return strips(config, np.concatenate(parts) if parts else np.empty((0, 4, 4)), config.seed)


def _facade(config: Scene, layer: int, area: float, frame: int) -> np.ndarray:
    """Corners of one facade, (pieces, 4, 4); its area on the screen is a share of the first one's."""
    fill = 0.4 + 0.2 * (hash3(layer, WIGGLE, config.seed) / WORD)
    yaw = 0.2 * (hash3(layer, TURN, config.seed) / WORD - 0.5)
    distance = 1.0 / np.sqrt(max(area, 1e-4))
    xyd = np.concatenate([_beams(), _columns(fill)])  # across and up in the facade, and how much nearer
    w = distance * (1.0 + yaw * xyd[..., 0]) * (1.0 - xyd[..., 2])
    half = half_block(config) * zoom(frame)
    place = (1.0 - EYE / w) * 0.98
    clip = np.empty((len(xyd), 4, 4))
    clip[..., :2] = xyd[..., :2] * half / MARGIN
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
