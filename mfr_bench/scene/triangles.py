"""Scenes of triangles in clip space, as meshes give them, with the opaque ones apart."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np

from .primitives import Cornered


@dataclass(frozen=True)
class Triangles(Cornered):
    """Triangles: position is float32 (n, 3, 4). object: int32 (n,), the part of the mesh that a triangle belongs to.

    opaque: float32 (m, 3, 4), corners of triangles that are drawn into a depth buffer first: fragments at or behind
    the depth that they leave are not generated. Their own colours are no part of the image.
    """

    geometry: ClassVar[str] = "triangle"
    triangles_each: ClassVar[int] = 1

    object: np.ndarray
    opaque: np.ndarray = field(default_factory=lambda: np.empty((0, 3, 4), np.float32))

    @property
    def occluded(self) -> bool:
        """Whether opaque triangles may hide fragments."""
        return len(self.opaque) > 0

    @staticmethod
    def window_depth(corners: np.ndarray) -> np.ndarray:
        """float64 (…): the window depths of corners (…, 4) in clip space."""
        return (corners[..., 2] / corners[..., 3] + 1.0) / 2.0

    def arrays(self) -> dict[str, np.ndarray]:
        """The arrays that `mfr-bench scene` writes: corners in pixels and window depth, colours, objects."""
        corners = self.position.astype(np.float64)
        window = (corners[..., :3] / corners[..., 3:] + 1.0) / 2.0 * [*self.viewport, 1.0]
        window[..., 2] = self.window_depth(corners)
        return {"position": window.astype(np.float32), "rgba": self.rgba, "object": self.object}


@dataclass(frozen=True)
class ReversedTriangles(Triangles):
    """Triangles whose window depths fall from 1 at the nearest, with clip depths from 0 to w.

    Shaders read a depth z as the float whose bits are those of 1 and of 2^-24 less those of z: it grows from the eye,
    and no two depths become one.
    """

    geometry: ClassVar[str] = "reversed"

    @property
    def depth_bounds(self) -> tuple[float, float]:
        """Depths between which the triangles lie, as shaders read them: the whole range."""
        return 0.0, 1.0

    @staticmethod
    def window_depth(corners: np.ndarray) -> np.ndarray:
        """float64 (…): the window depths of corners (…, 4) in clip space."""
        return corners[..., 2] / corners[..., 3]
