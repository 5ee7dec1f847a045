"""The numbers that the papers print, as results/reference has them: one CSV file per paper, a row per number."""

from __future__ import annotations

import csv
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

from ..errors import StoreError
from ..resources import reference_dir

SETTINGS = "settings.csv"  # beside the files of numbers, see report.settings
COLUMNS: Mapping[str, type] = {
    "paper": str, "figure": str, "section": str, "quantity": str, "method": str, "name": str, "width": int,
    "height": int, "pixel_density": float, "fragment_probability": float, "n": int, "k": int, "fragments": int,
    "condition": str, "value": float, "bound": str, "unit": str, "formula": str, "recomputed": float, "device": str,
    "note": str,
}


@dataclass(frozen=True)
class Printed:
    """One printed number with the conditions it was printed for; None is what a paper leaves open.

    `method` is the id of the method here, `name` the paper's; `bound` says how `value` is meant (about, from, to,
    up to, above, below). `formula` and `recomputed` are what the number follows from, see results/reference/README.md.
    """

    paper: str
    figure: str | None
    section: str | None
    quantity: str
    method: str | None
    name: str | None
    width: int | None
    height: int | None
    pixel_density: float | None
    fragment_probability: float | None
    n: int | None
    k: int | None
    fragments: int | None
    condition: str | None
    value: float | None
    bound: str | None
    unit: str | None
    formula: str | None
    recomputed: float | None
    device: str | None
    note: str | None


@lru_cache(maxsize=1)
def printed() -> tuple[Printed, ...]:
    """Every row of every paper, in the order of the files. Raises StoreError for a file that cannot be used."""
    files = [path for path in sorted(reference_dir().glob("*.csv")) if path.name != SETTINGS]
    return tuple(row for path in files for row in _rows(path))


def find(**where: Any) -> list[Printed]:
    """The rows whose columns have these values: find(paper="kplus2015", quantity="words_per_pixel")."""
    return [row for row in printed() if all(getattr(row, name) == value for name, value in where.items())]


def _rows(path) -> Iterator[Printed]:
    with open(path, newline="", encoding="utf-8") as file:
        reader = csv.DictReader(file, strict=True)
        if reader.fieldnames != list(COLUMNS):
            raise StoreError(f"{path}: columns {reader.fieldnames}; expected {list(COLUMNS)}")
        for row in reader:
            yield _row(row, f"{path}:{reader.line_num}")


def _row(row: Mapping[str, str], where: str) -> Printed:
    try:
        return Printed(**{name: kind(row[name]) if row[name] else None for name, kind in COLUMNS.items()})
    except (TypeError, ValueError) as error:
        raise StoreError(f"{where}: {error}") from error
