"""Reads of each result folder what a comparison of devices needs, and joins folders of one experiment."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

from ...environment import MIB
from ...methods import FLOOR
from ...parallel import in_processes
from ...store import Cell, ResultFolder, device_name, places
from .. import data
from ..data.reading import belonging, labels_of

if TYPE_CHECKING:
    import numpy as np

NUMBERS = ("time_ms_low", "time_ms", "time_ms_high", "rmse", "flip", "max_error_all", "memory_mib")  # of an entry
Place = tuple[str, str]  # where methods are compared, and the entry: a method with its label


@dataclass(frozen=True)
class OnDevice:
    """An experiment in one folder: the device, the manifest's facts, and the numbers of each entry at each place.

    numbers: (cells, NUMBERS), missing ones NaN; places: of each cell. methods: the id of each entry's method.
    """

    experiment: str
    path: str
    name: str
    facts: Mapping[str, Any]
    noise: float
    places: Sequence[Place]
    numbers: np.ndarray
    methods: Mapping[str, str]
    damaged: Sequence[str]


@dataclass(frozen=True)
class Experiment:
    """An experiment on several devices. Devices stand in the order of their folders."""

    name: str
    devices: Sequence[OnDevice]

    @cached_property
    def places(self) -> list[str]:
        """The scenes and points at which methods are compared, in the order of the first device that has each."""
        return list(dict.fromkeys(place for device in self.devices for place, _ in device.places))

    @cached_property
    def entries(self) -> list[str]:
        """Labels of the methods, in the order of the first device that has each."""
        return list(dict.fromkeys(entry for device in self.devices for _, entry in device.places))

    @cached_property
    def numbers(self) -> np.ndarray:
        """NUMBERS by device, place and entry; NaN where nothing was measured with the right image."""
        import numpy as np

        places, entries = ({name: i for i, name in enumerate(names)} for names in (self.places, self.entries))
        found = np.full((len(self.devices), len(places), len(entries), len(NUMBERS)), np.nan)
        for number, device in enumerate(self.devices):
            found[number, [places[place] for place, _ in device.places],
                  [entries[entry] for _, entry in device.places]] = device.numbers
        return found

    def method(self, entry: str) -> str:
        """The id of an entry's method."""
        return next(device.methods[entry] for device in self.devices if entry in device.methods)


def read_experiments(folders: Sequence[ResultFolder], whole_scenes: bool = False) -> list[Experiment]:
    """The experiments of these folders, each with the devices that have a cell of it.

    whole_scenes: methods are compared in each scene whatever their parameters, which become a part of their entries;
    else at each scene and value of the swept parameters.
    """
    found: dict[str, list[OnDevice]] = {}
    for device in in_processes(_scenes if whole_scenes else _points, folders):
        if device.places:
            found.setdefault(device.experiment, []).append(device)
    return [Experiment(name, _named_apart(devices)) for name, devices in found.items()]


def _named_apart(devices: Sequence[OnDevice]) -> list[OnDevice]:
    """The devices; folders of one device are told apart by their paths."""
    from dataclasses import replace

    names = [device.name for device in devices]
    twice = {name for name in names if names.count(name) > 1} if len(set(names)) < len(names) else ()
    return [replace(device, name=f"{device.name} ({device.path})") if device.name in twice else device
            for device in devices]


def _points(folder: ResultFolder) -> OnDevice:
    return on_device(folder, whole_scenes=False)


def _scenes(folder: ResultFolder) -> OnDevice:
    return on_device(folder, whole_scenes=True)


def on_device(folder: ResultFolder, whole_scenes: bool) -> OnDevice:
    """What a comparison needs of one folder."""
    import numpy as np

    manifest = folder.manifest()
    cells, _ = belonging(manifest, [each for cell in folder.cells() for each in places(cell)])
    labelled = [(cell, label) for cell, label in zip(cells, labels_of(cells), strict=True)
                if cell["method"] != FLOOR and cell["status"] == "ok" and cell["values"].get("time_ms") is not None]
    texts: dict[str, str] = {}  # equal ones once: a thousand devices are kept
    placed = {(texts.setdefault(place, place), texts.setdefault(entry, entry)): cell for place, entry, cell in
              (_by_scene(labelled) if whole_scenes else _by_point(labelled))}
    own = manifest.get("device")
    own = own if isinstance(own, Mapping) else {"slug": own}
    name = next(filter(None, map(device_name, cells)), None) or own.get("slug") or folder.path.parent.name
    return OnDevice(str(manifest.get("name") or folder.path.name), str(folder.path), str(name), _facts(manifest, cells),
                    manifest.get("noise_floor_rel") or 0.0, list(placed),
                    np.array([_numbers(cell["values"]) for cell in placed.values()]),
                    {entry: cell["method"] for (_, entry), cell in placed.items()}, tuple(folder.damaged))


def _by_scene(labelled: Iterable[tuple[Cell, str]]) -> list[tuple[str, str, Cell]]:
    """Place, entry and cell: the scene, and the label with the values of swept parameters."""
    found = []
    for cell, label in labelled:
        own = [data.heading(name, value, " ") for name, value in _swept_params(cell)]
        found.append((_scene(cell), ", ".join([label, *own]), cell))
    return found


def _by_point(labelled: Sequence[tuple[Cell, str]]) -> list[tuple[str, str, Cell]]:
    """Place, entry and cell: a method that a swept parameter does not touch stands at each of its values."""
    swept: dict[str, dict[str, None]] = {}
    for cell, _ in labelled:
        swept.setdefault(_scene(cell), {}).setdefault(_params(cell))
    return [(f"{scene}; {params}" if params else scene, label, cell) for cell, label in labelled
            for scene in [_scene(cell)]
            for params in ([_params(cell)] if _params(cell) else [p for p in swept[scene] if p] or [""])]


def _params(cell: Cell) -> str:
    return ", ".join(data.heading(name, value) for name, value in _swept_params(cell))


def _swept_params(cell: Cell) -> list[tuple[str, Any]]:
    """The swept parameters of the method with their values; those of the scene are no part of them."""
    return [(name, value) for name, value in cell["point"].items() if not name.startswith("scene.") and name != "r"]


def _scene(cell: Cell) -> str:
    """The scene in full as one text; equal scenes have equal texts."""
    return json.dumps(cell["scene"], sort_keys=True)


def _numbers(values: Mapping[str, Any]) -> tuple[float, ...]:
    memory = values.get("memory_bytes")
    known = {**values, "memory_mib": None if memory is None else memory / MIB}
    return tuple(float("nan") if known.get(name) is None else float(known[name]) for name in NUMBERS)


def _facts(manifest: Mapping[str, Any], cells: Sequence[Cell]) -> dict[str, Any]:
    """What a manifest says of the device, the driver and the run."""
    device = manifest.get("device") if isinstance(manifest.get("device"), Mapping) else {}
    environment = manifest.get("environment") or {}
    gpus = [environment[part].get("gpu") for part in ("start", "end") if isinstance(environment.get(part), Mapping)]
    return {"renderer": device.get("renderer"), "driver": device.get("version"),
            "clock": _clock([gpu for gpu in gpus if isinstance(gpu, Mapping)]), "timer": manifest.get("timer"),
            "size": "; ".join(dict.fromkeys(data.plain(cell["scene"]["size"]) for cell in cells)),
            "program": (manifest.get("versions") or {}).get("mfr-bench"), "profile": manifest.get("profile"),
            "day": str(manifest.get("started") or "")[:10] or None, "simulated": bool(manifest.get("simulated"))}


def _clock(states: Sequence[Mapping[str, Any]]) -> str | None:
    found = [str(value) for state in states for name, value in state.items() if name == "clocks.sm" and value]
    return " to ".join(dict.fromkeys(found)) or None
