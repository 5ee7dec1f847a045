"""Places a mesh on the screen: an orthographic or perspective camera in float64.

The camera has the axes right, up and forward. Along `direction`, up is +y (for +y and -y: -z), so that looking along
-z shows +x to the right, and what has a larger z is nearer. Window depths of a mesh lie in [1/2, 1), as those of
every slanted scene do (see scene.strips).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ..strips import FURTHEST, NEAREST

DIRECTIONS = {f"{sign}{axis}": tuple((1.0 if sign == "+" else -1.0) * (at == i) for at in range(3))
              for i, axis in enumerate("xyz") for sign in "+-"}
MARGIN = 1.02  # of the viewport to what it is fitted to
FIELD_DEGREES = 45.0  # of view, from bottom to top, where nothing else is said
ROOM = 1e-3  # of the depth range before what is nearest and behind what is furthest, so that no corner is rounded out
NEAREST_SHARE = 1e-3  # of the furthest distance, at which a perspective view begins at the latest

Vector = tuple[float, float, float]


@dataclass(frozen=True)
class DepthRange:
    """Window depths of what is nearest and of what is furthest. from_zero: clip depths go from 0 to w, not from -w."""

    nearest: float
    furthest: float
    from_zero: bool = False


HALF = DepthRange(NEAREST, FURTHEST)
# The last ends above 2^-24, below which no float32 of `scene/reversed.vert` has a mirror image from 2^-24 to 1.
DEPTH_RANGES = {"half": HALF, "whole": DepthRange(1.0 - FURTHEST, FURTHEST),
                "reversed": DepthRange(FURTHEST, 2.0**-20, True)}


@dataclass(frozen=True)
class Camera:
    """A camera that has been placed: axes are the rows right, up, forward; `eye` is (0, 0, 0) in its own space.

    Orthographic: `centre` and `half` are the middle and half the sides of the rectangle shown, in its own units.
    Perspective: the same at distance 1. `near` and `far` are the distances that become the ends of `depths`.
    """

    axes: np.ndarray
    eye: np.ndarray
    perspective: bool
    centre: tuple[float, float]
    half: tuple[float, float]
    near: float
    far: float
    depths: DepthRange = HALF

    def clip(self, position: np.ndarray) -> np.ndarray:
        """Clip coordinates float64 (…, 4) of points (…, 3)."""
        x, y, distance = np.moveaxis((position - self.eye) @ self.axes.T, -1, 0)
        w = distance if self.perspective else np.ones_like(distance)
        found = np.empty((*distance.shape, 4))
        found[..., 0] = (x - self.centre[0] * w) / self.half[0]
        found[..., 1] = (y - self.centre[1] * w) / self.half[1]
        # The depth is linear in the place, and the place · w is linear in the distance: exact behind the eye as well
        scaled = self.far * (distance - self.near) if self.perspective else distance - self.near
        at_zero, at_one = self.depths.nearest, self.depths.furthest
        window = at_zero * w + (at_one - at_zero) * scaled / (self.far - self.near)
        found[..., 2], found[..., 3] = window if self.depths.from_zero else 2.0 * window - w, w
        return found


def axes_of(forward: Vector, turn: float = 0.0) -> np.ndarray:
    """float64 (3, 3): the rows right, up and forward of a camera that looks along `forward`.

    `turn` is an angle in radians by which the camera goes around the up axis. Raises ValueError for a zero vector.
    """
    ahead = np.array(forward, dtype=np.float64)
    length = math.sqrt(float(ahead @ ahead))
    if not length:
        raise ValueError("the eye and the target are one point")
    ahead /= length
    upright = abs(ahead[1]) > 1 - 1e-12
    up = np.array([0.0, 0.0, -1.0] if upright else [0.0, 1.0, 0.0])
    if turn:
        ahead = _turned(ahead, up, turn)
    right = np.cross(ahead, up)
    right /= math.sqrt(float(right @ right))
    return np.stack([right, np.cross(right, ahead), ahead])


def _turned(vector: np.ndarray, about: np.ndarray, angle: float) -> np.ndarray:
    """Rodrigues' rotation of a vector about a unit axis."""
    cosine, sine = math.cos(angle), math.sin(angle)
    return vector * cosine + np.cross(about, vector) * sine + about * (about @ vector) * (1 - cosine)


def orthographic_camera(position: np.ndarray, size: tuple[int, int], axes: np.ndarray,
                        box: tuple[float, float, float, float] | None = None) -> Camera:
    """A camera far away.

    `box` is the rectangle x0 y0 x1 y1, in the plane across the direction, that the viewport shows; without it, it is
    the smallest one of the viewport's shape around all points (…, 3), with a margin.
    """
    points = position.reshape(-1, 3) @ axes.T
    low, high = points.min(axis=0), points.max(axis=0)
    near, far = _apart(float(low[2]), float(high[2]))
    x0, y0, x1, y1 = box or (low[0], low[1], high[0], high[1])
    centre, half = ((x0 + x1) / 2, (y0 + y1) / 2), ((x1 - x0) / 2, (y1 - y0) / 2)
    if box is None:
        half = _around(half, size)
    return Camera(axes, np.zeros(3), False, (float(centre[0]), float(centre[1])), half, near, far)


def perspective_camera(position: np.ndarray, size: tuple[int, int], axes: np.ndarray, eye: Vector | None = None,
                       field_degrees: float | None = None) -> Camera:
    """A camera at `eye`; without one, so far from the points that they fill a field of view of 45 degrees.

    `field_degrees` from bottom to top; without it the field is fitted to the points, or is 45 degrees where one of
    them is beside or behind the eye. Raises ValueError where every point is behind the eye.
    """
    points = position.reshape(-1, 3)
    if eye is None:
        middle = (points.min(axis=0) + points.max(axis=0)) / 2
        radius = math.sqrt(float(((points - middle) ** 2).sum(axis=1).max())) or 1.0
        place = middle - axes[2] * radius / math.sin(math.radians(FIELD_DEGREES / 2))
    else:
        place = np.array(eye, dtype=np.float64)
    seen = (points - place) @ axes.T
    far = float(seen[:, 2].max())
    if far <= 0:
        raise ValueError("all of the mesh is behind the eye")
    near, far = max(float(seen[:, 2].min()), far * NEAREST_SHARE) * (1 - ROOM), far * (1 + ROOM)
    centre, half = _field(seen, near, size, field_degrees)
    return Camera(axes, place, True, centre, half, near, far)


def _field(seen: np.ndarray, near: float, size: tuple[int, int],
           degrees: float | None) -> tuple[tuple[float, float], tuple[float, float]]:
    """Middle and half sides of what is shown at distance 1."""
    if degrees is None and seen[:, 2].min() >= near:
        flat = seen[:, :2] / seen[:, 2:]
        low, high = flat.min(axis=0), flat.max(axis=0)
        middle = (low + high) / 2
        return (float(middle[0]), float(middle[1])), _around((high - low) / 2, size)
    half = math.tan(math.radians((degrees or FIELD_DEGREES) / 2))
    return (0.0, 0.0), (half * size[0] / size[1], half)


def _around(half: tuple[float, float] | np.ndarray, size: tuple[int, int]) -> tuple[float, float]:
    """Half the sides of the smallest rectangle of the viewport's shape that contains one of half sides `half`."""
    scale = MARGIN * max(float(half[0]) / size[0], float(half[1]) / size[1]) or 1.0
    return scale * size[0], scale * size[1]


def _apart(near: float, far: float) -> tuple[float, float]:
    """A depth range that is not empty, with a little room on both sides."""
    room = ROOM * (far - near) or max(ROOM * abs(far), 1e-30)
    return near - room, far + room


def facing(clip: np.ndarray) -> np.ndarray:
    """float64 (n,): above 0 for triangles (n, 3, 4) whose front is seen, below for the back, 0 for an edge.

    The determinant of the corners' x, y and w has that sign wherever the corners lie, behind the eye too.
    """
    return np.linalg.det(clip[..., (0, 1, 3)])
