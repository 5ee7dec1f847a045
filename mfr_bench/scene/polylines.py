"""Polylines as a file gives them: an .npz of points and lengths, or the lines of an OBJ."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np

from ..errors import UsageError
from . import npz

WANTED = "a file of strands: an .npz with points and lengths, or an OBJ with lines"
MAX_POINTS = 2**24  # 16 million: about 4 GiB as strips


@dataclass(frozen=True)
class Polylines:
    """Polylines, one after the other: points float64 (n, 3), lengths int (m,), the points of each, 2 at least."""

    points: np.ndarray
    lengths: np.ndarray

    @cached_property
    def pieces(self) -> tuple[np.ndarray, np.ndarray]:
        """The index of each piece's first point, and the number of its polyline: int64, both."""
        line = np.repeat(np.arange(len(self.lengths)), self.lengths)
        first = np.flatnonzero(line[1:] == line[:-1])
        return first, line[first]

    def tangents(self, place: np.ndarray) -> np.ndarray:
        """float64 (n, d): where a polyline through these places (n, d) heads at each, by its neighbours."""
        starts = np.cumsum(self.lengths) - self.lengths
        before, after = np.arange(len(place)) - 1, np.arange(len(place)) + 1
        before[starts] = starts
        after[starts + self.lengths - 1] = starts + self.lengths - 1
        return place[after] - place[before]


def read_polylines(path: str) -> Polylines:
    """The polylines of a file. Raises UsageError: one line that says what is wrong with it, and what is allowed."""
    reader = _of_arrays if Path(path).suffix.lower() == ".npz" else _of_lines
    points, lengths = reader(path)
    if not len(lengths):
        raise UsageError(f"{path}: it has no strands; allowed: {WANTED}")
    if len(points) > MAX_POINTS:
        raise UsageError(f"{path}: {len(points)} points; allowed: at most {MAX_POINTS}")
    if lengths.min() < 2:
        raise UsageError(f"{path}: strand {int(np.argmin(lengths))} has {int(lengths.min())} points; "
                         "allowed: 2 or more")
    wrong = ~np.isfinite(points).all(axis=1)
    if wrong.any():
        raise UsageError(f"{path}: point {int(np.argmax(wrong))} is no number; allowed: finite coordinates")
    return Polylines(points, lengths)


def _of_arrays(path: str) -> tuple[np.ndarray, np.ndarray]:
    with npz.opened(Path(path), WANTED) as found:
        missing = [name for name in ("points", "lengths") if name not in found]
        arrays = {name: found[name] for name in ("points", "lengths") if name in found}
    if missing:
        raise UsageError(f"{path}: the array {missing[0]} is missing; allowed: points and lengths")
    points, lengths = arrays["points"], arrays["lengths"]
    if points.ndim != 2 or points.shape[1] != 3 or points.dtype.kind not in "fiu":
        raise UsageError(f"{path}: points is {points.dtype} {points.shape}; allowed: numbers (n, 3)")
    if lengths.ndim != 1 or lengths.dtype.kind not in "iu" or lengths.sum() != len(points):
        raise UsageError(f"{path}: lengths is {lengths.dtype} {lengths.shape} with the sum {lengths.sum()}; allowed: "
                         f"whole numbers (m,) that add up to the {len(points)} points")
    return points.astype(np.float64), lengths.astype(np.int64)


def _of_lines(path: str) -> tuple[np.ndarray, np.ndarray]:
    """The elements `l` of an OBJ; negative indices count from the line backwards."""
    vertices: list[list[float]] = []
    index: list[int] = []
    lengths: list[int] = []
    for number, line in enumerate(Path(path).read_text(encoding="utf-8", errors="replace").splitlines(), start=1):
        words = line.split("#")[0].split()
        try:
            if words[:1] == ["v"]:
                vertices.append(_numbers(words[1:4]))
            elif words[:1] == ["l"]:
                index += [_vertex(int(word.split("/")[0]), len(vertices)) for word in words[1:]]
                lengths.append(len(words) - 1)
        except ValueError as error:
            raise UsageError(f"{path}: line {number}: {error}; allowed: v with three numbers, l with numbers of "
                             "vertices before it") from None
    return np.array(vertices, dtype=np.float64).reshape(-1, 3)[index], np.array(lengths, dtype=np.int64)


def _numbers(words: Sequence[str]) -> list[float]:
    if len(words) < 3:
        raise ValueError("a vertex of fewer than three numbers")
    return [float(word) for word in words]


def _vertex(word: int, count: int) -> int:
    at = word - 1 if word > 0 else count + word
    if word == 0 or not 0 <= at < count:
        raise ValueError(f"vertex {word} of {count}")
    return at
