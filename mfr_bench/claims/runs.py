"""The measurements that claims are tested on: the cells of one experiment, one device and one result folder."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from ..environment import draws_in_software
from ..report.data import Point, Result, load
from ..store import ResultFolder, device_name

UNKNOWN = "unknown device"


@dataclass(frozen=True)
class Run:
    """The cells of one folder and one device. Only cells of one run are ever compared with each other."""

    experiment: str  # name of the config
    folder: str
    device: str  # short name
    makers: str  # vendor and renderer, as the driver gives them
    software: bool  # the driver draws on the CPU
    noise: float | None  # largest relative difference of a method measured twice
    points: tuple[Point, ...]


def load_runs(folders: Iterable[ResultFolder]) -> list[Run]:
    """Every run of the folders, in their order."""
    return [run for folder in folders for run in runs_of(load(folder))]


def runs_of(result: Result) -> list[Run]:
    """The runs of a result that was loaded: one for each device."""
    ran = result.manifest.get("device")
    ran = ran if isinstance(ran, dict) else {"slug": ran} if isinstance(ran, str) else {}
    places: dict[str, list[Point]] = {}
    for point in result.points:
        places.setdefault(device_name(point.cell) or UNKNOWN, []).append(point)
    if not places:
        places[device_name({"device": ran}) or UNKNOWN] = []
    return [_run(result, ran, name, points) for name, points in places.items()]


def _run(result: Result, ran: Mapping[str, Any], name: str, points: list[Point]) -> Run:
    own = points[0].cell.get("device") if points else None
    about = dict(own) if isinstance(own, dict) else {}
    if name == ran.get("slug"):
        about = dict(ran) | about
    makers = " ".join(str(about[part]) for part in ("vendor", "renderer") if about.get(part)) or name
    software = about.get("kind") == "cpu" or draws_in_software(makers)
    return Run(result.name, str(result.folder.path), name, makers, software,
               result.manifest.get("noise_floor_rel"), tuple(points))
