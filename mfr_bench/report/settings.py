"""The settings of the papers' experiments: what a paper prints, what the config has, and why they differ.

One file, results/reference/settings.csv, a row per setting. A test compares each row that has a key with its config.
"""

from __future__ import annotations

import csv
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, fields
from functools import lru_cache

from ..config.model import Experiment
from ..errors import StoreError
from ..methods import FLOOR
from ..plan import Cell
from ..resources import reference_dir
from .data import plain
from .reference import SETTINGS

_OF_SERIES = re.compile(r"\[(?P<label>.+)\] (?P<name>\w+)")
_OF_FIGURE = re.compile(r"figure(\.(?P<index>\d+))?\.(?P<name>\w+)")


@dataclass(frozen=True)
class Setting:
    """One setting of an experiment or a method; None is what a text leaves open.

    of: name of a config, or id of a method. place: file and line of the paper's text. printed: what the paper says.
    key: where the config has it, see `value_of`. here: the value that it has. reason: why that is not what is printed.
    effect: what the difference favours, and by how much where that was measured.
    """

    of: str
    place: str
    setting: str
    printed: str | None
    key: str | None
    here: str | None
    reason: str | None
    effect: str | None


@lru_cache(maxsize=1)
def settings() -> tuple[Setting, ...]:
    """Every row, in the order of the file. Raises StoreError for a file whose columns are others."""
    path, names = reference_dir() / SETTINGS, [f.name for f in fields(Setting)]
    with open(path, newline="", encoding="utf-8") as file:
        reader = csv.DictReader(file, strict=True)
        if reader.fieldnames != names:
            raise StoreError(f"{path}: columns {reader.fieldnames}; expected {names}")
        return tuple(Setting(**{name: row[name] or None for name in names}) for row in reader)


def value_of(key: str, experiment: Experiment, cells: Iterable[Cell]) -> str:
    """The values that a config has at a key, each value once in the order of its cells: '4; 8; 16'.

    Keys are `methods` (their labels), `scene.NAME`, `measure.NAME`, `figure.NAME` (of the first figure),
    `figure.1.NAME` (of the second), `[LABEL] NAME` (a parameter of a series) and `NAME` (one of any method, or r).
    """
    cells = [cell for cell in cells if cell.method != FLOOR]
    if key == "methods":
        return _joined(entry.label for entry in experiment.methods)
    if figure := _OF_FIGURE.fullmatch(key):
        return _joined(_each(getattr(experiment.figures[int(figure["index"] or 0)], figure["name"])))
    section, _, name = key.partition(".")
    if name:
        return _joined(getattr(getattr(cell, section), name) for cell in cells)
    if key == "r":
        return _joined(experiment.sweep.get("r") or (experiment.params["r"],))
    series = _OF_SERIES.fullmatch(key)
    name = series["name"] if series else key
    return _joined(cell.params[name] for cell in cells
                   if name in cell.params and (series is None or cell.label == series["label"]))


def _each(value: object) -> Sequence[object]:
    return value if isinstance(value, tuple) else (value,)


def _joined(values: Iterable[object]) -> str:
    return "; ".join(dict.fromkeys(plain(v) for v in values))
