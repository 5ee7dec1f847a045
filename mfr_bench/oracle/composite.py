"""The float64 answer to a scene, computed without any method under test.

Fragments are composited front to back from their 8-bit payloads (the `over` operator of Porter and
Duff 1984, premultiplied). The screen is cut along all edges of the quads: within a patch of that grid
every pixel has the same list, so a scene without rejected fragments costs its number of patches, not of
pixels.

The depths of slanted primitives are what a device makes of them. `Fragments` holds a device's own, as
`gpu.capture` reads them back; they are sorted by depth and composited in float64 as well.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from ..effects.coverage import covered
from ..effects.rays import by_rank
from ..methods.spec import SceneStats
from ..scene.geometry import Geometry
from ..scene.quads import Quads


@dataclass(frozen=True)
class Grid:
    """Edges of the patches: pixel columns x[i]..x[i+1] and rows y[j]..y[j+1] share one list."""

    x: np.ndarray
    y: np.ndarray

    @property
    def areas(self) -> np.ndarray:
        """int (rows, columns): pixels of each patch."""
        return np.outer(np.diff(self.y), np.diff(self.x))

    def expand(self, patches: np.ndarray) -> np.ndarray:
        """Patch values (rows, columns, …) to pixel values (H, W, …)."""
        return np.repeat(np.repeat(patches, np.diff(self.y), axis=0), np.diff(self.x), axis=1)


def _grid(scene: Quads) -> Grid:
    width, height = scene.viewport
    if scene.rejects:
        return Grid(np.arange(width + 1), np.arange(height + 1))
    rect = scene.rasterized
    return Grid(np.unique(np.concatenate([[0, width], rect[:, 0], rect[:, 2]])),
                np.unique(np.concatenate([[0, height], rect[:, 1], rect[:, 3]])))


def _patch_rects(scene: Quads, grid: Grid) -> np.ndarray:
    """int (n, 4): the quads' rectangles in patches instead of pixels."""
    rect = scene.rasterized
    return np.stack([np.searchsorted(grid.x, rect[:, 0]), np.searchsorted(grid.y, rect[:, 1]),
                     np.searchsorted(grid.x, rect[:, 2]), np.searchsorted(grid.y, rect[:, 3])], axis=-1)


def fragment_counts(scene: Quads) -> np.ndarray:
    """int64 (H, W): the fragments that each pixel receives."""
    grid = _grid(scene)
    return grid.expand(_patch_counts(scene, grid))


def _patch_counts(scene: Quads, grid: Grid) -> np.ndarray:
    counts = np.zeros((len(grid.y) - 1, len(grid.x) - 1), dtype=np.int64)
    for quad, (x0, y0, x1, y1) in enumerate(_patch_rects(scene, grid)):
        counts[y0:y1, x0:x1] += _mask(scene, quad, x0, y0, x1, y1) if scene.rejects else True
    return counts


def stats_of(scene: Quads) -> SceneStats:
    """The demand of the scene on a method: its fragments, counted."""
    grid = _grid(scene)
    counts, areas = _patch_counts(scene, grid), grid.areas
    return scene_stats(scene, counts, areas)


def scene_stats(scene: Geometry, counts: np.ndarray, areas: np.ndarray | int = 1) -> SceneStats:
    """The statistics of a scene with these fragments in pixels, or in patches of these areas."""
    weights = np.broadcast_to(areas, counts.shape).ravel()
    histogram = np.bincount(counts.ravel(), weights=weights)  # float64 is exact below 2**53 pixels
    return SceneStats(
        W=scene.viewport[0], H=scene.viewport[1], n=max(1, int(counts.max())), F=int((counts * areas).sum()),
        primitives=len(scene), rejects=scene.rejects, histogram=tuple(int(h) for h in histogram),
        geometry=scene.geometry, area=scene.bounds[2] * scene.bounds[3], layers=scene.layers, reach=scene.reach,
        least=scene.least, occluded=scene.occluded, opaque_primitives=scene.opaque_primitives,
        expected=scene.expected, shading=scene.shading, effect=scene.effect)


def _mask(scene: Quads, quad: int, x0: int, y0: int, x1: int, y1: int) -> np.ndarray | bool:
    """The patches of the rectangle with the quad's fragment. Patches are pixels wherever fragments are rejected."""
    return scene.kept(quad, x0, y0, x1, y1) if scene.rejects else True


def composite(scene: Quads, layers: int | None = None, criterion: str = "nearest",
              payload: np.ndarray | None = None) -> np.ndarray:
    """float64 (H, W, 4), premultiplied over transparent black, row 0 at the bottom.

    Every fragment takes part, or with `layers` the best so many of each pixel by `criterion` (a key of CRITERIA).
    `payload`: float64 (n, 4), straight, instead of the colours of the quads.
    """
    grid = _grid(scene)
    shape = (len(grid.y) - 1, len(grid.x) - 1)
    colour = np.zeros((*shape, 3))
    transmittance = np.ones(shape)
    taken = np.zeros(shape, dtype=np.int64)
    payload = scene.rgba / 255.0 if payload is None else payload
    rects = _patch_rects(scene, grid)
    place = np.argsort(CRITERIA[criterion](scene))
    last = _last_taken(scene, grid, place, layers) if layers is not None and criterion != "nearest" else None
    for quad in scene.depth_order:
        x0, y0, x1, y1 = rects[quad]
        here = np.s_[y0:y1, x0:x1]
        mask = np.broadcast_to(_mask(scene, quad, x0, y0, x1, y1), taken[here].shape)
        if last is not None:
            mask = mask & (place[quad] <= last[here])
        elif layers is not None:
            mask = mask & (taken[here] < layers)
        alpha = np.where(mask, payload[quad, 3], 0.0)
        colour[here] += (transmittance[here] * alpha)[..., None] * payload[quad, :3]
        transmittance[here] *= 1.0 - alpha
        taken[here] += mask
    return grid.expand(np.concatenate([colour, 1.0 - transmittance[..., None]], axis=-1))


# Quad indices from the best to the worst. Fragments of equal opacity: the nearer is the better.
CRITERIA: dict[str, Callable[[Quads], np.ndarray]] = {
    "nearest": lambda scene: scene.depth_order,
    "furthest": lambda scene: scene.depth_order[::-1],
    "opaque": lambda scene: np.lexsort((scene.depth, -scene.rgba[:, 3].astype(np.int64))),
}


def _last_taken(scene: Quads, grid: Grid, place: np.ndarray, layers: int) -> np.ndarray:
    """int64 (rows, columns): the place, in the order from best to worst, of the last quad that each patch takes."""
    shape = (len(grid.y) - 1, len(grid.x) - 1)
    taken, last = np.zeros(shape, dtype=np.int64), np.full(shape, -1, dtype=np.int64)
    rects = _patch_rects(scene, grid)
    for quad in np.argsort(place):
        x0, y0, x1, y1 = rects[quad]
        here = np.s_[y0:y1, x0:x1]
        mask = np.broadcast_to(_mask(scene, quad, x0, y0, x1, y1), taken[here].shape) & (taken[here] < layers)
        last[here][mask] = place[quad]
        taken[here] += mask
    return last


CHUNK = 2**23  # fragments that are sorted or composited at once


def in_chunks(counts: np.ndarray, room: int = CHUNK) -> Iterator[tuple[slice, slice]]:
    """Ranges of pixels with at most `room` fragments, of one pixel more, and the ranges of their fragments."""
    ends = np.cumsum(counts, dtype=np.int64)
    start, before = 0, 0
    while start < len(ends):
        stop = max(start + 1, int(np.searchsorted(ends, before + room, side="right")))
        yield slice(start, stop), slice(before, int(ends[stop - 1]))
        start, before = stop, int(ends[stop - 1])


@dataclass(frozen=True)
class Fragments:
    """Every fragment of a scene, pixel by pixel, in a pixel from the nearest to the furthest.

    counts: int64 (H, W). depth: uint32 (F,), bits of the window depth. primitive: uint32 (F,). coincident: bool (H, W),
    pixels in which two fragments have one depth. masks: uint8 (F,), a bit for each sample that a fragment covers, or
    None where the payloads of the primitives are those of their fragments.
    """

    scene: Geometry
    counts: np.ndarray
    depth: np.ndarray
    primitive: np.ndarray
    coincident: np.ndarray
    masks: np.ndarray | None = None

    @classmethod
    def of(cls, scene: Geometry, counts: np.ndarray, depth: np.ndarray, primitive: np.ndarray,
           masks: np.ndarray | None = None) -> Fragments:
        """Sort fragments that come pixel by pixel, in any order within a pixel; those of one depth as submitted.

        `depth`, `primitive` and `masks` are sorted in place.
        """
        flat, found = counts.ravel(), np.zeros(counts.size, dtype=bool)
        for pixels, part in in_chunks(flat):
            order, found[pixels] = _in_order(flat[pixels], depth[part], primitive[part])
            for values in (depth, primitive, masks):
                if values is not None:
                    values[part] = values[part][order]
        return cls(scene, counts, depth, primitive, found.reshape(counts.shape), masks)

    def payloads(self, part: slice = slice(None)) -> np.ndarray:
        """uint8 (n, 4): the payloads of a range of the fragments."""
        masks = None if self.masks is None else self.masks[part]
        return covered(self.scene.rgba[self.primitive[part]], masks)

    def of_pixels(self) -> np.ndarray:
        """int64 (F,): the pixel of each fragment, row by row from the bottom."""
        return np.repeat(np.arange(self.counts.size), self.counts.ravel())

    def composite(self, layers: int | None = None, criterion: str = "nearest",
                  payload: np.ndarray | None = None) -> np.ndarray:
        """Composite every pixel, as the `composite` of a scene of flat quads does."""
        flat, payload = self.counts.ravel(), self.scene.rgba / 255.0 if payload is None else payload
        image = np.empty((flat.size, 4))
        for pixels, part in in_chunks(flat):
            counts, primitive = flat[pixels], self.primitive[part]
            if layers is not None:
                primitive = primitive[taken(counts, self.scene.rgba[primitive, 3], layers, criterion)]
                counts = np.minimum(counts, layers)
            image[pixels] = over(payload, primitive, counts)
        return image.reshape(*self.counts.shape, 4)


def _in_order(counts: np.ndarray, depth: np.ndarray, primitive: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The order of the fragments, those of each pixel by depth, then by primitive; and which pixels are coincident."""
    pixel = np.repeat(np.arange(counts.size, dtype=np.uint64), counts)
    place = pixel << np.uint64(32) | depth
    order = np.argsort(place)
    place = place[order]
    equal = np.flatnonzero(place[1:] == place[:-1])
    runs = np.union1d(equal, equal + 1)
    order[runs] = order[runs][np.lexsort((primitive[order[runs]], place[runs]))]
    coincident = np.zeros(counts.size, dtype=bool)
    coincident[pixel[equal].astype(np.int64)] = True
    return order, coincident


def taken(counts: np.ndarray, alpha: np.ndarray, layers: int, criterion: str) -> np.ndarray:
    """bool (F,): the best `layers` fragments of each pixel, of fragments in order with these alphas of 8 bits."""
    starts = np.repeat(np.cumsum(counts) - counts, counts)
    rank = np.arange(len(alpha)) - starts  # in its pixel, from the nearest
    if criterion == "furthest":
        rank = np.repeat(counts, counts) - 1 - rank
    elif criterion == "opaque":
        best = np.lexsort((rank, -alpha.astype(np.int64), starts))
        rank[best] = np.arange(len(alpha)) - starts
    return rank < layers


def over(payload: np.ndarray, primitive: np.ndarray, counts: np.ndarray) -> np.ndarray:
    """float64 (pixels, 4), premultiplied: the fragments of each pixel, nearest first, composited rank by rank."""
    colour, transmittance = np.zeros((counts.size, 3)), np.ones(counts.size)
    pixels, ranks = by_rank(counts)
    for at in ranks:
        here, left = payload[primitive[at]], len(at)
        weight = transmittance[:left] * here[:, 3]
        colour[:left] += weight[:, None] * here[:, :3]
        transmittance[:left] *= 1.0 - here[:, 3]
    found = np.empty((counts.size, 4))
    found[pixels] = np.concatenate([colour, 1.0 - transmittance[:, None]], axis=-1)
    return found
