"""Names the measured method to take: the fastest that keeps an error and a memory budget, and how sure that is."""

from __future__ import annotations

import json
import math
import textwrap
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from ..stats import Interval
from ..store import device_name
from . import data
from .data import Point, Result, number
from .frontier import ScenePoints, places
from .tables import Grid

METRICS = {"rmse": "rmse", "flip": "flip", "max": "max_error_all"}  # what `--metric` takes, and its column
MOST_SHOWN = 5
IDLE_BUDGET = 8  # a memory limit of so many times what anything takes was meant for another scene


@dataclass(frozen=True)
class Bounds:
    """The limits of an image's error and memory; `memory_mib` None is no limit."""

    metric: str  # a key of METRICS
    most_error: float
    memory_mib: float | None = None

    @property
    def column(self) -> str:
        return METRICS[self.metric]

    def keeps_error(self, point: Point) -> bool:
        return point.measure(self.column)[1] <= self.most_error

    def keeps_memory(self, point: Point) -> bool:
        return self.memory_mib is None or point.measure("memory_mib")[1] <= self.memory_mib

    def __str__(self) -> str:
        memory = "" if self.memory_mib is None else f", memory at most {self.memory_mib:g} MiB"
        return f"{self.metric} at most {self.most_error:g}{memory}"


@dataclass(frozen=True)
class Advice:
    """The answer by the cells of one scene. `kept` are those within the limits, the fastest first."""

    experiment: str
    device: str
    place: ScenePoints
    limits: Bounds
    noise: float | None  # relative; how far one thing measured twice is from itself
    unmeasured: int  # planned cells of the experiment without a record
    unsteady: str = ""  # what the machine did otherwise at the end of its run
    dates: str = ""  # on which it was measured
    config: str = ""  # what `mfr-bench run` takes to measure it; empty where that is not known
    distance: str = ""  # from the scene that was asked for, in words

    @property
    def scene(self) -> str:
        """Viewport and scene, in words."""
        return data.scene_words(self.place.points)

    @property
    def warnings(self) -> list[str]:
        """The reasons why the answer may not fit the question."""
        used = [p.measure("memory_mib")[1] for p in self.measured if p.measure("memory_mib")[1] is not None]
        limit = self.limits.memory_mib
        if limit is None or not used or max(used) * IDLE_BUDGET > limit:
            return []
        width, height = (self.place.points[0].row[side] for side in ("width", "height"))
        most = f"of {limit:g} MiB no cell takes more than {number(max(used))}, at {width}×{height} pixels"
        return [f"The memory limit decides nothing here: {most}. Measure at the size that the limit is meant for."]

    @property
    def measured(self) -> list[Point]:
        needed = (self.limits.column, "memory_mib")
        return [p for p in self.place.points
                if p.row["time_ms"] and all(p.measure(name)[1] is not None for name in needed)]

    @property
    def kept(self) -> list[Point]:
        found = sorted((p for p in self.measured if self.limits.keeps_error(p) and self.limits.keeps_memory(p)),
                       key=lambda p: p.row["time_ms"])
        fastest = found[0] if found else None
        for p in found[1:]:  # where they took turns, one with the longer median may be the faster for sure
            high = p.over(fastest)[2]
            fastest = p if high is not None and high < 1 else fastest
        return sorted(found, key=lambda p: p is not fastest)

    def ratio(self, point: Point) -> Interval:
        """Ratio of the time to that of the fastest."""
        return point.over(self.kept[0])

    def told_apart(self, point: Point) -> bool | None:
        """Whether the point is surely slower than the fastest; None where too few samples were taken to decide."""
        ratio = self.ratio(point)
        return None if None in ratio else point.apart(ratio)

    @property
    def apart_from_times(self) -> list[Point]:
        """The points whose times, divided by that of the fastest, lie outside of the interval of their ratio."""
        return [p for p in self.kept[1:] if None not in (ratio := self.ratio(p))
                and not ratio[0] <= p.row["time_ms"] / self.kept[0].row["time_ms"] <= ratio[2]]

    @property
    def rivals(self) -> list[Point]:
        """Points that may be as fast as the fastest."""
        return [p for p in self.kept[1:] if not self.told_apart(p)]

    @property
    def sure(self) -> bool | None:
        """Whether the fastest is surely faster than every other; None if no other keeps the limits."""
        return not self.rivals if len(self.kept) > 1 else None


def advise(results: Iterable[Result], limits: Bounds, like: Mapping[str, Any] | None = None,
           config_of: Callable[[Result], str] = lambda result: result.name) -> list[Advice]:
    """Advice for every scene of the results, device by device; with `like` for the scene next to it on each device.

    like: keys of a scene with their values. config_of: what `mfr-bench run` takes to measure a result again.
    """
    found = [Advice(result.name, str(device_name(place.points[0].cell)), place, limits,
                    result.manifest.get("noise_floor_rel"), result.unmeasured, result.unsteady,
                    result.dates, config_of(result))
             for result in results for place in (places(result) if result.points else ())]
    if not like:
        return found
    nearest: dict[str, Advice] = {}
    for advice in found:
        known = nearest.setdefault(advice.device, advice)
        if _apart(advice, like) < _apart(known, like):
            nearest[advice.device] = advice
    return [replace(advice, distance=_distance(advice, like)) for advice in nearest.values()]


def _factor(wanted: Any, here: Any) -> float | None:
    """The factor between a measured value and the one wanted, at least 1; of viewports by pixels; None for words."""
    if isinstance(wanted, tuple) and isinstance(here, tuple) and len(wanted) == len(here) == 2:
        wanted, here = (a * b for a, b in (wanted, here)) if isinstance(wanted[0], int) else map(sum, (wanted, here))
    numbers = all(isinstance(v, (int, float)) and v > 0 for v in (wanted, here))
    return max(wanted / here, here / wanted) if numbers else None


def _apart(advice: Advice, like: Mapping[str, Any]) -> float:
    """The distance of a scene from the one asked for: doublings of each number, and one for each word that differs."""
    total = 0.0
    for name, wanted in like.items():
        here = advice.place.points[0].at(name)
        factor = _factor(wanted, here)
        total += (wanted != here) if factor is None else math.log2(factor)
    return total


def _distance(advice: Advice, like: Mapping[str, Any]) -> str:
    parts = []
    for name, wanted in like.items():
        here = advice.place.points[0].at(name)
        factor = _factor(wanted, here)
        if wanted != here:
            times = f", {number(factor)} times apart" if factor is not None else ""
            parts.append(f"{data.short(name)} {data.plain(here) if here is not None else 'none'} where "
                         f"{data.plain(wanted)} was asked for{times}")
    return "; ".join(parts) or "as asked for"


# --- words -----------------------------------------------------------------------------------------


def chosen(point: Point) -> dict[str, Any]:
    """k, and the parameters in which a cell differs from its method's defaults."""
    from ..methods import catalog

    method = catalog().get(point.method)
    defaults = method.complete({}) if method else {}
    return {name: value for name, value in point.cell["params"].items()
            if name == "k" or defaults.get(name) != value}


def written(point: Point) -> str:
    """The method as a config or a command takes it."""
    return written_as(point.method, chosen(point))


def written_as(method: str, params: Mapping[str, Any]) -> str:
    """The id of a method with these parameters, as a command takes it."""
    return " ".join([method, *(f"{name}={data.plain(value)}" for name, value in params.items())])


def _grid(advice: Advice) -> Grid:
    rows = [(written(p), *(number(p.measure(name)[1]) for name in ("time_ms", "memory_mib", advice.limits.column)),
             _spread(advice.ratio(p)) if i else "1") for i, p in enumerate(advice.kept[:MOST_SHOWN])]
    return Grid("", "", ("method", "time (ms)", "memory (MiB)", advice.limits.column, "times the fastest"), tuple(rows))


def _spread(ratio: Interval) -> str:
    low, middle, high = ratio
    if middle is not None and middle < 1:  # by its median it is slower, where they took turns it is not
        return f"≈ 1 ({low:.2f} to {high:.2f})" if None not in (low, high) else "≈ 1"
    ends = "too few samples for an interval" if low is None or high is None else f"{low:.2f} to {high:.2f}"
    return f"{number(middle)} ({ends})"


def _certainty(advice: Advice) -> str:
    noise = ("its noise floor is not known" if advice.noise is None
             else f"a method measured twice differs by {data.percent(advice.noise)}")
    if advice.sure is None:
        return "Nothing else that was measured keeps the limits."
    if advice.sure:
        return f"Sure: no interval of another reaches it; {noise}."
    names = ", ".join(written(p) for p in advice.rivals[:MOST_SHOWN])
    more = len(advice.rivals) - MOST_SHOWN
    return f"Not told apart from {names}{f' and {more} more' if more > 0 else ''}; {noise}."


def _why_apart(advice: Advice) -> str:
    """Explain a ratio that is not the quotient of the two times beside it; empty where there is none."""
    shown = [p for p in advice.apart_from_times if p in advice.kept[:MOST_SHOWN]]
    if not shown:
        return ""
    names = ", ".join(map(written, shown))
    return ("Ratios compare frames that were drawn in turns, under the same load; a time is the median of all frames. "
            f"So the ratio of {names} is another than the quotient of the times.")


def _missed(advice: Advice) -> str:
    """Name what comes nearest where nothing keeps the bounds."""
    column, measured = advice.limits.column, advice.measured
    if not measured:
        return f"No cell with {column} was measured; {_again(advice, ' --force')} measures all of them."
    closest = min(filter(advice.limits.keeps_memory, measured), key=lambda p: p.measure(column)[1], default=None)
    smallest = min(filter(advice.limits.keeps_error, measured), key=lambda p: p.measure("memory_mib")[1], default=None)
    parts = ["Nothing measured keeps this."]
    if closest:
        parts.append(f"Within the memory the least {column} is {number(closest.measure(column)[1])}: "
                     f"{written(closest)}." if advice.limits.memory_mib is not None else
                     f"The least {column} is {number(closest.measure(column)[1])}: {written(closest)}.")
    if smallest:
        parts.append(f"Within the error the least memory is {number(smallest.measure('memory_mib')[1])} MiB: "
                     f"{written(smallest)}.")
    return " ".join(parts)


def _again(advice: Advice, options: str = "") -> str:
    """The command that measures the experiment."""
    return f"mfr-bench run {advice.config}{options}" if advice.config else f"the command that measured it{options}"


def as_text(found: Sequence[Advice], width: int) -> str:
    """A paragraph with a table for each scene, at most `width` columns wide where names allow."""
    return "\n\n".join(_text(advice, width) for advice in found)


def _text(advice: Advice, width: int) -> str:
    where = " · ".join(part for part in (advice.experiment, advice.device, advice.place.name) if part)
    about = [f"{where}: {advice.limits}", f"Measured {advice.dates or 'on a day not recorded'}: {advice.scene}."]
    about += [f"The nearest scene measured: {advice.distance}."] if advice.distance else []
    about += [f"WARNING: {warning}" for warning in advice.warnings]
    lines = [part for line in about for part in textwrap.wrap(line, width, break_on_hyphens=False)]
    if advice.kept:
        lines += ["\n\n".join(chunk.text() for chunk in _grid(advice).chunks(width))]
        lines += textwrap.wrap(_why_apart(advice), width, break_on_hyphens=False)
    count, kept = len(advice.measured), len(advice.kept)
    said = f"{_certainty(advice)} {kept} of {count} cells keep the limits." if advice.kept else _missed(advice)
    if advice.unsteady:
        said += f" Unsteady: {advice.unsteady}."
    if advice.unmeasured:
        said += f" {data.without_record(advice.unmeasured)}: {_again(advice)}."
    return "\n".join([*lines, *textwrap.wrap(said, width, break_on_hyphens=False)])


def as_json(found: Sequence[Advice]) -> str:
    """A list with an object for each scene; `best` is null where nothing keeps the limits."""
    return json.dumps([_record(advice) for advice in found], indent=2, ensure_ascii=False)


def _record(advice: Advice) -> dict[str, Any]:
    kept = advice.kept
    return {"experiment": advice.experiment, "device": advice.device, "scene": advice.scene,
            "place": advice.place.name or None, "size": [advice.place.points[0].row[s] for s in ("width", "height")],
            "dates": advice.dates or None, "distance": advice.distance or None, "warnings": advice.warnings,
            "metric": advice.limits.metric, "max_error": advice.limits.most_error,
            "memory_mb": advice.limits.memory_mib, "best": _cell(advice, kept[0]) if kept else None,
            "runners_up": [_cell(advice, p) for p in kept[1:]], "sure": advice.sure, "noise_floor_rel": advice.noise,
            "unsteady": advice.unsteady or None, "measured": len(advice.measured), "keep_limits": len(kept),
            "unmeasured": advice.unmeasured}


def _cell(advice: Advice, point: Point) -> dict[str, Any]:
    low, middle, high = advice.ratio(point)
    return {"method": point.method, "label": point.label, "params": chosen(point),
            **{name: point.row[name] for name in ("time_ms", "time_ms_low", "time_ms_high", "memory_bytes", "rmse",
                                                  "flip", "max_error_all")},
            "ratio": middle, "ratio_low": low, "ratio_high": high, "told_apart": advice.told_apart(point)}
