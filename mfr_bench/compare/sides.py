"""One side of a comparison: the cells of all results below a folder, by what they are."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from ..config import Scene
from ..environment import differences
from ..errors import UsageError
from ..methods import catalog
from ..report.data import Point, Result, heading, load
from ..store import ResultFolder, find_results

PLAIN_SCENE = Scene(size=(1, 1), depth_complexity=1).as_dict()  # every key at its default; these two are always given
Identity = str  # JSON of config name, method, parameters and scene: never of shaders, driver, settings or label


@dataclass(frozen=True)
class Entry:
    """A cell, and where it stands in words: 'K+B-Array, k 8'."""

    name: str
    experiment: str
    point: Point

    @property
    def scene(self) -> tuple[str, str]:
        """Equal for the cells that were measured in turns."""
        return self.experiment, json.dumps(self.point.cell["scene"], sort_keys=True)

    @property
    def method(self) -> tuple[str, str]:
        """Equal for the cells of one method in one variant, wherever it is swept."""
        cell = self.point.cell
        fixed = {name: value for name, value in cell["params"].items() if name not in cell["point"]}
        return cell["method"], json.dumps(fixed, sort_keys=True)


@dataclass(frozen=True)
class Side:
    """`noise`: the largest noise floor of its runs, None where none has one. `damaged`: files that were not used."""

    path: str
    entries: Mapping[Identity, Entry]
    devices: frozenset[tuple[str, str]]  # renderer and driver's version
    noise: float | None
    environment: Mapping[str, Any]
    unsteady: tuple[str, ...]
    damaged: tuple[str, ...]


def load_side(path: str) -> Side:
    """All results at or below a folder. Raises UsageError where there are none, or two of one config."""
    results = [load(ResultFolder(folder)) for folder in find_results([path])]
    by_name: dict[str, Result] = {}
    for result in results:
        if (other := by_name.setdefault(result.name, result)) is not result:
            raise UsageError(f"{path}: {other.folder.path} and {result.folder.path} both hold {result.name!r}; "
                             "allowed: one result of each config, such as the folder of one device")
    entries = {identity(result.name, p): Entry(_name(result, p), result.name, p)
               for result in results for p in result.points}
    noises = [n for r in results if (n := r.manifest.get("noise_floor_rel")) is not None]
    drifts = [f"{r.folder.path}: {d}" for r in results if (d := r.manifest.get("calibration_drift"))]
    return Side(path, entries, frozenset(_devices(results)), max(noises, default=None), _environment(results),
                tuple(drifts), tuple(line for r in results for line in r.folder.damaged))


def identity(experiment: str, point: Point) -> Identity:
    """Completes parameters and scene of older results: what they lack was then as the defaults are now."""
    cell, method = point.cell, catalog().get(point.cell["method"])
    params = (method.complete({}) if method else {}) | cell["params"]
    return json.dumps([experiment, cell["method"], params, PLAIN_SCENE | cell["scene"]], sort_keys=True)


def _name(result: Result, point: Point) -> str:
    places = [heading(a, point.at(a), " ") for a in result.axes if point.at(a) is not None]
    return ", ".join([point.label, *places])


def _devices(results: Iterable[Result]) -> Iterable[tuple[str, str]]:
    for result in results:
        for point in result.points:
            device = point.cell.get("device")
            device = device if isinstance(device, dict) else {}
            yield str(device.get("renderer") or "unknown device"), str(device.get("version") or "unknown driver")


def _environment(results: Iterable[Result]) -> dict[str, Any]:
    """The environment that the runs state; of several the last."""
    found: dict[str, Any] = {}
    for result in results:
        for part in ("environment", "versions"):
            stated = result.manifest.get(part)
            found |= stated if isinstance(stated, dict) else {}
        found["timer"] = result.manifest.get("timer", found.get("timer"))
    return found


def changed_environment(before: Side, after: Side) -> list[str]:
    return differences(before.environment, after.environment)


def refuse_other_devices(before: Side, after: Side) -> None:
    """Raises UsageError where the two were not measured on one device with one driver."""
    mistakes = [f"{side.path}: results of {len(side.devices)} devices or drivers, {_listed(side)}; "
                "allowed: one on each side" for side in (before, after) if len(side.devices) > 1]
    if not mistakes and before.devices != after.devices:
        which = f"{before.path} is of {_listed(before)}, {after.path} is of {_listed(after)}"
        mistakes = [f"compare: {which}: another device or driver; to compare them all the same, say --across-devices"]
    if mistakes:
        raise UsageError(mistakes)


def _listed(side: Side) -> str:
    return " and ".join(f"{renderer}, {version}" for renderer, version in sorted(side.devices)) or "no device"
