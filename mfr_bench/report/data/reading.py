"""Result folders as results: records labelled in plan order, results of several devices joined."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Any

from ...store import Cell, Floors, ResultFolder, Texts, device_name, places, result_rows
from .belonging import Config
from .point import Point
from .result import Result
from .words import bare


def load(folder: ResultFolder, cells: Sequence[Cell] | None = None) -> Result:
    """The points that the folder's config has in plan order; of several records of one point the planned one.

    cells: those of the folder, which are read unless given.
    """
    manifest = folder.manifest()
    found = [each for cell in (folder.cells() if cells is None else cells) for each in places(cell)]
    cells, left_out = belonging(manifest, found)
    floors, labels = Floors(cells), labels_of(cells)
    parameters = frozenset(name for cell in cells for name in cell["params"])
    noise = manifest.get("noise_floor_rel") or 0.0
    points = tuple(Point(cell, row, label, floors.of(cell), parameters, folder=folder, noise=noise)
                   for cell, row, label in zip(cells, result_rows(cells), labels, strict=True))
    return Result(folder, manifest, points, left_out)


def belonging(manifest: Mapping[str, Any], found: Sequence[Cell]) -> tuple[list[Cell], int]:
    """The cells that a manifest's config has in plan order, and how many it has not.

    Of several records of one point the planned one counts.
    """
    config = Config(manifest)
    kept = [cell for cell in found if config.has(cell)]
    return _current(kept, frozenset(manifest.get("cells") or ())), len(found) - len(kept)


def join(results: Sequence[Result]) -> Result:
    """The points of one experiment from several folders, so that `device` is one of its axes.

    What a manifest says is the first's, its devices and dates all of theirs.
    """
    first, *others = results
    points = [p for result in results for p in result.points]
    parameters = frozenset().union(*(p.parameters for p in points))
    labels = labels_of([p.cell for p in points])
    made = tuple(replace(p, label=label, parameters=parameters, known={})
                 for p, label in zip(points, labels, strict=True))
    devices = [dict(r.manifest.get("device") or {}) for r in results]
    manifest = dict(first.manifest) | {
        "device": {"renderer": _together(d.get("renderer") for d in devices),
                   "version": _together(d.get("version") for d in devices)},
        "started": _together(str(r.manifest.get("started") or "")[:10] for r in results),
        "timer": _together(r.manifest.get("timer") for r in results),
        "cells": [p.cell["key"] for p in points]}
    return Result(first.folder, manifest, made) if others else first


def _together(values: Iterable[Any]) -> str:
    return "; ".join(dict.fromkeys(str(v) for v in values if v))


def _current(cells: Sequence[Cell], planned: frozenset[str]) -> list[Cell]:
    """The cells, but for those that a planned one of the point replaces: other shaders, drivers, settings, defaults."""
    texts = Texts()
    foreign = [cell for cell in cells if cell["key"] not in planned]
    taken = {_identity(cell, texts) for cell in cells if cell["key"] in planned} if foreign else set()
    left = {id(cell) for cell in foreign if _identity(cell, texts) in taken}
    kept: dict[tuple, Cell] = {}
    for cell in cells:
        if id(cell) not in left:
            kept.setdefault((*_identity(cell, texts), texts.of(cell["params"])), cell)
    return list(kept.values())


def _identity(cell: Cell, texts: Texts) -> tuple[str | None, ...]:
    return (cell["method"], cell["label"], texts.of(cell["scene"]), texts.of(cell["point"]), device_name(cell))


def labels_of(cells: Sequence[Cell]) -> list[str]:
    """A label per cell; entries that share one are told apart by the parameters in which they differ.

    A parameter that only follows from the point, as one without an effect at some of them, tells nothing apart.
    """
    swept = {bare(name) for cell in cells for name in cell["point"]}
    entries: dict[str, dict[str, dict]] = {}
    places: dict[tuple, set[str]] = {}
    texts = Texts()
    where = [(cell["label"], texts.of(cell["point"]), texts.of(cell["scene"])) for cell in cells]
    variants: dict[tuple[str, str], tuple[dict, str]] = {}  # by method and parameters, without those that are swept
    for cell, place in zip(cells, where, strict=True):
        variant = cell["method"], texts.of(cell["params"])
        if variant not in variants:
            fixed = {"method": cell["method"]} | {n: v for n, v in cell["params"].items() if n not in swept}
            variants[variant] = fixed, json.dumps(fixed, sort_keys=True)
        fixed, text = variants[variant]
        entries.setdefault(cell["label"], {})[text] = fixed
        places.setdefault(place, set()).add(text)
    shared = {cell["label"] for cell, place in zip(cells, where, strict=True) if len(places[place]) > 1}
    return [_label(cell, list(entries[cell["label"]].values())) if cell["label"] in shared else cell["label"]
            for cell in cells]


def _label(cell: Cell, same: list[dict]) -> str:
    names = [n for n in dict.fromkeys(n for fixed in same for n in fixed)
             if len({fixed.get(n) for fixed in same}) > 1]
    mine = {"method": cell["method"]} | cell["params"]
    parts = [str(mine[n]) if n == "method" else f"{n} {mine[n]}" for n in names if n in mine]
    return f"{cell['label']} ({', '.join(parts)})" if parts else cell["label"]
