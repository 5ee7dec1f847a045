"""Triangles of polygons: fans of convex ones, and ears of those whose fan would cover what lies outside them."""

from __future__ import annotations

import numpy as np

from .faces import fans


def triangulated(counts: np.ndarray, place: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Triangles of polygons with `counts` corners each at places float64 (corners, 3), one polygon after the other.

    Returns int64 (t, 3), indices into the corners, and int64 (t,), each triangle's polygon, in the order of polygons.
    """
    triangles, polygon = fans(counts)
    starts = np.cumsum(counts) - counts
    for concave in np.unique(polygon[_turned(triangles, polygon, place)]):
        mine, start = polygon == concave, int(starts[concave])
        triangles[mine] = start + _ears(place[start:start + counts[concave]])
    return triangles, polygon


def _turned(triangles: np.ndarray, polygon: np.ndarray, place: np.ndarray) -> np.ndarray:
    """bool (t,): the triangles of a fan that are seen from behind where all of the polygon is seen from the front."""
    a, b, c = (place[triangles[:, at]] for at in range(3))
    normal = np.cross(b - a, c - a)
    whole = np.zeros((int(polygon.max(initial=-1)) + 1, 3))
    np.add.at(whole, polygon, normal)
    return (normal * whole[polygon]).sum(axis=1) < 0


def _ears(place: np.ndarray) -> np.ndarray:
    """int64 (corners - 2, 3): the triangles of a simple polygon (corners, 3), cut off corner by corner (Meisters 1975).

    A polygon that meets itself has no ear somewhere; its next corner is then cut off all the same.
    """
    normal = np.cross(place, np.roll(place, -1, axis=0)).sum(axis=0)
    flat = np.delete(place, int(np.argmax(np.abs(normal))), axis=1)  # seen along the axis that it is widest across
    (x, y), (next_x, next_y) = flat.T, np.roll(flat, -1, axis=0).T
    if (x * next_y - next_x * y).sum() < 0:
        flat = flat * [-1.0, 1.0]
    left, found = list(range(len(place))), []
    while len(left) > 3:
        corners = [(left[i - 1], left[i], left[(i + 1) % len(left)]) for i in range(len(left))]
        ear = next((i for i, corner in enumerate(corners) if _is_ear(flat, corner, left)), 0)
        found.append(corners[ear])
        del left[ear]
    return np.array([*found, left], dtype=np.int64)


def _is_ear(flat: np.ndarray, corner: tuple[int, int, int], left: list[int]) -> bool:
    """Whether the corner turns to the left, and no other corner lies within its triangle."""
    a, b, c = flat[list(corner)]
    if _area(a, b, c) <= 0:
        return False
    others = flat[[i for i in left if i not in corner]]
    within = np.stack([_area(p, q, others.T) for p, q in ((a, b), (b, c), (c, a))]) >= 0
    return not within.all(axis=0).any()


def _area(a: np.ndarray, b: np.ndarray, c: np.ndarray) -> np.ndarray:
    """Twice the signed area of a triangle."""
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
