"""The common parts of the stand-ins for the papers' meshes: their place on the screen, and their motion.

An object is made of `depth_complexity` layers. A layer covers a pixel once at most, and every layer covers the middle
of the viewport, so that the maximum is the number of layers; how much the layers leave bare gives the mean.
"""

from __future__ import annotations

import numpy as np

from .parameters import Scene
from .spec.layout import block

CYCLE = 8  # frames of an animation: the camera comes nearer, and goes back
NEARER = 1.0  # how much larger the object then is, on top of its own size


def half_block(config: Scene) -> np.ndarray:
    """Half the block's sides in normalized device coordinates."""
    return np.array(block(config.size, config.pixel_density)) / np.array(config.size, dtype=np.float64)


def approach(frame: int) -> float:
    """The way that an animation's camera has come, from 0 to 1 and back over a cycle."""
    step = frame % CYCLE
    return min(step, CYCLE - step) / (CYCLE / 2)


def zoom(frame: int) -> float:
    return 1.0 + NEARER * approach(frame)


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
