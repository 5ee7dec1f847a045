"""PLY: vertices and polygons in file order, colours of vertices or faces (plyfile)."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from .faces import NONE, Faces, bytes_of
from .library import library
from .polygons import triangulated

CORNERS = ("vertex_indices", "vertex_index")
CHANNELS = ("red", "green", "blue", "alpha")


def read(path: Path) -> Faces:
    """The faces of a PLY file, polygons as triangles. Raises ValueError or IndexError for a file that does not hold."""
    plyfile = library("plyfile", path)
    try:
        data = plyfile.PlyData.read(path, mmap=False)
    except plyfile.PlyParseError as error:
        raise ValueError(str(error)) from None
    if "face" not in data or not data["face"].count:
        if "tristrips" in data:
            raise ValueError("its faces are tristrips, which are not read here; save it with faces")
        return NONE
    vertex, face = data["vertex"], data["face"]
    names = [name for name in CORNERS if name in face]
    if not names:
        raise ValueError(f"its faces have no property {' or '.join(CORNERS)}")
    lists = face[names[0]]
    counts = np.fromiter(map(len, lists), dtype=np.int64, count=len(lists))
    corner = np.concatenate(lists).astype(np.int64)
    if corner.size and (corner.min() < 0 or corner.max() >= vertex.count):
        bad = corner[(corner < 0) | (corner >= vertex.count)][0]
        raise IndexError(f"a face names vertex {bad}; it has {vertex.count}, counted from 0")
    place = np.stack([np.asarray(vertex[axis], dtype=np.float64) for axis in "xyz"], axis=-1)
    triangles, polygon = triangulated(counts, place[corner])
    index = corner[triangles]
    colours = _colours(face)
    rgba = colours[polygon] if colours is not None else _vertex_colours(vertex, index)
    return Faces(place[index], bytes_of(rgba), np.zeros(len(index), np.int32), np.zeros(len(index), bool))


def _vertex_colours(vertex, index: np.ndarray) -> np.ndarray:
    """float64 (t, 4): the mean of each triangle's corners; opaque grey where the file has no colours."""
    colours = _colours(vertex)
    return np.tile([0.7, 0.7, 0.7, 1.0], (len(index), 1)) if colours is None else colours[index].mean(axis=1)


def _colours(element) -> np.ndarray | None:
    """float64 (n, 4) in [0, 1] from red, green, blue and alpha, bytes or numbers from 0 to 1; None without them."""
    held = {prop.name for prop in element.properties}
    if not held.issuperset(CHANNELS[:3]):
        return None
    found = np.ones((element.count, 4))
    for at, name in enumerate(CHANNELS):
        if name in held:
            values = np.asarray(element[name])
            found[:, at] = values / np.iinfo(values.dtype).max if values.dtype.kind in "iu" else values
    return found
