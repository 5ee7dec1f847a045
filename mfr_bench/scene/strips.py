"""Scenes of slanted primitives: each a strip of four corners in clip space, drawn as two triangles.

All window depths lie in [1/2, 1), where float32 itself steps by 2**-24: wherever a device rounds an interpolated
depth to, it stays on the grid that methods with 24 bits of depth need.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

import numpy as np

from ..hashing import hash3
from .colours import rgba
from .overlap import bounds_of, boxes_of, depth_bounds_of, most_over
from .parameters import Scene
from .streams import ORDER

NEAREST, FURTHEST = 0.5 + 2.0**-10, 1.0 - 2.0**-10  # window depth of any corner


@dataclass(frozen=True)
class Strips:
    """Strips in submission order; the fragments of one are those of its two triangles, each pixel once.

    position: float32 (n, 4, 4), corners in the order of a triangle strip, clip space x y z w. rgba: uint8 (n, 4),
    straight alpha. seed decides which fragments are rejected.
    """

    geometry: ClassVar[str] = "strip"
    least: ClassVar[int] = 0  # no pixel draws its number of fragments
    occluded: ClassVar[bool] = False  # nothing opaque is drawn first

    viewport: tuple[int, int]
    position: np.ndarray
    rgba: np.ndarray
    fragment_probability: float
    seed: int

    def __len__(self) -> int:
        return len(self.position)

    @property
    def keep_threshold(self) -> int:
        """A fragment is generated where its hash is below this; 2**32 means always."""
        return min(2**32, round(self.fragment_probability * 2**32))

    @property
    def rejects(self) -> bool:
        """Whether some fragments of the strips are not generated."""
        return self.keep_threshold < 2**32

    @cached_property
    def boxes(self) -> np.ndarray:
        """int32 (n, 4): the pixels of the viewport that bound each strip, x0 y0 x1 y1, half-open; see `boxes_of`."""
        return boxes_of(self.position, self.viewport)

    @cached_property
    def bounds(self) -> tuple[int, int, int, int]:
        """Left, bottom, width and height in pixels of a rectangle that bounds the strips in the viewport."""
        return bounds_of(self.boxes)

    @cached_property
    def depth_bounds(self) -> tuple[float, float]:
        """Window depths between which the strips lie."""
        return depth_bounds_of(self.position)

    @cached_property
    def layers(self) -> int:
        """Most fragments that a pixel can have, by the boxes alone: two triangles of each strip."""
        return 2 * most_over(self.boxes, self.viewport)

    @property
    def reach(self) -> None:
        """Most fragments of a frame: no closer bound than each layer in each pixel is known."""
        return None

    def arrays(self) -> dict[str, np.ndarray]:
        """What `mfr-bench scene` writes."""
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
    else:
        depth = corners[..., 2] / corners[..., 3]
        middle = depth[:, 0] + depth[:, 1] + depth[:, 2] + depth[:, 3]
        order = np.argsort(middle if config.order == "front_to_back" else -middle, kind="stable")
    colours = rgba(config, index if part_of is None else part_of, seed)
    return Strips(tuple(config.size), np.ascontiguousarray(corners[order], dtype=np.float32), colours[order],
                  config.fragment_probability, seed)
