"""A page of results over time: each cell night by night, with the nights from which on it was another."""

from __future__ import annotations

import io
import math
from bisect import bisect_left, bisect_right
from collections import defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import accumulate
from pathlib import Path
from statistics import median
from typing import Any

from .. import __version__
from ..compare.sides import Side, load_side
from ..report.data import number, percent
from ..store import ResultFolder, write_file
from .content import without_paths
from .pictures import data_uri
from .write import template

ERROR_RATE = 0.02  # of a whole page: the chance that it shows a change where there is none, night by night independent
MATTERS = 0.02  # smallest relative difference of two medians that is reported
LEAST_NIGHTS = 3  # on either side of a change
DRAWN = 6  # cells in a chart: those that moved most
INCHES, DOTS = (7.2, 2.6), 110


@dataclass(frozen=True)
class Night:
    """A cell on one night. `date`: UTC, as the manifest has it; `commit`: of the program, where it is known."""

    date: str
    commit: str
    time_ms: float


@dataclass(frozen=True)
class Change:
    """A night from which on a cell took `ratio` times as long; `chance`: of so large a change where there is none."""

    night: Night
    ratio: float
    chance: float


@dataclass(frozen=True)
class Trend:
    """A cell over all nights that have a time of it."""

    name: str
    nights: tuple[Night, ...]
    changes: tuple[Change, ...]

    @property
    def moved(self) -> float:
        """Logarithm of how far the largest change goes; without one, how far the last night is from the first."""
        ratios = [c.ratio for c in self.changes] or [self.nights[-1].time_ms / self.nights[0].time_ms]
        return max(abs(math.log(ratio)) for ratio in ratios)


@dataclass(frozen=True)
class Group:
    """The cells of one config on one device."""

    anchor: str
    experiment: str
    device: str
    trends: tuple[Trend, ...]
    uri: str
    width: int
    height: int


def pettitt(values: Sequence[float]) -> tuple[int, float]:
    """The most likely place of a change, as the number of values before it, and its chance without any change.

    Pettitt's rank test (Applied Statistics 28, 1979), with his approximation of the chance. It asks nothing of the
    distribution. Fewer than 16 values show no change at 1 %, and fewer than 26 none at 0.02 %, the rate of each of 100
    cells. Of the kept libraries, ruptures needs scipy and states no chance, and otava reads files of its own.
    """
    n = len(values)
    if n < 2:
        return 0, 1.0
    ordered = sorted(values)
    middle = {v: (bisect_left(ordered, v) + bisect_right(ordered, v) + 1) / 2 for v in values}  # rank from 1, of ties
    sums = [2 * r - at * (n + 1) for at, r in enumerate(accumulate(middle[v] for v in values[:-1]), 1)]
    at = max(range(len(sums)), key=lambda i: abs(sums[i]))
    return at + 1, min(1.0, 2 * math.exp(-6 * sums[at] ** 2 / (n**3 + n**2)))


def changes(nights: Sequence[Night], rate: float) -> list[Change]:
    """The nights from which on the times are others, by `pettitt` on ever shorter stretches, in order.

    The rank test says whether; the night is where the distances from the medians of both sides are least.
    """
    times = [night.time_ms for night in nights]
    _, chance = pettitt(times)
    if chance > rate or len(times) < 2 * LEAST_NIGHTS:
        return []
    at = min(range(LEAST_NIGHTS, len(times) - LEAST_NIGHTS + 1), key=lambda i: _apart(times[:i]) + _apart(times[i:]))
    ratio = median(times[at:]) / median(times[:at])
    if abs(ratio - 1) < MATTERS:
        return []
    return [*changes(nights[:at], rate), Change(nights[at], ratio, chance), *changes(nights[at:], rate)]


def _apart(times: Sequence[float]) -> float:
    middle = median(times)
    return sum(abs(time - middle) for time in times)


def groups(folders: Iterable[ResultFolder]) -> list[Group]:
    """The cells of all results, by config and device, in order of date."""
    found: dict[tuple[str, str], dict[str, list[tuple[str, Night]]]] = defaultdict(lambda: defaultdict(list))
    for date, side in sorted(_dated(folders), key=lambda entry: entry[0]):
        commit = _commit(side)
        for identity, entry in side.entries.items():
            time_ms = entry.point.row["time_ms"]
            if entry.point.status == "ok" and time_ms:
                place = entry.experiment, str(entry.point.row.get("device") or "unknown device")
                found[place][identity].append((entry.name, Night(date, commit, time_ms)))
    tested = sum(len(cells) for cells in found.values())
    return [_group(f"g{at}", *place, cells, ERROR_RATE / tested) for at, (place, cells) in enumerate(found.items(), 1)]


def _dated(folders: Iterable[ResultFolder]) -> Iterable[tuple[str, Side]]:
    for folder in folders:
        started = folder.manifest().get("started")
        if isinstance(started, str):
            yield started, load_side(str(folder.path))


def _commit(side: Side) -> str:
    revision = side.environment.get("revision")
    if not isinstance(revision, dict) or not isinstance(revision.get("commit"), str):
        return ""
    return revision["commit"][:12] + (" with changes" if revision.get("dirty") else "")


def _group(anchor: str, experiment: str, device: str, cells: dict[str, list[tuple[str, Night]]], rate: float) -> Group:
    trends = []
    for told in cells.values():
        nights = tuple(night for _, night in told)
        trends.append(Trend(without_paths(told[-1][0]), nights, tuple(changes(nights, rate))))
    trends.sort(key=lambda trend: (not trend.changes, -trend.moved))
    return Group(anchor, experiment, device, tuple(trends), *_chart(trends[:DRAWN]))


def _chart(trends: Sequence[Trend]) -> tuple[str, int, int]:
    """The times of some cells over their own first ones, with their changes, as a PNG."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(INCHES, DOTS, layout="constrained")
    axes = figure.add_subplot()
    dates = sorted({night.date for trend in trends for night in trend.nights})
    for number_of, trend in enumerate(trends):
        first = trend.nights[0].time_ms
        places = [dates.index(night.date) for night in trend.nights]
        axes.plot(places, [n.time_ms / first for n in trend.nights], marker=".", lw=1, color=f"C{number_of}",
                  label=trend.name)
        for change in trend.changes:
            axes.axvline(dates.index(change.night.date) - 0.5, color=f"C{number_of}", lw=1, ls=":")
    step = max(1, len(dates) // 5)
    axes.set_xticks(range(0, len(dates), step), [date[:10] for date in dates[::step]], fontsize=8)
    axes.set_ylabel("time / that of the first night", fontsize=8)
    axes.tick_params(axis="y", labelsize=8)
    axes.legend(fontsize=7, loc="upper left", bbox_to_anchor=(1, 1), frameon=False)
    content = io.BytesIO()
    FigureCanvasAgg(figure).print_png(content)
    width, height = figure.canvas.get_width_height()
    return data_uri(content.getvalue(), "png"), width, height


def write_trend(folders: Sequence[ResultFolder], target: Path) -> list[Group]:
    """Write the page to `target`. Raises StoreError."""
    found = groups(folders)
    nights = sorted({night.date for group in found for trend in group.trends for night in trend.nights})
    rows: dict[str, Any] = {"groups": found, "nights": nights, "version": __version__, "number": number,
                            "percent": percent, "rate": ERROR_RATE, "matters": MATTERS}
    write_file(target, template("trend.html.j2").render(**rows).encode())
    return found
