"""Equal devices of one folder, told apart by UUID or PCI address: what each measured, and how far apart they are."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from statistics import median
from typing import Any

from ...store.record import NODE, parsed
from ..data import Result, number
from .grid import ABSENT, Grid

NOTE = ("ratio: the median time of a cell on one over the median of those of all that measured it, and over all such "
        "cells its median, least and largest value; merge keeps each record in replicates/")


def nodes_grid(result: Result) -> Grid:
    """A row for each of several equal devices; no rows where one device, or none that is told apart, measured all."""
    times = _times(result)
    nodes = list(dict.fromkeys(node for of_cell in times.values() for node in of_cell))
    usual = {key: median(of_cell.values()) for key, of_cell in times.items() if len(of_cell) > 1}
    rows = []
    for node in nodes if len(nodes) > 1 else ():
        ratios = sorted(times[key][node] / usual[key] for key in usual if node in times[key])
        spread = [number(f(ratios)) for f in (median, min, max)] if ratios else [ABSENT] * 3
        rows.append((node, str(sum(node in of_cell for of_cell in times.values())), str(len(ratios)), *spread))
    return Grid("Equal devices", NOTE, ("device", "cells", "of several", "ratio", "least", "largest"), tuple(rows))


def _times(result: Result) -> dict[str, dict[str, float]]:
    """The median time of each cell by the device that measured it, by key."""
    found: dict[str, dict[str, float]] = {}
    for cell in [*_replicates(result), *(point.cell for point in result.points)]:
        node, time_ms = _node(cell), cell["values"].get("time_ms")
        if node and time_ms:
            found.setdefault(cell["key"], {}).setdefault(node, time_ms)
    return found


def _replicates(result: Result) -> Iterable[Mapping[str, Any]]:
    keys = {point.cell["key"] for point in result.points}
    for key, contents in result.folder.replicates().items():
        for content in contents if key in keys else ():
            try:
                cell = parsed(content)
            except ValueError:
                continue
            if isinstance(cell, dict) and isinstance(cell.get("values"), dict):
                yield cell | {"key": key}


def _node(cell: Mapping[str, Any]) -> str | None:
    device = cell.get("device")
    return next((str(device[name]) for name in NODE if device.get(name)), None) if isinstance(device, Mapping) else None
