"""A result folder as tables and figures see it: labelled points with coordinates and measures."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

from ..environment import MIB
from ..errors import StoreError, nearest
from ..methods import FLOOR
from ..stats import Interval, interleaved_ratio, median_interval, ratio_interval, real
from ..store import Cell, Floors, ResultFolder, Row, device_name, result_rows
from ..store.arrays import read_arrays
from ..store.columns import COLUMNS, DERIVED, PASS_COLUMNS
from ..store.status import EXACT_ERROR, STATUSES, Status

NOTHING: Interval = (None, None, None)

ALIASES = {"n": "depth_complexity", "p_d": "pixel_density", "f_p": "fragment_probability"}
SHORT = {"depth_complexity": "n", "pixel_density": "p_d", "fragment_probability": "f_p",
         "memory_mb": "M_b", "hit_ratio": "R_h"}  # in headings

MEASURES = {c.name: c.axis for c in (*PASS_COLUMNS, *COLUMNS, *DERIVED) if c.drawn not in ("", "place")}  # axes
BY_MEMORY = {"ms_per_mib": ("time_ms", -1), "ms_times_mib": ("time_ms", 1), "fps_per_mib": ("fps", -1)}
IN_MIB = {"memory_bytes": "memory_mib", "memory_model_bytes": "memory_model_mib"}  # bytes are drawn as MiB


@dataclass(frozen=True)
class Point:
    """One cell. `label` names its series and is unique to its method and fixed parameters."""

    cell: Cell
    row: Row
    label: str
    floor: Cell | None
    parameters: frozenset[str]  # parameter names of any cell of the folder
    drawn: Interval | None = None  # what a figure shows instead of the measure that its y names
    folder: ResultFolder | None = None
    noise: float = 0.0  # of its run: how far a method measured twice is from itself, relative

    @property
    def method(self) -> str:
        return self.cell["method"]

    @property
    def status(self) -> str:
        return self.cell["status"]

    @property
    def ending(self) -> Status:
        """What the program knows of the point's status."""
        return STATUSES[self.status]

    @property
    def sign(self) -> str:
        """The status in words."""
        return self.ending.sign

    def at(self, name: str) -> Any:
        """Coordinate of the point along a swept key or column; None where its method has no such parameter."""
        if name in self.cell["point"] and "." in name and bare(name) != "alpha":
            return _hashable(self.cell["point"][name])
        name = bare(name)
        if name in self.cell["params"]:
            return self.cell["params"][name]
        if name in self.cell["scene"]:
            value = _hashable(self.cell["scene"][name])
            return value[0] if name == "alpha" and isinstance(value, tuple) and len(set(value)) == 1 else value
        if name in self.row:
            return self.row[name]
        return None if name in self.parameters else _hashable(self.cell["point"].get(name))

    @cached_property
    def time_ms(self) -> Interval:
        return self.row["time_ms_low"], self.row["time_ms"], self.row["time_ms_high"]

    @cached_property
    def floor_ratio(self) -> Interval:
        """Time over the floor's."""
        if self.floor is None or self.row["time_ms"] is None:
            return None, None, None
        return time_ratio(self.cell, self.floor)

    def over(self, other: Point) -> Interval:
        """Its time over that of another point of its run."""
        return time_ratio(self.cell, other.cell)

    def apart(self, ratio: Interval) -> bool:
        """Whether a ratio of times tells it from another point of its run: beyond its interval and the noise floor."""
        return real(ratio, self.noise)

    @property
    def shows_all(self) -> bool:
        """Whether it was measured with a right image in which every fragment shows."""
        rmse = self.row["rmse"]
        return self.status == "ok" and self.row["time_ms"] is not None and rmse is not None and rmse <= EXACT_ERROR

    @cached_property
    def passes_ms(self) -> dict[str, Interval]:
        """Interval of each timed pass, in the order of the frame."""
        timed = self.cell.get("passes") or {}
        return {name: median_interval(samples) for name, samples in timed.items() if samples}

    def pass_ms(self, names: Iterable[str]) -> Interval:
        """Interval of the first of these passes that the method has."""
        return next((self.passes_ms[name] for name in names if name in self.passes_ms), NOTHING)

    def shown(self, name: str) -> Interval:
        """What a figure of the measure shows of the point."""
        return self.measure(name) if self.drawn is None else self.drawn

    @cached_property
    def arrays(self) -> dict[str, Any]:
        """The arrays that the cell kept, by name."""
        return read_arrays(self.folder, self.cell["key"]) if self.folder else {}

    def measure(self, name: str) -> Interval:
        """A measure (see MEASURES) between the ends of its interval, which are None where it has none."""
        if name in ("time_ms", "floor_ratio"):
            return getattr(self, name)
        if name == "fps":
            low, middle, high = self.time_ms
            return tuple(1000 / t if t else None for t in (high, middle, low))
        if name in BY_MEMORY:
            of, power = BY_MEMORY[name]
            memory = self.row["memory_bytes"]
            return tuple(v * (memory / MIB) ** power if v is not None and memory else None for v in self.measure(of))
        return None, self._counted(name), None

    def _counted(self, name: str) -> float | None:
        """A measure that is counted, not timed."""
        if name in ("memory_mib", "memory_model_mib"):
            value = self.row[name.replace("mib", "bytes")]
            return None if value is None else value / MIB
        if name == "words_per_pixel":
            value = self.row["memory_bytes"]
            return None if value is None else value / 4 / (self.row["width"] * self.row["height"])
        if name == "culled_of_unkept":
            return self._culled_of_unkept()
        if name == "share":
            return 1.0 if self.passes_ms else None
        return self.row[name]

    def _culled_of_unkept(self) -> float | None:
        """Fragments that never ask for the lock, of those that the image is not made of."""
        culled, kept = self.row["culled_share"], self.row["hit_ratio"]
        return None if culled is None or kept is None or kept >= 1 else culled / (1 - kept)

    @property
    def exact(self) -> bool | None:
        """Whether the image is the promised one; None where no image was checked."""
        error = self.row["max_abs_error"]
        return None if error is None else error <= EXACT_ERROR and self.ending.image != "wrong"


@dataclass(frozen=True)
class Result:
    """Everything that is drawn or tabulated from one folder."""

    folder: ResultFolder
    manifest: Mapping[str, Any]
    points: tuple[Point, ...]

    @property
    def name(self) -> str:
        return str(self.manifest.get("name") or self.folder.path.name)

    @property
    def figures(self) -> list[Mapping[str, Any]]:
        """The config's figures, as given there."""
        return [figure for figure in self.manifest.get("figures") or [] if isinstance(figure, Mapping)]

    @property
    def provenance(self) -> str:
        """One line: the paper, the device with its driver, the timer, the date, the program's version."""
        manifest = self.manifest
        source, device = manifest.get("source") or {}, manifest.get("device") or {}
        device = device if isinstance(device, Mapping) else {"renderer": device}
        paper = ", ".join(str(v) for v in (source.get("paper"), figure_of(source)) if v)
        version = (manifest.get("versions") or {}).get("mfr-bench")
        stand_in = source.get("stand_in")
        parts = [paper and f"after {paper}", stand_in and f"scene: {stand_in}",
                 device.get("renderer"), device.get("version"),
                 manifest.get("timer") and f"timer: {manifest['timer']}", self.dates,
                 version and f"mfr-bench {version}"]
        return " · ".join(str(part) for part in parts if part)

    @property
    def readings(self) -> str:
        """One line: how the experiment's config reads what the paper leaves open."""
        return " ".join(map(str, (self.manifest.get("source") or {}).get("readings") or ()))

    @property
    def dates(self) -> str:
        """The days on which the measuring began."""
        return "; ".join(part[:10] for part in str(self.manifest.get("started") or "").split("; "))

    @property
    def unmeasured(self) -> int:
        """Planned cells without a record: the run was interrupted, or its file was damaged."""
        keys = {p.cell["key"] for p in self.points}
        return sum(key not in keys for key in self.manifest.get("cells", []))

    @property
    def lacking(self) -> str:
        """One line on what is not here: planned cells without a record, files that could not be used."""
        files = len(self.folder.damaged)
        parts = [f"{self.unmeasured} planned cells have no record" if self.unmeasured else "",
                 f"{files} {'file' if files == 1 else 'files'} could not be used" if files else ""]
        return "; ".join(part for part in parts if part)

    @property
    def labels(self) -> list[str]:
        """Series in the config's order."""
        return list(dict.fromkeys(p.label for p in self.points))

    @cached_property
    def axes(self) -> list[str]:
        """Keys with more than one value here: swept ones in the config's order, then the scene's, then the device.

        A scene may differ without being swept, as with r, which gives n = r k.
        """
        swept = [*(self.manifest.get("sweep") or {}), *(k for p in self.points for k in p.cell["point"])]
        names = [*swept, *(k for p in self.points for k in p.cell["scene"]), "device"]
        first = {bare(name): name for name in reversed(names)}
        return [n for n in dict.fromkeys(names) if first[bare(n)] == n and len(values(self.points, n)) > 1]

    def split(self, points: Sequence[Point], used: Iterable[str]) -> list[str]:
        """The axes, apart from `used`, that tell apart points of one label. Zipped axes need only one of them."""
        names, used = [], [bare(u) for u in used]
        for axis in self.axes:
            if bare(axis) not in used and _distinguishes(points, axis, [*used, *names]):
                names.append(axis)
        return names


MANIFEST_TYPES = {"figures": list, "source": dict, "sweep": dict, "zip": dict, "device": (dict, str),
                  "noise_floor_rel": (int, float)}


def _sound(folder: ResultFolder) -> dict[str, Any]:
    """The manifest without what is not of its type, as another program may have left it; that is named."""
    manifest = folder.manifest()
    wrong = [name for name, kind in MANIFEST_TYPES.items()
             if manifest.get(name) is not None and not isinstance(manifest[name], kind)]
    for name in wrong:
        folder.skip(folder.path / "manifest.json", f"{name}: not of its type")
    return {name: value for name, value in manifest.items() if name not in wrong}


def load(folder: ResultFolder) -> Result:
    """The folder's points in plan order; of several records of one point the planned one."""
    manifest = _sound(folder)
    cells = _current(folder.cells())
    floors, labels = Floors(cells), _labels(cells)
    parameters = frozenset(name for cell in cells for name in cell["params"])
    noise = manifest.get("noise_floor_rel") or 0.0
    points = tuple(Point(cell, row, label, floors.of(cell), parameters, folder=folder, noise=noise)
                   for cell, row, label in zip(cells, result_rows(cells), labels, strict=True))
    return Result(folder, manifest, points)


def time_ratio(over: Cell, under: Cell, confidence: float = 0.95) -> Interval:
    """The frame time of one cell over that of another; from raw samples, so that the interval keeps its confidence.

    Cells of one scene and settings were sampled in turns: what slowed both down alike is left out of the interval.
    """
    above, below = (cell.get("samples_ms") or [] for cell in (over, under))
    least, most = (over["measure"].get(name) for name in ("min_samples", "max_samples"))
    in_turns = all(over[name] == under[name] for name in ("scene", "measure")) and least and most
    return (interleaved_ratio(above, below, least, most, confidence) if in_turns
            else ratio_interval(above, below, confidence))


def join(results: Sequence[Result]) -> Result:
    """The points of one experiment from several folders, so that `device` is one of its axes.

    What a manifest says is the first's, its devices and dates all of theirs.
    """
    first, *others = results
    points = [p for result in results for p in result.points]
    parameters = frozenset().union(*(p.parameters for p in points))
    labels = _labels([p.cell for p in points])
    made = tuple(replace(p, label=label, parameters=parameters) for p, label in zip(points, labels, strict=True))
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


def series(result: Result, points: Sequence[Point], used: Iterable[str]) -> list[Point]:
    """The points with labels extended by what `used` leaves ambiguous: 'S-buffer, p_d 0.25'."""
    names = result.split(points, used)
    return [replace(p, label=", ".join([p.label, *(heading(n, p.at(n), " ") for n in names
                                                   if p.at(n) is not None)])) for p in points]


def values(points: Iterable[Point], name: str) -> list[Any]:
    """Distinct coordinates along `name`, ascending where they are numbers, else in order of appearance."""
    found = list(dict.fromkeys(v for v in (p.at(name) for p in points) if v is not None))
    return sorted(found) if all(isinstance(v, (int, float)) for v in found) else found


def drawn_measure(name: str, where: str) -> str:
    """The measure that `y: name` draws. Raises StoreError naming the nearest one."""
    if name not in MEASURES:
        raise StoreError(f"{where}: y: {name!r} unknown; allowed: {', '.join(MEASURES)}{nearest(name, MEASURES)}")
    return IN_MIB.get(name, name)


def bare(name: str) -> str:
    """'scene.pixel_density' and 'p_d' are 'pixel_density'."""
    name = name.rsplit(".", 1)[-1]
    return ALIASES.get(name, name)


def short(name: str) -> str:
    return SHORT.get(bare(name), bare(name).replace("_", " "))


def heading(name: str, value: Any, between: str = " = ") -> str:
    return f"{short(name)}{between}{plain(value)}" if value is not None else f"any {short(name)}"


def plain(value: Any) -> str:
    """A coordinate as people write it: 640×480, 0.25, 0.1–0.6, random."""
    if isinstance(value, (tuple, list)):
        between = "–" if any(isinstance(v, float) for v in value) else "×"
        return between.join(map(plain, dict.fromkeys(value) if between == "–" else value))
    return f"{value:g}" if isinstance(value, float) else str(value)


def number(value: float | None, digits: int = 3) -> str:
    """`value` to at least `digits` significant digits, no exponent from 1e-4 to 1e7; an int whole, None empty."""
    if value is None or isinstance(value, int):
        return "" if value is None else str(value)
    if value == 0 or not math.isfinite(value):
        return f"{value:g}"
    if not 1e-4 <= abs(value) < 1e7:
        return f"{value:.{digits}g}"
    digits = max(digits, len(str(int(abs(value)))))
    return f"{value:#.{digits}g}".rstrip(".")


def percent(share: float, sign: str = "") -> str:
    """'2.5 %', '38 %', '210 %'; with `sign` '+', also those that grow have theirs."""
    return f"{100 * share:{sign}{'.0f' if abs(share) >= 0.1 else '.2g'}} %"


def figure_of(source: Mapping[str, Any]) -> str:
    """'Fig. 6', 'Table 1', '§4': where in its paper an experiment stands."""
    figure = str(source.get("figure") or "")
    return f"Fig. {figure}" if figure[:1].isdigit() else figure


def _hashable(value: Any) -> Any:
    return tuple(value) if isinstance(value, list) else value


def _distinguishes(points: Sequence[Point], axis: str, used: Sequence[str]) -> bool:
    seen: dict[tuple, Any] = {}
    for p in points:
        place = (p.label, *(p.at(u) for u in used))
        if seen.setdefault(place, p.at(axis)) != p.at(axis):
            return True
    return False


def _current(cells: Iterable[Cell]) -> list[Cell]:
    """Without records that a planned cell of the same point replaces (other shaders, drivers or settings)."""
    kept: dict[str, Cell] = {}
    for cell in cells:
        identity = [cell["method"], cell["label"], cell["params"], cell["scene"], cell["point"], device_name(cell)]
        kept.setdefault(json.dumps(identity, sort_keys=True), cell)
    return list(kept.values())


def _labels(cells: Sequence[Cell]) -> list[str]:
    """A label per cell; entries that share one are told apart by the parameters in which they differ."""
    swept = {bare(name) for cell in cells for name in cell["point"]}
    entries: dict[str, dict[str, dict]] = {}
    for cell in cells:
        fixed = {"method": cell["method"]} | {n: v for n, v in cell["params"].items() if n not in swept}
        entries.setdefault(cell["label"], {})[json.dumps(fixed, sort_keys=True)] = fixed
    return [_label(cell, list(entries[cell["label"]].values())) for cell in cells]


def _label(cell: Cell, same: list[dict]) -> str:
    names = [n for n in dict.fromkeys(n for fixed in same for n in fixed)
             if len({fixed.get(n) for fixed in same}) > 1]
    mine = {"method": cell["method"]} | cell["params"]
    told = [str(mine[n]) if n == "method" else f"{n} {mine[n]}" for n in names if n in mine]
    return f"{cell['label']} ({', '.join(told)})" if told else cell["label"]


def is_floor(point: Point) -> bool:
    return point.method == FLOOR
