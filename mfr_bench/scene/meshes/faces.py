"""Triangles as a mesh file gives them, before any view: what every reader returns."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

OPAQUE = 255  # an 8-bit alpha: nothing behind such a triangle is seen


@dataclass(frozen=True)
class Faces:
    """Triangles in the order of their file.

    position: float64 (n, 3, 3), corners as x y z in the file's units, counter-clockwise seen from the front.
    rgba: uint8 (n, 4), the mean colour of each triangle as stored (no conversion of sRGB), straight alpha.
    object: int32 (n,), the part of the file that a triangle belongs to: its object, group or node, from 0.
    one_sided: bool (n,), whether the material is seen from the front only.
    notes: what the reader had to simplify, one sentence each.
    """

    position: np.ndarray
    rgba: np.ndarray
    object: np.ndarray
    one_sided: np.ndarray
    notes: tuple[str, ...] = ()

    def __len__(self) -> int:
        return len(self.position)

    def moved(self, matrix: np.ndarray) -> Faces:
        """The triangles under an affine map (float64 (4, 4), column vectors); a mirror image keeps its front sides."""
        position = self.position @ matrix[:3, :3].T + matrix[:3, 3]
        if np.linalg.det(matrix[:3, :3]) < 0:
            position = position[:, (0, 2, 1)]
        return replace(self, position=position)

    def chosen(self, which: np.ndarray) -> Faces:
        """The triangles at these indices, or where a mask of bool (n,) holds, in this order."""
        return replace(self, position=self.position[which], rgba=self.rgba[which], object=self.object[which],
                       one_sided=self.one_sided[which])


NONE = Faces(np.empty((0, 3, 3)), np.empty((0, 4), np.uint8), np.empty(0, np.int32), np.empty(0, bool))


def joined(parts: Sequence[Faces], *, renumber: bool = True) -> Faces:
    """All parts, one after the other; with `renumber` no two parts share an object."""
    objects, first = [], 0
    for part in parts:
        objects.append(part.object + first)
        first += int(part.object.max(initial=-1)) + 1 if renumber else 0
    return Faces(np.concatenate([part.position for part in parts]), np.concatenate([part.rgba for part in parts]),
                     np.concatenate(objects).astype(np.int32), np.concatenate([part.one_sided for part in parts]),
                     tuple(dict.fromkeys(note for part in parts for note in part.notes)))


def bytes_of(colours: np.ndarray) -> np.ndarray:
    """uint8 of channels in [0, 1]; what lies outside is clamped, what is no number counts as 0."""
    return np.rint(255 * np.clip(np.nan_to_num(colours, nan=0.0), 0, 1)).astype(np.uint8)


def fans(counts: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Faces of polygons with `counts` corners each, as fans about their first corners.

    Returns int64 (t, 3), indices into the polygons' corners one after the other, and int64 (t,), each triangle's
    polygon. Polygons of fewer than three corners give none.
    """
    starts = np.cumsum(counts) - counts
    polygon = np.repeat(np.arange(len(counts)), np.maximum(counts - 2, 0))
    step = np.arange(len(polygon)) - np.repeat(np.cumsum(np.maximum(counts - 2, 0)) - np.maximum(counts - 2, 0),
                                               np.maximum(counts - 2, 0))
    first = starts[polygon]
    return np.stack([first, first + step + 1, first + step + 2], axis=-1), polygon
