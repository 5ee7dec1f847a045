"""The fragments of flat quads one by one: for scenes of many small quads, and for recordings."""

from __future__ import annotations

import numpy as np

from ..scene.geometry import Geometry
from ..scene.meshes.view import facing
from ..scene.quads import Quads
from ..scene.recording import Recording
from ..scene.triangles import Triangles
from .composite import Fragments


def fragments_of(scene: Quads) -> tuple[np.ndarray, np.ndarray]:
    """Pixel int64 (F,), row by row from the bottom, and quad int64 (F,) of each fragment, in order of submission."""
    rect = scene.rasterized.astype(np.int64)
    width, height = rect[:, 2] - rect[:, 0], rect[:, 3] - rect[:, 1]
    areas = width * height
    quad = np.repeat(np.arange(len(rect)), areas)
    step = np.arange(len(quad)) - np.repeat(np.cumsum(areas) - areas, areas)
    row, column = np.divmod(step, np.maximum(width, 1)[quad])
    pixel = (rect[quad, 1] + row) * scene.viewport[0] + rect[quad, 0] + column
    if not scene.rejects:
        return pixel, quad
    kept = scene.kept_at(pixel.astype(np.uint64), quad.astype(np.uint64))
    return pixel[kept], quad[kept]


def counts_of(scene: Quads) -> np.ndarray:
    """int64 (H, W): the fragments of each pixel."""
    width, height = scene.viewport
    return np.bincount(fragments_of(scene)[0], minlength=width * height).reshape(height, width)


def listed(scene: Quads) -> Fragments:
    """Every fragment of the quads, pixel by pixel."""
    width, height = scene.viewport
    pixel, quad = fragments_of(scene)
    by_pixel = np.argsort(pixel, kind="stable")
    counts = np.bincount(pixel, minlength=width * height).reshape(height, width)
    primitive = quad[by_pixel].astype(np.uint32)
    return Fragments.of(scene, counts, (scene.depth[primitive] + np.float32(0)).view(np.uint32), primitive)


def recorded(fragments: Fragments, scene: Geometry | None = None) -> Recording:
    """The fragments in the order of submission, those of one primitive row by row.

    scene: the same primitives with the colours that are recorded; None: those that the fragments are of.
    """
    pixel = fragments.of_pixels()
    order = np.lexsort((pixel, fragments.primitive))
    depth, primitive = fragments.depth[order].view(np.float32), fragments.primitive[order]
    masks = None if fragments.masks is None else fragments.masks[order]
    return _recording(scene or fragments.scene, pixel[order], depth, primitive, masks)


def recorded_quads(scene: Quads, msaa: int = 1) -> Recording:
    """The fragments of flat quads in the order of submission, without a device, in so many samples a pixel."""
    pixel, quad = fragments_of(scene)
    masks = None
    if msaa > 1:
        whole = np.full(len(scene), (1 << msaa) - 1, dtype=np.uint8)
        masks = getattr(scene, "coverage", whole)[quad]
    return _recording(scene, pixel, scene.depth[quad], quad, masks)


def _recording(scene: Geometry, pixel: np.ndarray, depth: np.ndarray, primitive: np.ndarray,
               masks: np.ndarray | None) -> Recording:
    """The fragments of these pixels, which are counted row by row, depths, primitives and coverage masks."""
    objects, front = getattr(scene, "object", None), getattr(scene, "front", None)
    if isinstance(scene, Triangles):
        front = facing(scene.position.astype(np.float64)) >= 0
    row, column = np.divmod(pixel, scene.viewport[0])
    return Recording(scene.viewport, np.stack([column, row], axis=-1).astype(np.int32), depth + np.float32(0),
                     scene.rgba[primitive], None if objects is None else objects[primitive],
                     None if front is None else front[primitive], masks)
