"""A frame in bands, none of which has more fragments than there is room for. Pure."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from ...errors import CapacityError

if TYPE_CHECKING:
    import numpy as np

SEGMENT = 32  # pixels of a row that are counted together: no band is smaller

Rectangle = tuple[int, int, int, int]  # left, bottom, width and height in pixels


def bands(sums: np.ndarray, region: Rectangle, room: int) -> Iterator[Rectangle]:
    """Rectangles of the region, together all that has fragments, each with at most `room`: rows, or part of one.

    sums: (H, segments of a row), the fragments of each SEGMENT pixels. Raises CapacityError where these alone are
    more than `room`.
    """
    left, bottom, columns, rows = region
    totals = sums.sum(axis=1, dtype="int64")
    for first, end in _runs(totals[bottom:bottom + rows].tolist(), room):
        y = bottom + first
        if end - first == 1 and totals[y] > room:
            yield from _pieces(sums[y].tolist(), left, y, columns, room)
        else:
            yield left, y, columns, end - first


def _pieces(row: Sequence[int], left: int, y: int, columns: int, room: int) -> Iterator[Rectangle]:
    """The bands of one row that has more fragments than there is room for."""
    if max(row) > room:
        raise CapacityError(f"{max(row)} fragments of {SEGMENT} pixels in row {y} do not fit: the budget has room for "
                            f"{max(0, room)}")
    for first, end in _runs(row, room):
        start, stop = max(left, first * SEGMENT), min(left + columns, end * SEGMENT)
        yield start, y, stop - start, 1


def _runs(counts: Sequence[int], room: int) -> Iterator[tuple[int, int]]:
    """Ranges [first, end) with fragments, as long as they fit; a count that does not is a range of its own."""
    first = held = 0
    for at, count in enumerate((*counts, room + 1)):
        if held + count > room:
            if held:
                yield first, at
            first = at
            held = 0
        held += count
