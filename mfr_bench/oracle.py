"""The float64 answer to a scene, computed without any method under test.

Fragments are composited front to back from their 8-bit payloads (the `over` operator of Porter and
Duff 1984, premultiplied). The screen is cut along all edges of the quads: within a cell of that grid
every pixel has the same list, so a scene without rejected fragments costs its number of cells, not of
pixels.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from .methods.spec import Sizes
from .scene import Scene


@dataclass(frozen=True)
class Grid:
    """Edges of the cells: pixel columns x[i]..x[i+1] and rows y[j]..y[j+1] share one list."""

    x: np.ndarray
    y: np.ndarray

    @property
    def areas(self) -> np.ndarray:
        """int (rows, columns): pixels of each cell."""
        return np.outer(np.diff(self.y), np.diff(self.x))

    def expand(self, cells: np.ndarray) -> np.ndarray:
        """Cell values (rows, columns, …) to pixel values (H, W, …)."""
        return np.repeat(np.repeat(cells, np.diff(self.y), axis=0), np.diff(self.x), axis=1)


def _grid(scene: Scene) -> Grid:
    width, height = scene.viewport
    if scene.keep_threshold < 2**32:
        return Grid(np.arange(width + 1), np.arange(height + 1))
    rect = scene.rasterized
    return Grid(np.unique(np.concatenate([[0, width], rect[:, 0], rect[:, 2]])),
                np.unique(np.concatenate([[0, height], rect[:, 1], rect[:, 3]])))


def _cell_rects(scene: Scene, grid: Grid) -> np.ndarray:
    """int (n, 4): the quads' rectangles in cells instead of pixels."""
    rect = scene.rasterized
    return np.stack([np.searchsorted(grid.x, rect[:, 0]), np.searchsorted(grid.y, rect[:, 1]),
                     np.searchsorted(grid.x, rect[:, 2]), np.searchsorted(grid.y, rect[:, 3])], axis=-1)


def fragment_counts(scene: Scene) -> np.ndarray:
    """int64 (H, W): the fragments that each pixel receives."""
    grid = _grid(scene)
    return grid.expand(_cell_counts(scene, grid))


def _cell_counts(scene: Scene, grid: Grid) -> np.ndarray:
    counts = np.zeros((len(grid.y) - 1, len(grid.x) - 1), dtype=np.int64)
    for quad, (x0, y0, x1, y1) in enumerate(_cell_rects(scene, grid)):
        counts[y0:y1, x0:x1] += _mask(scene, quad, x0, y0, x1, y1)
    return counts


def sizes_of(scene: Scene) -> Sizes:
    """What the scene asks of a method: its fragments, counted."""
    grid = _grid(scene)
    counts, areas = _cell_counts(scene, grid), grid.areas
    histogram = np.bincount(counts.ravel(), weights=areas.ravel())  # float64 is exact below 2**53 pixels
    return Sizes(W=scene.viewport[0], H=scene.viewport[1], n=max(1, int(counts.max())), F=int((counts * areas).sum()),
                 quads=len(scene), rejects=scene.keep_threshold < 2**32, histogram=tuple(int(h) for h in histogram))


def _mask(scene: Scene, quad: int, x0: int, y0: int, x1: int, y1: int) -> np.ndarray | bool:
    """Which cells of the rectangle have the quad's fragment. Cells are pixels wherever fragments are rejected."""
    return True if scene.keep_threshold >= 2**32 else scene.kept(quad, x0, y0, x1, y1)


def composite(scene: Scene, layers: int | None = None, criterion: str = "nearest") -> np.ndarray:
    """float64 (H, W, 4), premultiplied over transparent black, row 0 at the bottom.

    Every fragment takes part, or with `layers` the best so many of each pixel by `criterion` (a key of CRITERIA).
    """
    grid = _grid(scene)
    shape = (len(grid.y) - 1, len(grid.x) - 1)
    colour = np.zeros((*shape, 3))
    transmittance = np.ones(shape)
    taken = np.zeros(shape, dtype=np.int64)
    payload = scene.rgba / 255.0
    rects = _cell_rects(scene, grid)
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
CRITERIA: dict[str, Callable[[Scene], np.ndarray]] = {
    "nearest": lambda scene: scene.depth_order,
    "furthest": lambda scene: scene.depth_order[::-1],
    "opaque": lambda scene: np.lexsort((scene.depth, -scene.rgba[:, 3].astype(np.int64))),
}


def _last_taken(scene: Scene, grid: Grid, place: np.ndarray, layers: int) -> np.ndarray:
    """int64 (rows, columns): the place, in the order from best to worst, of the last quad that each cell takes."""
    shape = (len(grid.y) - 1, len(grid.x) - 1)
    taken, last = np.zeros(shape, dtype=np.int64), np.full(shape, -1, dtype=np.int64)
    rects = _cell_rects(scene, grid)
    for quad in np.argsort(place):
        x0, y0, x1, y1 = rects[quad]
        here = np.s_[y0:y1, x0:x1]
        mask = np.broadcast_to(_mask(scene, quad, x0, y0, x1, y1), taken[here].shape) & (taken[here] < layers)
        last[here][mask] = place[quad]
        taken[here] += mask
    return last
