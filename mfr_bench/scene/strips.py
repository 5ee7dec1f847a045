"""Scenes of slanted primitives: each a strip of four corners in clip space, drawn as two triangles.

All window depths lie in [1/2, 1), where float32 itself steps by 2**-24: wherever a device rounds an interpolated
depth to, it stays on the grid that methods with 24 bits of depth need.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from ..hashing import hash3
from .colours import rgba
from .parameters import Scene
from .primitives import Cornered
from .streams import ORDER

NEAREST, FURTHEST = 0.5 + 2.0**-10, 1.0 - 2.0**-10  # window depth of any corner


@dataclass(frozen=True)
class Strips(Cornered):
    """Strips of four corners: position is float32 (n, 4, 4), in the order of a triangle strip.

    The fragments of a strip are those of its two triangles, each pixel once.
    """

    geometry: ClassVar[str] = "strip"
    triangles_each: ClassVar[int] = 2

    def arrays(self) -> dict[str, np.ndarray]:
        """The arrays that `mfr-bench scene` writes."""
        return {"position": self.position, "rgba": self.rgba}


def window_depth(place: np.ndarray) -> np.ndarray:
    """A place in the depth range, 0 nearest and 1 furthest, as window depth."""
    return NEAREST + (FURTHEST - NEAREST) * place


def orthographic(xy: np.ndarray, place: np.ndarray) -> np.ndarray:
    """Corners (…, 4) in clip space, from normalized device coordinates (…, 2) and places in the depth range (…)."""
    xyzw = np.ones((*place.shape, 4))
    xyzw[..., :2] = xy
    xyzw[..., 2] = 2.0 * window_depth(place) - 1.0
    return xyzw


def strips(config: Scene, corners: np.ndarray, seed: int, part_of: np.ndarray | None = None) -> Strips:
    """A scene of corners (n, 4, 4) in clip space, in the order of the config, with its colours.

    Strips that are `part_of` the same thing (uint64 (n,)) have one colour.
    front_to_back and back_to_front go by the depth of the middle of the corners: slanted strips may still cross.
    """
    index = np.arange(len(corners), dtype=np.uint64)
    if config.order == "random":
        order = np.argsort(hash3(index, ORDER, seed), kind="stable")
    elif config.order == "file":
        order = index
    else:
        depth = corners[..., 2] / corners[..., 3]
        middle = depth[:, 0] + depth[:, 1] + depth[:, 2] + depth[:, 3]
        order = np.argsort(middle if config.order == "front_to_back" else -middle, kind="stable")
    colours = rgba(config, index if part_of is None else part_of, seed)
    return Strips(tuple(config.size), np.ascontiguousarray(corners[order], dtype=np.float32), colours[order],
                  config.fragment_probability, seed)
