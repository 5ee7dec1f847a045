"""The measured cells for a paper: a LaTeX table in the manner of booktabs, and a CSV file of numbers for siunitx."""

from __future__ import annotations

import math
import os
import warnings
from collections.abc import Iterator, Sequence
from pathlib import Path

from ...environment import MIB
from ...store import ResultFolder, csv_text, write_file
from .. import data
from ..data import Point, Result
from ..latex import booktabs

MEASURES = ("time / ms", "time / floor", "memory / MiB", "largest error")
DIGITS = 3  # significant ones, where no interval says how many


def write_for_paper(folders: Sequence[ResultFolder], target: Path) -> Iterator[Path]:
    """Write a .tex and a .csv file for each result into `target`, a row for each cell that was measured.

    The files have the name of the result's folder; where several results are of one name, also those of the folders
    above it in which their places differ. Of results without a time none is written; a warning says so. Raises
    StoreError.
    """
    for folder, name in zip(folders, _names(folders), strict=True):
        result = data.load(folder)
        if all(point.row["time_ms"] is None for point in result.points):
            warnings.warn(f"{folder.path}: no table, since no cell of it has a time", stacklevel=2)
            continue
        for ending, content in _files(result).items():
            write_file(target / f"{name}.{ending}", content)
            yield target / f"{name}.{ending}"


def _names(folders: Sequence[ResultFolder]) -> list[str]:
    """A name for each folder, none twice."""
    places = [folder.path.resolve() for folder in folders]
    if len({place.name for place in places}) == len(places):
        return [place.name for place in places]
    shared = os.path.commonpath([place.parent for place in places])
    return ["-".join(place.relative_to(shared).parts) for place in places]


def _files(result: Result) -> dict[str, bytes]:
    """The contents of the files by their endings."""
    axes = [axis for axis in result.axes if data.bare(axis) != "device"]
    columns = ["method", *map(data.short, axes), *MEASURES]
    rows = [_row(point, axes) for point in result.points if point.row["time_ms"] is not None]
    title = str(result.manifest.get("title") or result.name)
    tex = booktabs(title, columns, rows, _note(result))
    csv = csv_text(columns, (dict(zip(columns, row, strict=True)) for row in rows))
    return {"tex": tex.encode(), "csv": csv}


def _note(result: Result) -> str:
    return " ".join(filter(None, ("In parentheses half of the 95 % interval, in units of the last digit.", result.scene,
                                  result.provenance)))


def _row(point: Point, axes: list[str]) -> list[str]:
    places = ["" if (value := point.at(axis)) is None else data.plain(value) for axis in axes]
    memory = point.row["memory_bytes"]
    return [point.label, *places, uncertain(*point.time_ms), uncertain(*point.floor_ratio),
            "" if memory is None else f"{memory / MIB:.{DIGITS}g}", _scientific(point.row["max_abs_error"])]


def uncertain(low: float | None, middle: float | None, high: float | None) -> str:
    """A median with half of its interval as siunitx reads it: 5.06(12) is 5.06 ± 0.12."""
    if middle is None:
        return ""
    half = None if low is None or high is None else (high - low) / 2
    if not half:
        return _plain(middle)
    decimals = max(0, 1 - math.floor(math.log10(half)))  # of two digits of the half interval
    scaled = round(half * 10**decimals)
    return f"{middle:.{decimals}f}({scaled})"


def _plain(value: float) -> str:
    decimals = max(0, DIGITS - 1 - math.floor(math.log10(abs(value)))) if value else 0
    return f"{value:.{decimals}f}"


def _scientific(value: float | None) -> str:
    return "" if value is None else "0" if value == 0 else f"{value:.1e}"
