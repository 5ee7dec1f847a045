"""Triangles of clip space cut at the near and the far plane, in float64, as polygons in the window."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...scene.triangles import Triangles

MOST_CORNERS = 5  # of a triangle that two planes cut


@dataclass(frozen=True)
class Polygons:
    """What the depth planes leave of each triangle, in pixels from the lower left corner of the viewport.

    corners: float64 (n, 5, 2); the last one stands again where a polygon has fewer. empty: bool (n,), whether nothing
    is left. cut: bool (n,), whether a plane took something away.
    """

    corners: np.ndarray
    empty: np.ndarray
    cut: np.ndarray

    @property
    def reach(self) -> np.ndarray:
        """float64 (n,): the largest coordinate of each polygon, which scales the roundings of a device."""
        return np.abs(self.corners).max(axis=(1, 2))


def polygons(scene: Triangles) -> Polygons:
    """The polygons of a scene. A triangle that no plane cuts keeps its corners in their order."""
    clip = scene.position.astype(np.float64)
    inside = np.stack([_near(scene, clip), clip[..., 3] - clip[..., 2]]) >= 0  # (planes, n, corners)
    whole = inside.all(axis=(0, 2))
    empty = ~inside.any(axis=2).all(axis=0)
    found = np.zeros((len(clip), MOST_CORNERS, 2))
    found[whole] = window(scene, clip[whole])[:, [0, 1, 2, 2, 2]]
    for i in np.flatnonzero(~whole & ~empty):
        left = _cut(scene, clip[i])
        empty[i] = len(left) < 3
        if not empty[i]:
            at = window(scene, left)
            found[i] = at[np.minimum(np.arange(MOST_CORNERS), len(at) - 1)]
    return Polygons(found, empty, ~whole & ~empty)


def window(scene: Triangles, clip: np.ndarray) -> np.ndarray:
    """float64 (…, 2): pixels of points (…, 4) before the eye."""
    return (clip[..., :2] / clip[..., 3:] + 1.0) / 2.0 * scene.viewport


def _near(scene: Triangles, clip: np.ndarray) -> np.ndarray:
    """float64 (…): how far points lie behind the near plane, times w."""
    return clip[..., 2] if scene.geometry == "reversed" else clip[..., 2] + clip[..., 3]


def _cut(scene: Triangles, corners: np.ndarray) -> np.ndarray:
    """float64 (m, 4): the corners of what both planes leave of a triangle (Sutherland and Hodgman 1974)."""
    for place in (lambda points: _near(scene, points), lambda points: points[..., 3] - points[..., 2]):
        kept, following = place(corners), np.roll(corners, -1, axis=0)
        beyond = place(following)
        left = []
        for corner, after, here, there in zip(corners, following, kept, beyond, strict=True):
            if here >= 0:
                left.append(corner)
            if (here >= 0) != (there >= 0):
                left.append(corner + (after - corner) * here / (here - there))
        corners = np.array(left).reshape(-1, 4)
    return corners[corners[:, 3] > 0]
