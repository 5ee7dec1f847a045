"""Checks a bundle's results against themselves, against what a device can do, and against other devices."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ..config.json_schema import parse
from ..effects import OWN_EFFECTS, PLAIN
from ..environment import draws_in_software
from ..errors import UsageError
from ..merge.copies import Copy, Source, device_of
from ..methods import FLOOR, catalog
from ..plan import expected_stats
from ..scene import Scene, generate
from ..scene.kinds import FIRST, faults
from ..scene.kinds.quads import is_flat
from ..scene.quads import Quads
from ..store import Cell, Floors, ResultFolder, derive, write_file
from ..store.arrays import read_arrays
from ..store.record import KEY_FILE, fault, is_cell_file, other_schema, parsed
from ..store.status import EXACT_ERROR, STATUSES

CLOCKS = 2.0  # a device may run this much faster than its calibration saw
OTHERS = 2  # devices that must agree before one that differs from them is named
FAR = 10.0  # times the largest error of the others
NOISE = 1e-6  # of an error in float32: less is no difference
COLOUR_BYTES = 4  # of a stored fragment, the least that any method writes
CACHE_BYTES = 2**28  # more than any device's caches hold: what is written goes to memory
MEASURED = tuple(name for name, status in STATUSES.items() if status.timed)
CHECKED_WORK = 20_000_000  # pixels and fragments of a scene whose kept image is composited again
HALF_STEP = 0.5 / 255  # of a kept image, which has 8 bits


@dataclass(frozen=True)
class Finding:
    """Something that a person should look at: the set, the cell, and what is odd about it."""

    where: str
    key: str
    what: str

    def __str__(self) -> str:
        return f"{self.where}: cell {self.key}: {self.what}"


def unpacked(sets: Mapping[str, Mapping[str, bytes]], into: Path) -> list[ResultFolder]:
    """The sets that `read_bundle` gives as result folders below `into`.

    Raises StoreError, and UsageError where a record is none: nothing of its set is written then.
    """
    folders = []
    for where, files in sets.items():
        for name in filter(KEY_FILE.fullmatch, files):
            _check_record(where, name.removesuffix(".json"), files[name])
        folder = ResultFolder(into / where)
        write_file(folder.path / "manifest.json", files.get("manifest.json", b"{}"))
        for name in filter(is_cell_file, files):
            write_file(folder.cells_path / name, files[name])
        folders.append(folder)
    return folders


def _check_record(where: str, key: str, content: bytes) -> None:
    try:
        record = parsed(content)
        wrong = other_schema(record) or fault(record, key)
    except ValueError as error:
        wrong = f"cannot be read: {error}"
    if wrong:
        raise UsageError(f"{where}: cell {key}: {wrong}")


def verified(folders: Iterable[ResultFolder], others: Iterable[ResultFolder] = ()) -> list[Finding]:
    """The oddities of these results; their derived files are written anew.

    Raises UsageError where a record cannot be read, contradicts its key or stands in the folder of another device.
    """
    elsewhere = _Errors(others)
    found: list[Finding] = []
    for folder in folders:
        source = _named(Source.of(folder))
        cells = [_sound(source, copy).cell for copy in source.copies()]
        derive(folder)
        where = f"{source.slug}/{source.name}"
        found += [Finding(where, cell["key"], what) for cell, what in _odd(folder, cells, elsewhere)]
    return found


def _named(source: Source) -> Source:
    """The source. Raises UsageError where its manifest does not name the set that its folder is, or not the timer."""
    where = "/".join(source.folder.path.parts[-2:])
    if where != f"{source.slug}/{source.name}":
        raise UsageError(f"{where}: its manifest names {f'{source.slug}/{source.name}'[:80]!r}; allowed: the set that "
                         "its folder is")
    if source.manifest.get("timer") is None:
        raise UsageError(f"{where}: its manifest names no timer, which is part of every key; allowed: a manifest that "
                         "'mfr-bench run' wrote")
    return source


def _sound(source: Source, copy: Copy | str) -> Copy:
    if isinstance(copy, str):
        raise UsageError(copy.removesuffix("; left out"))
    if wrong := source.contradiction(copy):
        raise UsageError(f"{source.slug}/{source.name}: cell {copy.key} {wrong}")
    return copy


def _odd(folder: ResultFolder, cells: list[Cell], elsewhere: _Errors) -> Iterator[tuple[Cell, str]]:
    floors = Floors(cells)
    rates = (folder.manifest().get("calibration") or {}).get("rates")
    rates = rates if isinstance(rates, Mapping) else {}
    for cell in cells:
        reasons = (_below_the_floor(cell, floors.of(cell)), _below_the_fill_rate(cell, rates),
                   _below_the_bandwidth(cell, rates), elsewhere.unlike(cell),
                   _unusable_arrays(folder, cell) or _other_image(folder, cell))
        yield from ((cell, reason) for reason in reasons if reason)


def _below_the_floor(cell: Cell, floor: Cell | None) -> str | None:
    high, low = cell["values"].get("time_ms_high"), (floor or {"values": {}})["values"].get("time_ms_low")
    if high is None or low is None or cell["method"] == FLOOR or high >= low:
        return None
    return f"its frame takes {high:.3g} ms at most, and drawing the geometry alone {low:.3g} ms at least"


def _below_the_fill_rate(cell: Cell, rates: Mapping[str, Any]) -> str | None:
    high, pixels = cell["values"].get("time_ms_high"), cell["values"].get("covered_pixels")
    rate = rates.get("fill_pixels_per_s")
    if not (high and pixels and isinstance(rate, (int, float)) and rate > 0):
        return None
    least_ms = 1e3 * pixels / (CLOCKS * rate)
    if high >= least_ms:
        return None
    return f"its frame takes {high:.3g} ms, and filling its pixels {least_ms:.3g} ms at least"


def _below_the_bandwidth(cell: Cell, rates: Mapping[str, Any]) -> str | None:
    """A frame in less time than the fragments that it keeps take to be written, in memory that no cache holds.

    Of each fragment its colour counts, 4 bytes, and no more than the method allocated.
    """
    values, rate = cell["values"], rates.get("copy_bytes_per_s")
    high, memory, kept = values.get("time_ms_high"), values.get("memory_bytes"), values.get("hit_ratio")
    stored = min(memory or 0, COLOUR_BYTES * (kept or 0.0) * (values.get("fragments") or 0))
    if not (high and isinstance(rate, (int, float)) and rate > 0 and stored > CACHE_BYTES):
        return None
    least_ms = 1e3 * stored / (CLOCKS * rate)
    if high >= least_ms:
        return None
    return f"its frame takes {high:.3g} ms, and writing the fragments that it keeps {least_ms:.3g} ms at least"


def _unusable_arrays(folder: ResultFolder, cell: Cell) -> str | None:
    """Arrays that a record says it keeps, and that are not there, cannot be read or are of another viewport."""
    kept = cell["measure"].get("keep") or ()
    if cell["status"] not in MEASURED or cell["method"] == FLOOR or not isinstance(kept, list):
        return None
    found, path = read_arrays(folder, cell["key"]), folder.arrays_path(cell["key"])
    damaged = next((line for line in folder.damaged if line.startswith(f"{path}: ")), None)
    if damaged:
        return f"its kept arrays {damaged.removeprefix(f'{path}: ').partition(';')[0]}"
    missing = [name for name in kept if name not in found]
    if missing:
        return f"it keeps {', '.join(map(str, missing))}, of which no array is here"
    size = cell["scene"].get("size")
    rows = size[::-1] if isinstance(size, list) else []
    other = [f"{name} has {list(array.shape[:2])}" for name, array in found.items() if list(array.shape[:2]) != rows]
    return f"its kept arrays are not of its viewport, {rows} rows and columns: {', '.join(other)}" if other else None


class _Errors:
    """The errors that other devices have for each cell, whatever the driver, shaders and settings of sampling."""

    def __init__(self, folders: Iterable[ResultFolder]):
        self._found: dict[str, dict[str, float]] = {}
        for source in map(Source.of, folders):
            for copy in source.copies():
                if isinstance(copy, Copy) and (error := copy.cell["values"].get("max_abs_error")) is not None:
                    self._found.setdefault(_question(copy.cell), {})[source.slug] = float(error)

    def unlike(self, cell: Cell) -> str | None:
        """The difference of the cell's error from that of every other device, or None."""
        mine, slug = cell["values"].get("max_abs_error"), device_of(cell).get("slug")
        theirs = [error for name, error in self._found.get(_question(cell), {}).items() if name != slug]
        if mine is None or len(theirs) < OTHERS:
            return None
        said = f"its error is {float(mine):.3g}, that of {len(theirs)} other devices"
        if float(mine) > FAR * max(theirs) + NOISE:
            return f"{said} {max(theirs):.3g} at most"
        in_software = draws_in_software(str(device_of(cell).get("renderer")))  # races do not show there
        if not in_software and FAR * float(mine) + EXACT_ERROR < min(theirs):
            return f"{said} {min(theirs):.3g} at least"
        return None


def _question(cell: Cell) -> str:
    return json.dumps([cell["method"], cell["params"], cell["scene"]], sort_keys=True)


def _other_image(folder: ResultFolder, cell: Cell) -> str | None:
    """The difference of a kept image from the oracle's, where numpy alone can tell: every fragment of flat quads."""
    method = catalog().get(cell["method"])
    if method is None or method.guarantee != "exact all" or cell["status"] != "ok":
        return None
    image = read_arrays(folder, cell["key"]).get("image")
    if image is None or cell["scene"].get("kind") != FIRST:
        return None
    if cell["scene"].get("effect", PLAIN.name) not in OWN_EFFECTS:
        return None  # the model of an effect from outside runs only in the process that measures
    scene, wrong = parse(Scene, cell["scene"])
    wrong = wrong or faults(scene)
    if wrong:
        return f"its scene is none that a config can have: {wrong[0][1]}"
    stats = expected_stats(scene)
    if not is_flat(scene) or scene.animate or stats.W * stats.H + stats.F >= CHECKED_WORK:
        return None
    expected = np.clip(_expected_image(generate(scene), cell["params"].get("payload") == "two_channel"), 0, 1)
    if image.shape != expected.shape:
        return f"its kept image has shape {image.shape}, its scene {expected.shape}"
    error = float(np.abs(image / 255.0 - expected).max())
    allowed = HALF_STEP + float(cell["values"].get("max_abs_error") or 0) + NOISE
    return f"its kept image differs from the oracle by {error:.3g}, its record says less" if error > allowed else None


def _expected_image(scene: Quads, two_channel: bool) -> np.ndarray:
    """float64 (H, W, 4): the effect of the scene, of every fragment; in the colours that two channels give back."""
    from ..oracle import twochannel
    from ..oracle.composite import composite
    from ..oracle.effects import answer_of_effect
    from ..oracle.listed import listed

    if not scene.effect.blended:
        return answer_of_effect(listed(scene), scene.effect).image
    return composite(scene, payload=twochannel.straight(scene.rgba) if two_channel else None)
