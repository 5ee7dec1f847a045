"""The record of a cell: its key, its JSON text, and what keeps a text from being a usable record."""

from __future__ import annotations

import hashlib
import json
import math
import re
from collections.abc import Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Any

from . import columns
from .columns import Column
from .status import STATUSES

SCHEMA = 1
HISTORY = {  # of the format: a new schema is one that programs of the one before cannot read
    1: "the first layout. Added since, and missing in earlier folders: `cells.zip` (the packed form), `methods` in the "
       "manifest, `tables/summary.csv` (before: `tables/results.csv`). `also` of a cell: "
       "further places, each a label and a point, of entries of the config that meet in it. `failed_trials` of a cell: "
       "the self-tests that its device fails, for which it is unsupported. "
       "`lost_fragments` was the sum of all frames. `tied_error` and `order_error`: before, `max_abs_error` left out "
       "all pixels with equal depths in scenes that a device rasterizes, and none on flat quads. `max_error_all` and "
       "`wrong_pixels_all`, later `rmse`, `psnr_db` and `flip`: before, equal depths had the order of submission.",
}
NODE = ("uuid", "pci")  # of a device: they tell one of a kind from another
NUMBERS = frozenset((int, float))  # the types of numbers in JSON; a truth value is of another
LARGEST = 1e18  # of a number in a cell or a manifest; what is larger overflows in sums and squares
KEY_DIGITS = 20  # 80 bits: two of a billion cells share a key with a chance below 1e-6

Cell = dict[str, Any]

REQUIRED: Mapping[str, type | tuple[type, ...]] = {
    "key": str, "experiment": str, "method": str, "label": str, "params": dict, "scene": dict, "measure": dict,
    "point": dict, "status": str, "values": dict,
}
TYPES: Mapping[str, tuple[type, ...]] = {"str": (str,), "int": (int,), "float": (int, float), "bool": (bool,)}
AMOUNTS = ("ms", "bytes", "pixels", "fragments", "frames")  # units of what is never negative
ARRAY_FILE = re.compile(rf"[0-9a-f]{{{KEY_DIGITS}}}\.npz")
FIRST_MEMBER = re.compile(rb'\{\s*"schema": (\d{1,9}),')  # as `text` writes it
MEMBER = re.compile(r'"([a-z_]+)": ')  # the start of a line that `text` writes
# Members that are alike in many records of a folder.
ALIKE = frozenset(("schema", "experiment", "label", "point", "method", "params", "scene", "measure", "status",
                   "glsl_hash", "device"))
TRIAL_IN_REASON = re.compile(r"fails the trial '([^']+)' .*; see mfr-bench doctor, and measure again once the device "
                             r"passes$", re.DOTALL)
KEY_FILE = re.compile(rf"[0-9a-f]{{{KEY_DIGITS}}}\.json")


def is_cell_file(name: str) -> bool:
    """Whether a file of this name contains a cell or its arrays."""
    return bool(KEY_FILE.fullmatch(name) or ARRAY_FILE.fullmatch(name))


# The text of a JSON value that equal values share: names in order, no blanks, ASCII.
canonical = json.JSONEncoder(sort_keys=True, separators=(",", ":"), ensure_ascii=True, allow_nan=False).encode


def key(parts: Mapping[str, Any], texts: Mapping[str, str] = MappingProxyType({})) -> str:
    """Name of the cell that `parts` (JSON values) determine: 20 hexadecimal digits of a SHA-256.

    texts: of further parts, their `canonical` texts.
    """
    every = {name: canonical(value) for name, value in parts.items()} | texts
    text = ",".join(f"{canonical(name)}:{every[name]}" for name in sorted(every))
    return hashlib.sha256(f"{{{text}}}".encode()).hexdigest()[:KEY_DIGITS]


GUARDS = ("hard_limit_s", "hard_limit_mb", "wait_s")  # settings that change no number of a cell that ends well


SAMPLES = ("warmup_ms", "samples_ms", "aside_ms", "references_ms")  # lists of times in ms
PACKAGES = ("package", "effect_package", "scene_package")  # from outside: of a cell's method, effect and scene


def cell_key(cell: Mapping[str, Any], timer: str) -> str:
    """The key of a cell: its method with GLSL and parameters, scene, settings, device, driver and timer.

    `cell` is a record, or what it will hold: `method`, `params`, `glsl_hash`, `scene`, `measure`, `device` (`renderer`,
    `version`), and `package` (`name`, `hash`) where a package from outside brings the method, `effect_package` and
    `scene_package` where one brings the effect of the scene, or makes it. Labels, points, UUIDs and the version of a
    package are no part.
    """
    return key_with(cell, timer, canonical(cell["scene"]), settings_text(cell["measure"]))


def settings_text(measure: Mapping[str, Any]) -> str:
    """The measurement settings as a key covers them, in the text that equal ones share."""
    return canonical({name: value for name, value in measure.items() if name not in GUARDS})


def key_with(cell: Mapping[str, Any], timer: str, scene: str, settings: str) -> str:
    """`cell_key` with the texts of the scene and the settings, which many cells share."""
    device = cell.get("device")
    device = device if isinstance(device, Mapping) else {}
    outside = {part: [package["name"], package["hash"]] for part in PACKAGES if (package := cell.get(part))}
    return key({**outside, "method": cell["method"], "params": cell["params"], "glsl": cell.get("glsl_hash"),
                "renderer": device.get("renderer"), "version": device.get("version"), "timer": timer},
               {"scene": scene, "measure": settings})


def plain(value: Any) -> Any:
    """JSON can hold no infinity (a PSNR without error has one) and no NaN: 'inf' and null stand for them."""
    if isinstance(value, Mapping):
        return {str(k): plain(v) for k, v in value.items()}
    if isinstance(value, (list, tuple)):
        return [plain(v) for v in value]
    if hasattr(value, "tolist"):  # numpy scalars and arrays
        return plain(value.tolist())
    if isinstance(value, float) and not math.isfinite(value):
        return None if math.isnan(value) else str(value)
    return value


def text(record: Mapping[str, Any]) -> bytes:
    """JSON with one line per member: short lines for people, and a cut-off file never parses."""
    members = (f"{json.dumps(name)}: {json.dumps(value, ensure_ascii=False, allow_nan=False)}"
               for name, value in record.items())
    return ("{\n" + ",\n".join(members) + "\n}\n").encode(errors="replace")


def _refuse_constant(name: str) -> None:
    raise ValueError(f"{name} is not JSON")


_DECODER = json.JSONDecoder(parse_constant=_refuse_constant)


def parsed(content: bytes, shared: Shared | None = None) -> Any:
    """The JSON value in a file's content. Raises ValueError if it has none.

    shared: of the records of a folder; members that are alike in many of them are then one object, which all who read
    leave as it is.
    """
    try:
        written = content.decode()
        value = None if shared is None else shared.record(written)
        value = _DECODER.decode(written) if value is None else value
        if b"\\" in content and b"\\ud" in content.lower():
            json.dumps(value, ensure_ascii=False).encode()  # half of a pair, escaped, is a text that nothing can print
    except RecursionError:
        raise ValueError("nested too deeply") from None
    return value


class Shared:
    """Reads the records of a folder as `text` wrote them, a member a line: one that many have is parsed once."""

    def __init__(self) -> None:
        self._members: dict[str, tuple[str, Any]] = {}  # by line

    def record(self, written: str) -> Cell | None:
        """The record, or None where the text has another form: then it is to be parsed as a whole."""
        if not (written.startswith("{\n") and written.endswith("\n}\n")):
            return None
        lines = written[2:-3].split(",\n")
        members = [self._members.get(line) or self._member(line) for line in lines]
        found = {} if None in members else dict(members)
        return found if len(found) == len(lines) else None

    def _member(self, line: str) -> tuple[str, Any] | None:
        """The name and the value that a line has; None where it is no whole member."""
        name = MEMBER.match(line)
        if name is None:
            return None
        try:
            value, end = _DECODER.scan_once(line, name.end())
        except (StopIteration, ValueError):
            return None
        if end != len(line):
            return None
        if name[1] in ALIKE:
            self._members[line] = name[1], value
        return name[1], value


def read(path: Path) -> Any:
    """The JSON value in `path`. Raises ValueError if it has none, OSError if it cannot be read."""
    return parsed(path.read_bytes())


def schema_of(content: bytes) -> int | None:
    """The schema of a file of this or another version; None where it says none."""
    found = FIRST_MEMBER.match(content)
    if found:
        return int(found[1])
    try:
        record = parsed(content)
    except ValueError:
        return None
    schema = record.get("schema") if isinstance(record, dict) else None
    return schema if isinstance(schema, int) else None


def flat(value: Any) -> bool:
    """Whether it is null, a text, a truth value, a number, or a list of such."""
    return all(map(_scalar, value)) if isinstance(value, list) else _scalar(value)


def _scalar(value: Any) -> bool:
    return value is None or isinstance(value, (str, bool)) or is_number(value)


def is_number(value: Any) -> bool:
    """Whether it is a number that a measurement can give."""
    return type(value) in NUMBERS and abs(value) <= LARGEST


def is_samples(value: Any) -> bool:
    """Whether it is a list of times or counts."""
    return _is_numbers(value) and all(map((0.0).__le__, value))


def _is_numbers(value: Any) -> bool:
    """Whether it is a list of numbers; compared in C, since collections have millions."""
    return (isinstance(value, list) and NUMBERS.issuperset(map(type, value))
            and all(map(LARGEST.__ge__, value)) and all(map((-LARGEST).__le__, value)))


def _fits(column: Column, value: Any) -> bool:
    if value is None or (column.type == "float" and value in ("inf", "-inf")):
        return True
    if isinstance(value, bool):
        return column.type == "bool"
    return isinstance(value, TYPES[column.type]) and (
        column.type == "str" or (is_number(value) and (column.unit not in AMOUNTS or value >= 0)))


def other_schema(cell: Any) -> str | None:
    """The schema of a record, in words, if it is another than this program's."""
    if isinstance(cell, dict) and cell.get("schema") != SCHEMA:
        return f"has schema {cell.get('schema')!r}, this program reads {SCHEMA}"
    return None


def fault(cell: Any, key: str | None = None) -> str | None:
    """The reason, in words, why `cell` is no valid record of this schema, or not that of `key`; None if it is."""
    if not isinstance(cell, dict):
        return "not a cell record"
    for name, kind in REQUIRED.items():
        if not isinstance(cell.get(name), kind):
            return f"{name}: missing or of the wrong type"
    if cell["status"] not in STATUSES:
        return f"status: {cell['status']!r} unknown"
    size = cell["scene"].get("size")
    if not (isinstance(size, list) and len(size) == 2 and all(map(is_number, size))):
        return "scene.size: not two numbers"
    wrong = _wrong_values(cell) or _wrong_parts(cell) or _wrong_lists(cell)
    return wrong if wrong or key in (None, cell["key"]) else f"is the record of {cell['key']}"


def _wrong_values(cell: Cell) -> str | None:
    """The first value of a cell that is not of its column's type, or outside its interval; None if all are right."""
    known = columns.VALUES
    wrong = [known[name] for name, value in cell["values"].items()
             if value is not None and name in known and not _fits(known[name], value)]
    if wrong:
        return f"values.{wrong[0].name}: not of type {wrong[0].type}, or negative"
    interval = [cell["values"].get(name) for name in ("time_ms_low", "time_ms", "time_ms_high")]
    times = [float(value) for value in interval if value is not None]
    return None if times == sorted(times) else "values.time_ms: outside time_ms_low to time_ms_high"


def _is_package(value: Any) -> bool:
    """Whether it is the record of a package from outside, or none."""
    return value is None or (isinstance(value, dict)
                             and all(isinstance(value.get(part), str) for part in ("name", "hash")))


def _wrong_parts(cell: Cell) -> str | None:
    """The first of a cell's parameters, place and other parts that is not of its type; None if all are."""
    params, point = cell["params"], cell["point"]
    wrong = [f"params.{name}" for name, value in params.items()
             if not isinstance(value, (str, bool)) and not is_number(value)]
    pairs = {name: cell["scene"].get(name) for name in ("alpha", "quad_size")}
    wrong += [f"scene.{name}" for name, pair in pairs.items()
              if isinstance(pair, list) and not (len(pair) == 2 and _is_numbers(pair))]
    wrong += [f"point.{name}" for name, value in point.items() if not flat(value)]
    wrong += [f"measure.{name}" for name, value in cell["measure"].items() if not flat(value)]
    wrong += [f"measure.{name}" for name in ("min_samples", "max_samples")
              if not is_number(cell["measure"].get(name, 0))]
    wrong += [name for name in ("reason", "glsl_hash", "measured") if not isinstance(cell.get(name), (str, type(None)))]
    wrong += [name for name in ("buffers", "work") if not isinstance(cell.get(name), (dict, type(None)))]
    wrong += [name for name in PACKAGES if not _is_package(cell.get(name))]
    trials = cell.get("failed_trials")
    if not (trials is None or (isinstance(trials, list) and all(isinstance(name, str) for name in trials))):
        wrong.append("failed_trials")
    device = cell.get("device")
    if not (device is None or isinstance(device, str)
            or (isinstance(device, dict) and all(isinstance(v, (str, type(None))) for v in device.values()))):
        wrong.append("device")
    return f"{wrong[0]}: missing or of the wrong type" if wrong else None


def _wrong_lists(cell: Cell) -> str | None:
    """The first of a cell's samples, passes, frames and further places that is not of its type; None if all are."""
    if not all(is_samples(cell.get(name) or []) for name in SAMPLES):
        return "samples: not a list of numbers"
    passes, frames = cell.get("passes") or {}, cell.get("frames") or []
    if not (isinstance(passes, dict) and all(map(is_samples, passes.values()))):
        return "passes: not lists of numbers"
    if not (isinstance(frames, list) and all(isinstance(f, dict) and _is_numbers(f.get("histogram")) for f in frames)):
        return "frames: not a list of records with a histogram"
    also = cell.get("also") or []
    if not (isinstance(also, list) and all(map(_is_place, also))):
        return "also: not a list of places with label and point"
    return None


def failed_trials(cell: Mapping[str, Any]) -> list[str]:
    """The self-tests that the cell's device fails, for which the cell is unsupported; empty where it is not for that.

    A record of before this member names one of them in its reason.
    """
    before = TRIAL_IN_REASON.search(str(cell.get("reason") or ""))
    return list(cell.get("failed_trials") or (before.groups() if before else ()))


def places(cell: Cell) -> list[Cell]:
    """The cell at each of its places: its own label and point, then those in `also`, which other entries gave it."""
    bare = {name: value for name, value in cell.items() if name != "also"}
    return [bare, *(bare | place for place in cell.get("also") or ())]


def _is_place(value: Any) -> bool:
    return (isinstance(value, dict) and isinstance(value.get("label"), str) and isinstance(value.get("point"), dict)
            and all(map(flat, value["point"].values())))


def decoded(cell: Cell) -> Cell:
    values = {name: float(value) if value in ("inf", "-inf") else value for name, value in cell["values"].items()}
    return cell | {"values": values}
