"""The parts of a folder's cells that a comparison of devices needs: read from them, or from a file that a merge left.

    DIR/comparison.json    of each cell with the right image: scene, swept parameters, method and numbers

The file states the hash of all that it was made of, and counts only while that is in place: reading a set of a large
collection then takes a hash of its pack instead of every record.
"""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from ... import __version__
from ...environment import MIB
from ...methods import FLOOR
from ...store import Cell, ResultFolder, Texts, device_name, places, write_file
from .. import data
from ..data.reading import belonging, labels_of

NUMBERS = ("time_ms_low", "time_ms", "time_ms_high", "rmse", "flip", "max_error_all", "memory_mib")  # of a cell
FORMAT = 1  # of the file; another one where a cell's parts come to mean something else


@dataclass(frozen=True)
class Digest:
    """The cells of one folder that are compared, in plan order, and the manifest's facts.

    scenes, sweeps, entries: each that some cell has once: a scene as JSON, the swept parameters as pairs of name and
    value, the label with the id of the method. cells: of each its scene, sweep and entry by number, then NUMBERS:
    one that is missing is None, one that is not finite a text. device: its name as the cells have it. axes: what the
    figures of the config have as x.
    """

    experiment: str | None
    device: str | None
    noise: float
    facts: Mapping[str, Any]
    axes: Sequence[str]
    scenes: Sequence[str]
    sweeps: Sequence[Sequence[tuple[str, Any]]]
    entries: Sequence[tuple[str, str]]
    cells: Sequence[Sequence[Any]]

    @property
    def sound(self) -> bool:
        """Whether every cell has its parts; a file may have been written by anybody."""
        parts = (self.scenes, self.sweeps, self.entries)
        return all(len(cell) == len(parts) + len(NUMBERS)
                   and all(0 <= at < len(part) for at, part in zip(cell, parts, strict=False)) for cell in self.cells)


def digest_of(folder: ResultFolder) -> Digest:
    """The digest of a folder: the file's where it is there and true, else from the records."""
    return _kept(folder) or made_of(folder.manifest(), folder.cells())


def write_digest(folder: ResultFolder, cells: Sequence[Cell]) -> None:
    """Write the file for the folder, whose cells these are; none where some of its files cannot be used."""
    if not folder.damaged:
        content = {**_of(folder), **asdict(made_of(folder.manifest(), cells))}
        write_file(_path(folder), f"{json.dumps(content, ensure_ascii=False)}\n".encode(errors="replace"))


def made_of(manifest: Mapping[str, Any], found: Iterable[Cell]) -> Digest:
    """The digest of a manifest and of the folder's cells."""
    cells, _ = belonging(manifest, [each for cell in found for each in places(cell)])
    texts, parts = Texts(), ({}, {}, {})
    scenes, sweeps, entries = parts
    compared = [
        [scenes.setdefault(texts.of(cell["scene"]), len(scenes)),
         sweeps.setdefault(json.dumps(_swept(cell)), len(sweeps)),
         entries.setdefault((label, cell["method"]), len(entries)), *_numbers(cell["values"])]
        for cell, label in zip(cells, labels_of(cells), strict=True)
        if cell["method"] != FLOOR and cell["status"] == "ok" and cell["values"].get("time_ms") is not None]
    own = manifest.get("device")
    slug = own.get("slug") if isinstance(own, Mapping) else own
    return Digest(manifest.get("name"), next(filter(None, map(device_name, cells)), None) or slug,
                  manifest.get("noise_floor_rel") or 0.0, _facts(manifest, cells), _axes(manifest), list(scenes),
                  list(map(json.loads, sweeps)), list(entries), compared)


def _axes(manifest: Mapping[str, Any]) -> list[str]:
    return list(dict.fromkeys(str(figure["x"]) for figure in manifest.get("figures") or () if figure.get("x")))


def _kept(folder: ResultFolder) -> Digest | None:
    """The digest in the folder's file; None where there is none that is of what the folder has now."""
    try:
        content = json.loads(_path(folder).read_bytes())
        stated = {name: content.pop(name, None) for name in _of(folder)}
        found = Digest(**content)
        return found if stated == _of(folder) and found.sound else None
    except (OSError, ValueError, TypeError, AttributeError):
        return None


def _path(folder: ResultFolder) -> Path:
    return folder.path / "comparison.json"


def _of(folder: ResultFolder) -> dict[str, Any]:
    """The statement of the file about itself: its form, the program, and the hash of the files that it is made of."""
    return {"format": FORMAT, "numbers": list(NUMBERS), "program": __version__, "of": folder.fingerprint()}


def _swept(cell: Cell) -> list[tuple[str, Any]]:
    """The swept parameters of the method with their values; those of the scene are no part of them."""
    return [(name, value) for name, value in cell["point"].items() if not name.startswith("scene.") and name != "r"]


def _numbers(values: Mapping[str, Any]) -> list[float | str | None]:
    memory = values.get("memory_bytes")
    known = {**values, "memory_mib": None if memory is None else memory / MIB}
    found = [known.get(name) for name in NUMBERS]
    return [value if value is None or math.isfinite(value) else str(value) for value in found]


def _facts(manifest: Mapping[str, Any], cells: Sequence[Cell]) -> dict[str, Any]:
    """The facts of a manifest on the device, the driver and the run."""
    device = manifest.get("device") if isinstance(manifest.get("device"), Mapping) else {}
    environment = manifest.get("environment") or {}
    gpus = [environment[part].get("gpu") for part in ("start", "end") if isinstance(environment.get(part), Mapping)]
    sizes = dict.fromkeys(tuple(cell["scene"]["size"]) for cell in cells)
    return {"renderer": device.get("renderer"), "driver": device.get("version"),
            "clock": _clock([gpu for gpu in gpus if isinstance(gpu, Mapping)]), "timer": manifest.get("timer"),
            "size": "; ".join(dict.fromkeys(map(data.plain, sizes))),
            "program": (manifest.get("versions") or {}).get("mfr-bench"), "profile": manifest.get("profile"),
            "day": str(manifest.get("started") or "")[:10] or None, "simulated": bool(manifest.get("simulated"))}


def _clock(states: Sequence[Mapping[str, Any]]) -> str | None:
    found = [str(value) for state in states for name, value in state.items() if name == "clocks.sm" and value]
    return " to ".join(dict.fromkeys(found)) or None
