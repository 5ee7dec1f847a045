"""Scenes of triangles in clip space, as meshes give them, with the opaque ones apart."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import ClassVar

import numpy as np

from .overlap import bounds_of, boxes_of, depth_bounds_of, most_over


@dataclass(frozen=True)
class Triangles:
    """Triangles in submission order, each with one colour.

    position: float32 (n, 3, 4), corners in clip space x y z w. rgba: uint8 (n, 4), straight alpha. object: int32 (n,),
    the part of the mesh that a triangle belongs to. seed decides which fragments are rejected.

    opaque: float32 (m, 3, 4), corners of triangles that are drawn into a depth buffer first: fragments at or behind
    the depth that they leave are not generated. Their own colours are no part of the image.
    """

    geometry: ClassVar[str] = "triangle"
    least: ClassVar[int] = 0  # no pixel draws its number of fragments

    viewport: tuple[int, int]
    position: np.ndarray
    rgba: np.ndarray
    fragment_probability: float
    seed: int
    object: np.ndarray
    opaque: np.ndarray = field(default_factory=lambda: np.empty((0, 3, 4), np.float32))

    def __len__(self) -> int:
        return len(self.position)

    @property
    def keep_threshold(self) -> int:
        """A fragment is generated where its hash is below this; 2**32 means always."""
        return min(2**32, round(self.fragment_probability * 2**32))

    @property
    def occluded(self) -> bool:
        """Whether opaque triangles may hide fragments."""
        return len(self.opaque) > 0

    @property
    def rejects(self) -> bool:
        """Whether some fragments of the triangles are not generated."""
        return self.keep_threshold < 2**32 or self.occluded

    @cached_property
    def boxes(self) -> np.ndarray:
        """int32 (n, 4): the pixels of the viewport that bound each triangle, x0 y0 x1 y1, half-open; see `boxes_of`."""
        return boxes_of(self.position, self.viewport)

    @cached_property
    def bounds(self) -> tuple[int, int, int, int]:
        """Left, bottom, width and height in pixels of a rectangle that bounds the triangles in the viewport."""
        return bounds_of(self.boxes)

    @cached_property
    def depth_bounds(self) -> tuple[float, float]:
        """Window depths between which the triangles lie."""
        return depth_bounds_of(self.position)

    @cached_property
    def layers(self) -> int:
        """Most fragments that a pixel can have, by the boxes alone."""
        return most_over(self.boxes, self.viewport)

    @property
    def reach(self) -> None:
        """Most fragments of a frame: no closer bound than each layer in each pixel is known."""
        return None

    def arrays(self) -> dict[str, np.ndarray]:
        """What `mfr-bench scene` writes: corners in pixels and window depth, colours, objects."""
        corners = self.position.astype(np.float64)
        window = (corners[..., :3] / corners[..., 3:] + 1.0) / 2.0 * [*self.viewport, 1.0]
        return {"position": window.astype(np.float32), "rgba": self.rgba, "object": self.object}
