"""Reads of each result folder what a comparison of devices needs, and joins folders of one experiment."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

from ...parallel import in_processes
from ...store import ResultFolder
from .. import data
from .digest import NUMBERS, Digest, digest_of

if TYPE_CHECKING:
    import numpy as np

ENTRY, PARTS = 2, 3  # of a digest's cell: where its entry stands, and where its numbers begin
Place = tuple[str, str]  # where methods are compared, and the entry: a method with its label


@dataclass(frozen=True)
class OnDevice:
    """An experiment in one folder: the device, the manifest's facts, and the numbers of each entry at each place.

    numbers: (cells, NUMBERS), missing ones NaN; places: of each cell. methods: the id of each entry's method.
    axes: what the config's figures have as x. sweeps: the swept parameters by the words that places have for them.
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
    axes: Sequence[str] = ()
    sweeps: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)


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
    places: dict[tuple[Place, ...], tuple[Place, ...]] = {}  # most devices have the same ones, which are kept once
    for device in in_processes(_scenes if whole_scenes else _points, folders):
        if device.places:
            own = tuple(device.places)
            found.setdefault(device.experiment, []).append(replace(device, places=places.setdefault(own, own)))
    return [Experiment(name, _named_apart(devices)) for name, devices in found.items()]


def _named_apart(devices: Sequence[OnDevice]) -> list[OnDevice]:
    """The devices; folders of one device are told apart by their paths."""
    names = [device.name for device in devices]
    twice = {name for name in names if names.count(name) > 1} if len(set(names)) < len(names) else ()
    return [replace(device, name=f"{device.name} ({device.path})") if device.name in twice else device
            for device in devices]


def _points(folder: ResultFolder) -> OnDevice:
    return on_device(folder, whole_scenes=False)


def _scenes(folder: ResultFolder) -> OnDevice:
    return on_device(folder, whole_scenes=True)


def on_device(folder: ResultFolder, whole_scenes: bool) -> OnDevice:
    """The parts of one folder that a comparison needs."""
    import numpy as np

    found = digest_of(folder)
    placed = dict(_by_scene(found) if whole_scenes else _by_point(found))
    numbers = [[math.nan if value is None else float(value) for value in found.cells[at][PARTS:]]
               for at in placed.values()]
    return OnDevice(found.experiment or folder.path.name, str(folder.path),
                    str(found.device or folder.path.parent.name), found.facts, found.noise, list(placed),
                    np.array(numbers), {entry: found.entries[found.cells[at][ENTRY]][1]
                                        for (_, entry), at in placed.items()}, tuple(folder.damaged), found.axes,
                    {_words(sweep): dict(sweep) for sweep in found.sweeps if sweep})


def _by_scene(found: Digest) -> Iterable[tuple[Place, int]]:
    """Place and number of each cell: the scene, and the label with the values of swept parameters."""
    own = [[data.heading(name, value, " ") for name, value in sweep] for sweep in found.sweeps]
    labels = {(sweep, entry): ", ".join([label, *words]) for sweep, words in enumerate(own)
              for entry, (label, _) in enumerate(found.entries)}
    return [((found.scenes[scene], labels[sweep, entry]), at)
            for at, (scene, sweep, entry, *_) in enumerate(found.cells)]


def _words(sweep: Iterable[tuple[str, Any]]) -> str:
    return ", ".join(data.heading(name, value) for name, value in sweep)


def _by_point(found: Digest) -> Iterable[tuple[Place, int]]:
    """Place and number of each cell: a method that a swept parameter does not touch stands at each of its values."""
    words = list(map(_words, found.sweeps))
    swept: dict[int, dict[str, None]] = {}
    for scene, sweep, *_ in found.cells:
        if words[sweep]:
            swept.setdefault(scene, {}).setdefault(words[sweep])
    names = {(scene, params): f"{found.scenes[scene]}; {params}" for scene, every in swept.items() for params in every}
    return [((names.get((scene, params), found.scenes[scene]), found.entries[entry][0]), at)
            for at, (scene, sweep, entry, *_) in enumerate(found.cells)
            for params in ([words[sweep]] if words[sweep] else swept.get(scene) or [""])]
