"""Result folders: one durable file per cell, a manifest, and the CSV files derived from them.

    DIR/manifest.json       what was run, where, in which order
    DIR/cells/<key>.json    one measured cell, raw samples included; written whole, renamed into place
    DIR/cells/<key>.npz     arrays that it keeps, where its config asks for them
    DIR/unfinished.jsonl    samples of cells that are not done, while there are any (see journal)
    DIR/results.csv         a row per cell           } derived, and may be deleted
    DIR/passes.csv          a row per cell and pass  }

A cell whose scene moves, or whose method chooses k from the scene, has `frames`: for each of them frame (from 0),
fragments, covered_pixels, max_fragments, chosen_k (null where nothing is chosen), kept (fragments that the method
keeps of the frame) and histogram (pixels with 0, 1, 2, … fragments).

Two folders merge by copying their cell files. A file that cannot be used never stops a reader: it is
named in `ResultFolder.damaged`, and one that is damaged is set aside.
"""

from __future__ import annotations

import csv
import errno
import fcntl
import hashlib
import io
import json
import math
import os
import re
from collections.abc import Iterable, Mapping
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

from ..errors import StoreError, UsageError, nearest
from ..stats import median_interval

SCHEMA = 1  # 1: first layout
KEY_DIGITS = 20  # 80 bits: two of a billion cells share a key with a chance below 1e-6

STATUSES = ("ok", "wrong", "unsupported", "over_budget", "overflow", "timeout", "crashed", "out_of_memory")
FLOOR = "floor"  # id of the method whose time is every method's lower bound

Cell = dict[str, Any]
Row = dict[str, Any]


@dataclass(frozen=True)
class Column:
    """A column of a derived CSV file. `origin` is the part of the cell file that holds it."""

    name: str
    type: Literal["str", "int", "float", "bool", "json"]
    unit: str
    meaning: str
    origin: Literal["cell", "scene", "values", "joined"] = "values"


COLUMNS = (
    Column("experiment", "str", "", "name of the config", "cell"),
    Column("method", "str", "", "id of the method", "cell"),
    Column("status", "str", "", " | ".join(STATUSES), "cell"),
    Column("reason", "str", "", "why the status is not ok", "cell"),
    Column("width", "int", "pixels", "viewport width", "joined"),
    Column("height", "int", "pixels", "viewport height", "joined"),
    Column("pixel_density", "float", "", "covered pixels / all pixels, as configured", "scene"),
    Column("depth_complexity", "int", "fragments", "fragments per covered pixel, as configured", "scene"),
    Column("k", "int", "fragments", "fragments kept per pixel", "joined"),
    Column("fragment_probability", "float", "", "chance that a generated fragment is not discarded", "scene"),
    Column("order", "str", "", "submission order", "scene"),
    Column("seed", "int", "", "seed of the scene", "scene"),
    Column("params", "json", "", "every parameter of the method", "cell"),
    Column("fragments", "int", "fragments", "fragments of the frame"),
    Column("samples", "int", "", "timed frames, warm-up apart"),
    Column("timer", "str", "", "gpu (timer queries) or wall (between two finishes)"),
    Column("time_ms", "float", "ms", "whole frame, median"),
    Column("time_ms_low", "float", "ms", "lower end of the median's 95 % interval"),
    Column("time_ms_high", "float", "ms", "upper end of the median's 95 % interval"),
    Column("floor_ms", "float", "ms", "time_ms of the floor for the same scene, device and timer", "joined"),
    Column("memory_bytes", "int", "bytes", "objects that the method allocated"),
    Column("memory_model_bytes", "int", "bytes", "the same by the paper's formula"),
    Column("max_abs_error", "float", "", "largest channel error against the promised image, channels in [0,1]"),
    Column("rmse", "float", "", "root mean square error against the full list's image"),
    Column("psnr_db", "float", "dB", "peak signal-to-noise ratio against the full list's image"),
    Column("flip", "float", "", "mean FLIP error against the full list's image"),
    Column("hit_ratio", "float", "", "fragments kept / generated, counted in what the method holds after an untimed "
           "frame (as promised, by a method that holds no fragments)"),
    Column("wrong_pixels", "int", "pixels", "pixels with a channel error above 1/512"),
    Column("tied_pixels", "int", "pixels", "pixels with fragments of equal depth, left out of the errors against the "
           "promised image"),
    Column("max_error_all", "float", "", "largest channel error against the full list's image"),
    Column("wrong_pixels_all", "int", "pixels",
           "pixels with a channel error above 1/512 against the full list's image"),
    Column("label", "str", "", "name of the method in tables and figures", "cell"),
    Column("layout", "str", "", "how quads are placed", "scene"),
    Column("point", "json", "", "values of the swept keys", "cell"),
    Column("covered_pixels", "int", "pixels", "pixels with at least one fragment"),
    Column("max_fragments", "int", "fragments", "most fragments in any pixel"),
    Column("noisy", "bool", "", "the interval was still wider than asked for when time or samples ran out"),
    Column("stop_reason", "str", "", "why sampling stopped"),
    Column("repeats", "int", "frames", "frames within one sample, which is their mean: short frames need several"),
    Column("sessions", "int", "", "processes that took the samples: more than 1 where a run was resumed"),
    Column("lost_fragments", "int", "fragments", "fragments that the method counted as dropped"),
    Column("discarded_share", "float", "", "share of the fragments discarded before the store (occupancy)"),
    Column("culled_share", "float", "", "share of the fragments that never ask for the lock: discarded by early z, or "
           "refused by the test before it; counted where the map of `discarded` is kept"),
    Column("luminance_error", "float", "", "largest error of a primitive's luminance in [0,1], where payloads have two "
           "channels"),
    Column("hue_error", "float", "degrees", "mean angle between a primitive's light and that of its payload, where "
           "payloads have two channels"),
    Column("distinct_images", "int", "", "different images among those of measure.repeat_images untimed frames"),
    Column("promised_ratio", "float", "", "fragments that the method promises to keep / generated"),
    Column("geometry_passes", "int", "", "times the geometry was drawn in a frame"),
    Column("chosen_k", "int", "fragments", "k, where the method chooses it from the scene"),
    Column("error_bound", "float", "", "largest max_abs_error that rounding explains, where the method is exact"),
    Column("glsl_hash", "str", "", "hash of the shaders that ran", "cell"),
    Column("key", "str", "", "name of the cell file", "cell"),
    Column("device", "str", "", "short name of the device", "joined"),
)

PASS_COLUMNS = (
    Column("experiment", "str", "", "name of the config", "cell"),
    Column("method", "str", "", "id of the method", "cell"),
    Column("label", "str", "", "name of the method in tables and figures", "cell"),
    Column("key", "str", "", "name of the cell file", "cell"),
    Column("pass", "str", "", "name of the pass", "joined"),
    Column("order", "int", "", "position in the frame, from 0", "joined"),
    Column("samples", "int", "", "frames in which the pass was timed", "joined"),
    Column("time_ms", "float", "ms", "median", "joined"),
    Column("time_ms_low", "float", "ms", "lower end of the median's 95 % interval", "joined"),
    Column("time_ms_high", "float", "ms", "upper end of the median's 95 % interval", "joined"),
    Column("share", "float", "", "median / sum of the medians of the cell's passes", "joined"),
    Column("work", "json", "", "work of the pass in a frame by counter, where measure.counters asks for it", "joined"),
)

VALUES = {c.name: c for c in COLUMNS if c.origin == "values"}

REQUIRED: Mapping[str, type | tuple[type, ...]] = {
    "key": str, "experiment": str, "method": str, "label": str, "params": dict, "scene": dict, "measure": dict,
    "point": dict, "status": str, "values": dict,
}
TYPES: Mapping[str, tuple[type, ...]] = {"str": (str,), "int": (int,), "float": (int, float), "bool": (bool,)}
ARRAY_FILE = re.compile(rf"[0-9a-f]{{{KEY_DIGITS}}}\.npz")
KEY_FILE = re.compile(rf"[0-9a-f]{{{KEY_DIGITS}}}\.json")


def key(parts: Mapping[str, Any]) -> str:
    """Name of the cell that `parts` (JSON values) determine: 20 hexadecimal digits of a SHA-256."""
    canonical = json.dumps(parts, sort_keys=True, separators=(",", ":"), ensure_ascii=True, allow_nan=False)
    return hashlib.sha256(canonical.encode()).hexdigest()[:KEY_DIGITS]


# --- files ---------------------------------------------------------------------------------------


def write_file(path: Path, content: bytes, durable: bool = False) -> None:
    """Replace `path` by `content`, whole or not at all; with `durable`, also after a loss of power.

    Raises StoreError where the disk is full or the folder cannot be written.
    """
    part = path.with_name(f".{path.name}.{os.getpid()}.part")
    try:
        _make_folder(path.parent)
        try:
            with open(part, "wb") as file:
                file.write(content)
                file.flush()
                if durable:
                    os.fsync(file.fileno())
            os.replace(part, path)
        finally:
            part.unlink(missing_ok=True)
        if durable:
            _sync_folder(path.parent)
    except OSError as error:
        raise StoreError(unwritable(path, error)) from error


def _make_folder(folder: Path) -> None:
    """A folder that outlives a loss of power: its name is synced too, not only what it holds."""
    if not folder.is_dir():
        if folder.exists():
            raise NotADirectoryError(errno.ENOTDIR, os.strerror(errno.ENOTDIR))
        _make_folder(folder.parent)
        folder.mkdir(exist_ok=True)
        _sync_folder(folder.parent)


def _sync_folder(folder: Path) -> None:
    handle = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)


def unwritable(path: Path, error: OSError) -> str:
    """One line: which file, why not, and what to do."""
    full = error.errno in (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)
    locked = error.errno in (errno.EACCES, errno.EPERM, errno.EROFS)
    what = "free some space or " if full else "make the folder writable or " if locked else ""
    return (f"{path}: cannot be written: {error.strerror or error}; {what}choose another folder, "
            "then run the same command again: what is written stays")


def _holder(handle: int) -> str:
    """Who has the lock on an open folder, as far as the kernel tells."""
    inode = os.fstat(handle).st_ino
    with suppress(OSError):
        for line in Path("/proc/locks").read_text().splitlines():
            _, kind, _, _, pid, where, *_ = line.split()
            if kind == "FLOCK" and where.rpartition(":")[2] == str(inode) and int(pid) > 0:
                return f"process {pid}"
    return "another process"


def _plain(value: Any) -> Any:
    """JSON can hold no infinity (a PSNR without error has one) and no NaN: 'inf' and null stand for them."""
    if isinstance(value, Mapping):
        return {str(k): _plain(v) for k, v in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(v) for v in value]
    if hasattr(value, "tolist"):  # numpy scalars and arrays
        return _plain(value.tolist())
    if isinstance(value, float) and not math.isfinite(value):
        return None if math.isnan(value) else str(value)
    return value


def _text(record: Mapping[str, Any]) -> bytes:
    """JSON with one line per member: short lines for people, and a cut-off file never parses."""
    members = (f"{json.dumps(name)}: {json.dumps(value, ensure_ascii=False, allow_nan=False)}"
               for name, value in record.items())
    return ("{\n" + ",\n".join(members) + "\n}\n").encode(errors="replace")


def _refuse_constant(name: str) -> None:
    raise ValueError(f"{name} is not JSON")


def _read(path: Path) -> Any:
    """The JSON value in `path`. Raises ValueError where it holds none, OSError where it cannot be read."""
    try:
        return json.loads(path.read_bytes().decode(), parse_constant=_refuse_constant)
    except RecursionError:
        raise ValueError("nested too deeply") from None


def _is_number(value: Any) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool) and math.isfinite(value)


def is_samples(value: Any) -> bool:
    """Whether it is a list of finite numbers."""
    return isinstance(value, list) and all(map(_is_number, value))


def _fits(column: Column, value: Any) -> bool:
    if value is None or (column.type == "float" and value in ("inf", "-inf")):
        return True
    if isinstance(value, bool):
        return column.type == "bool"
    return isinstance(value, TYPES[column.type]) and (column.type == "str" or _is_number(value))


def fault(cell: Any) -> str | None:
    """What keeps `cell` from being a cell record of this schema, or None."""
    if not isinstance(cell, dict):
        return "not a cell record"
    for name, kind in REQUIRED.items():
        if not isinstance(cell.get(name), kind):
            return f"{name}: missing or of the wrong type"
    if cell["status"] not in STATUSES:
        return f"status: {cell['status']!r} unknown"
    size = cell["scene"].get("size")
    if not (isinstance(size, list) and len(size) == 2 and all(map(_is_number, size))):
        return "scene.size: not two numbers"
    wrong = [name for name, column in VALUES.items() if not _fits(column, cell["values"].get(name))]
    if wrong:
        return f"values.{wrong[0]}: not of type {VALUES[wrong[0]].type}"
    return _wrong_lists(cell)


def _wrong_lists(cell: Cell) -> str | None:
    """What keeps a cell's measurements, passes and frames from being such, or None."""
    if not all(is_samples(cell.get(name) or []) for name in ("warmup_ms", "samples_ms")):
        return "samples: not a list of numbers"
    passes, frames = cell.get("passes") or {}, cell.get("frames") or []
    if not (isinstance(passes, dict) and all(map(is_samples, passes.values()))):
        return "passes: not lists of numbers"
    if not (isinstance(frames, list) and all(isinstance(f, dict) and is_samples(f.get("histogram")) for f in frames)):
        return "frames: not a list of records with a histogram"
    return None


def _decoded(cell: Cell) -> Cell:
    values = {name: float(value) if value in ("inf", "-inf") else value for name, value in cell["values"].items()}
    return cell | {"values": values}


class ResultFolder:
    """The measurements of one config on one device. Nothing is created before the first write."""

    def __init__(self, path: str | os.PathLike[str]):
        self.path = Path(path)
        self._damaged: dict[Path, str] = {}

    @property
    def cells_path(self) -> Path:
        return self.path / "cells"

    def arrays_path(self, key: str) -> Path:
        """Where a cell keeps arrays, if it does."""
        return self.cells_path / f"{key}.npz"

    @property
    def damaged(self) -> list[str]:
        """One line for each file met so far that could not be used, and what became of it."""
        return list(self._damaged.values())

    @property
    def journal_path(self) -> Path:
        """Samples of the cells that are not done."""
        return self.path / "unfinished.jsonl"

    @contextmanager
    def lock(self):
        """Within this no other process measures into the folder, which is made where it is missing.

        The kernel ends the lock with the process. Gives None, or a line on why the file system has no locks.
        Raises StoreError where another process has the lock.
        """
        try:
            _make_folder(self.path)
            handle = os.open(self.path, os.O_RDONLY)
        except OSError as error:
            raise StoreError(unwritable(self.path / "manifest.json", error)) from error
        try:
            yield self._locked(handle)
        finally:
            os.close(handle)

    def _locked(self, handle: int) -> str | None:
        try:
            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            raise StoreError(f"{self.path}: {_holder(handle)} measures into this folder; wait for its end, "
                             "or choose another folder") from None
        except OSError as error:
            return f"{self.path}: cannot be locked ({error.strerror}): let no other run write to it"
        return None

    def write_cell(self, cell: Mapping[str, Any]) -> None:
        """Store a cell durably. Raises StoreError (disk), ValueError (a record that no reader would take)."""
        record = {"schema": SCHEMA} | _plain(cell)
        unknown = [name for name in record.get("values", {}) if name not in VALUES]
        if unknown:
            raise ValueError(f"values.{unknown[0]}: no such column{nearest(unknown[0], VALUES)}")
        wrong = fault(record) or ("" if KEY_FILE.fullmatch(f"{record['key']}.json") else "key: not a cell key")
        if wrong:
            raise ValueError(wrong)
        path = self.cells_path / f"{record['key']}.json"
        write_file(path, _text(record), durable=True)
        self._damaged.pop(path, None)

    def has(self, key: str) -> bool:
        """Whether a usable record of the cell exists."""
        return self.cell(key) is not None

    def cell(self, key: str) -> Cell | None:
        """The record of a cell, or None where there is none that can be used."""
        path = self.cells_path / f"{key}.json"
        try:
            cell = _read(path)
        except FileNotFoundError:
            return None
        except OSError as error:
            return self.skip(path, f"cannot be read: {error.strerror}")
        except ValueError as error:
            return self._set_aside(path, f"not JSON: {error}")
        if isinstance(cell, dict) and cell.get("schema") != SCHEMA:
            return self.skip(path, f"has schema {cell.get('schema')!r}, this program reads {SCHEMA}")
        wrong = fault(cell)
        if wrong is None and cell["key"] != key:
            wrong = f"is the record of {cell['key']}"
        return self._set_aside(path, wrong) if wrong else _decoded(cell)

    def cells(self) -> list[Cell]:
        """Every usable cell: those of the manifest in its order, then the others by key."""
        try:
            names = sorted(entry.name for entry in os.scandir(self.cells_path) if not entry.name.startswith("."))
        except FileNotFoundError:
            names = []
        except OSError as error:
            raise StoreError(f"{self.cells_path}: cannot be read: {error.strerror}") from error
        found = []
        for name in names:
            if KEY_FILE.fullmatch(name):
                found.append(name.removesuffix(".json"))
            elif not name.endswith(".damaged") and not ARRAY_FILE.fullmatch(name):
                self.skip(self.cells_path / name, "not named as a cell file")
        planned = {k: i for i, k in enumerate(map(str, self.manifest().get("cells", [])))}
        found.sort(key=lambda k: (planned.get(k, len(planned)), k))
        return [cell for cell in map(self.cell, found) if cell is not None]

    def write_manifest(self, manifest: Mapping[str, Any]) -> None:
        """Replace manifest.json. Raises StoreError."""
        path = self.path / "manifest.json"
        write_file(path, _text({"schema": SCHEMA} | _plain(manifest)), durable=True)
        self._damaged.pop(path, None)

    def manifest(self) -> dict[str, Any]:
        """What manifest.json holds; empty where there is none that can be used."""
        path = self.path / "manifest.json"
        try:
            manifest = _read(path)
        except FileNotFoundError:
            return {}
        except (OSError, ValueError) as error:
            self.skip(path, f"cannot be read: {error}")
            return {}
        if not (isinstance(manifest, dict) and manifest.get("schema") == SCHEMA
                and isinstance(manifest.get("cells", []), list)):
            self.skip(path, f"not a manifest of schema {SCHEMA}")
            return {}
        return manifest

    def skip(self, path: Path, why: str) -> None:
        """Name a file that is left in place and not used."""
        self._damaged[path] = f"{path}: {why}; left in place, not used"

    def _set_aside(self, path: Path, why: str) -> None:
        aside = path.with_name(f"{path.name}.damaged")
        try:
            os.replace(path, aside)
            self._damaged[path] = f"{path}: {why}; set aside as {aside.name}"
        except OSError:
            self.skip(path, why)


def find_results(paths: Iterable[str | os.PathLike[str]]) -> list[Path]:
    """Every folder with a manifest.json at or below `paths`, sorted within each, none twice.

    Raises UsageError for each path that does not exist or has no results.
    """
    found: dict[Path, None] = {}
    mistakes = []
    for start in map(Path, paths):
        below = sorted(_manifests(start))
        found.update(dict.fromkeys(below))
        if not start.is_dir():
            mistakes.append(f"{start}: no such folder; allowed: a folder that 'mfr-bench run' wrote, or one above such")
        elif not below:
            mistakes.append(f"{start}: no results in or below it; allowed: a folder that 'mfr-bench run' wrote, "
                            "or one above such")
    if mistakes:
        raise UsageError(mistakes)
    return list(found)


def _manifests(start: Path) -> Iterable[Path]:
    for folder, below, files in os.walk(start):
        below[:] = [name for name in below if name != "cells" and not name.startswith(".")]
        if "manifest.json" in files:
            yield Path(folder)


# --- derived rows --------------------------------------------------------------------------------


def device_name(cell: Mapping[str, Any]) -> str | None:
    device = cell.get("device")
    return device.get("slug") or device.get("renderer") if isinstance(device, dict) else device


def _floor_key(cell: Mapping[str, Any]) -> str:
    return json.dumps([device_name(cell), cell["values"].get("timer"), cell["scene"]], sort_keys=True)


class Floors:
    """The floor's cell for the scene, device and timer of any other cell."""

    def __init__(self, cells: Iterable[Cell]):
        measured = [c for c in cells if c["method"] == FLOOR and c["values"].get("time_ms") is not None]
        self._cells = {_floor_key(c): c for c in reversed(measured)}

    def of(self, cell: Cell) -> Cell | None:
        return self._cells.get(_floor_key(cell))


def result_rows(cells: Iterable[Cell]) -> list[Row]:
    """A row of results.csv per cell, by column name. What was not measured is None."""
    cells = list(cells)
    floors = Floors(cells)
    return [_result_row(cell, floors.of(cell)) for cell in cells]


def _result_row(cell: Cell, floor: Cell | None) -> Row:
    width, height = cell["scene"]["size"]
    joined = {"width": width, "height": height, "k": cell["params"].get("k", cell["values"].get("chosen_k")),
              "device": device_name(cell),
              "floor_ms": floor["values"]["time_ms"] if floor else None}
    origins = {"cell": cell, "scene": cell["scene"], "values": cell["values"], "joined": joined}
    return {c.name: origins[c.origin].get(c.name) for c in COLUMNS}


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
    writer.writerows([_field(row.get(name)) for name in columns] for row in rows)
    return text.getvalue().encode(errors="replace")


def _field(value: Any) -> str:
    if value is None:
        return ""
    if isinstance(value, (bool, dict, list)):
        return json.dumps(value, ensure_ascii=False)
    return repr(value) if isinstance(value, float) else str(value)


def derive(folder: ResultFolder) -> None:
    """Write results.csv and passes.csv from the folder's cells. Raises StoreError."""
    cells = folder.cells()
    for name, columns, rows in (("results.csv", COLUMNS, result_rows(cells)),
                                ("passes.csv", PASS_COLUMNS, pass_rows(cells))):
        write_file(folder.path / name, csv_text([c.name for c in columns], rows))
