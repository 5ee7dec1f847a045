"""The rows of results.csv and passes.csv, derived from the cells of a folder."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from ..effects import PLAIN
from ..methods import FLOOR
from ..stats import median_interval
from .columns import COLUMNS, PASS_COLUMNS
from .files import write_file
from .folder import ResultFolder
from .record import PACKAGES, Cell, places

Row = dict[str, Any]
ORIGINS = tuple((column.name, column.origin) for column in COLUMNS)
WRITTEN = frozenset((str, int, float, type(None)))  # types whose values the writer of CSV turns into text by itself


def device_name(cell: Mapping[str, Any]) -> str | None:
    device = cell.get("device")
    return device.get("slug") or device.get("renderer") if isinstance(device, dict) else device


def package_name(cell: Mapping[str, Any]) -> str | None:
    """Name, version and hash of each package that brings the cell's method, effect or scene; None without any."""
    found = [package_text(package) for part in PACKAGES if isinstance(package := cell.get(part), Mapping)]
    return "; ".join(dict.fromkeys(found)) or None


def package_text(package: Mapping[str, Any]) -> str:
    """Name, version and hash of a package from outside."""
    return " ".join(str(package[part]) for part in ("name", "version", "hash") if package.get(part))


class Texts:
    """The JSON texts of values, names in order: one that several records share, such as a scene, is written once."""

    def __init__(self) -> None:
        self._written: dict[int, tuple[Any, str]] = {}  # by identity, with the value: no other has it meanwhile

    def of(self, value: Any) -> str:
        """The text; equal values have equal ones."""
        found = self._written.get(id(value))
        if found is None:
            found = self._written[id(value)] = value, json.dumps(value, sort_keys=True)
        return found[1]


class Floors:
    """The floor's cell for the scene, device and timer of any other cell."""

    def __init__(self, cells: Iterable[Cell]):
        self._texts = Texts()
        measured = [c for c in cells if c["method"] == FLOOR and c["values"].get("time_ms") is not None]
        self._cells = {self._key(c): c for c in reversed(measured)}

    def of(self, cell: Cell) -> Cell | None:
        return self._cells.get(self._key(cell))

    def _key(self, cell: Cell) -> tuple[str | None, ...]:
        return device_name(cell), cell["values"].get("timer"), self._texts.of(cell["scene"])


def result_rows(cells: Iterable[Cell]) -> list[Row]:
    """A row of results.csv per cell, by column name. What was not measured is None."""
    cells = list(cells)
    floors = Floors(cells)
    return [_result_row(cell, floors.of(cell)) for cell in cells]


def _result_row(cell: Cell, floor: Cell | None) -> Row:
    width, height = cell["scene"]["size"]
    joined = {"width": width, "height": height, "k": cell["params"].get("k", cell["values"].get("chosen_k")),
              "msaa": cell["scene"].get("msaa", PLAIN.msaa), "device": device_name(cell), "package": package_name(cell),
              "floor_ms": floor["values"]["time_ms"] if floor else None}
    origins = {"cell": cell, "scene": cell["scene"], "values": cell["values"], "joined": joined}
    return {name: origins[origin].get(name) for name, origin in ORIGINS}


def pass_rows(cells: Iterable[Cell]) -> list[Row]:
    """A row of passes.csv per cell and timed pass, by column name."""
    return [row for cell in cells for row in _pass_rows(cell)]


def _pass_rows(cell: Cell) -> list[Row]:
    timed = {name: samples for name, samples in (cell.get("passes") or {}).items() if samples}
    intervals = {name: median_interval(samples) for name, samples in timed.items()}
    total = sum(median for _, median, _ in intervals.values())
    rows = []
    for order, (name, (low, median, high)) in enumerate(intervals.items()):
        joined = {"pass": name, "order": order, "samples": len(timed[name]), "time_ms": median, "time_ms_low": low,
                  "time_ms_high": high, "share": median / total if total else None,
                  "work": (cell.get("work") or {}).get(name)}
        rows.append({c.name: (cell if c.origin == "cell" else joined).get(c.name) for c in PASS_COLUMNS})
    return rows


def csv_text(columns: Iterable[str], rows: Iterable[Mapping[str, Any]]) -> bytes:
    """CSV as bytes: None is an empty field, a truth value true or false, a structure its JSON."""
    columns = list(columns)
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(columns)
    structures: dict[int, tuple[Any, str]] = {}  # what rows share is written once; see `Texts`
    for row in rows:
        values = map(row.get, columns)
        writer.writerow([value if type(value) in WRITTEN else _field(value, structures) for value in values])
    return text.getvalue().encode(errors="replace")


def _field(value: Any, structures: dict[int, tuple[Any, str]]) -> str:
    if not isinstance(value, (bool, dict, list)):
        return repr(value) if isinstance(value, float) else str(value)
    if id(value) not in structures:
        structures[id(value)] = value, json.dumps(value, ensure_ascii=False)
    return structures[id(value)][1]


def derive(folder: ResultFolder, cells: Sequence[Cell] | None = None) -> None:
    """Write results.csv and passes.csv from the folder's cells, which are read unless given. Raises StoreError."""
    cells = [each for cell in (folder.cells() if cells is None else cells) for each in places(cell)]
    for name, columns, rows in (("results.csv", COLUMNS, result_rows(cells)),
                                ("passes.csv", PASS_COLUMNS, pass_rows(cells))):
        write_file(folder.path / name, csv_text([c.name for c in columns], rows))
