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

    def arrays(self) -> dict[str, np.ndarray]:
        """The arrays that `mfr-bench scene` writes: corners in pixels and window depth, colours, objects."""
        corners = self.position.astype(np.float64)
        window = (corners[..., :3] / corners[..., 3:] + 1.0) / 2.0 * [*self.viewport, 1.0]
        return {"position": window.astype(np.float32), "rgba": self.rgba, "object": self.object}
