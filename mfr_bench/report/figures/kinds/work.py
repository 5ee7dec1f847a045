"""Shows where each method's work goes, and which of the device's limits binds it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

from ... import data, style
from ...data import Point, Result, number
from ..kind import Kind, NothingToDraw
from ..scales import log_axis
from ..series import Options, series_of
from ..sheet import EDGE, sheet_of, widest

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

NEAR = 1.15  # counts within this factor would hide each other's markers
ROW_IN, HEADING_IN, FOOT_IN, GAP_IN = 0.26, 0.24, 0.42, 0.36  # GAP_IN: half a tick of eight digits fits
LIMITS_IN = 1.9  # width of the bars against the device's limits
COUNTED: Mapping[str, tuple[str, str, str]] = {  # counters that are added up: name, colour, marker
    "fragments shaded": ("geometry", style.BLUE, "o"),
    "stored": ("stored", style.GREEN, "s"),
    "read back": ("loaded", style.SKY, "^"),
    "moved by the sort": ("moved", style.ORANGE, "D"),
    "atomics": ("atomics", style.VERMILION, "v"),
    "pixels of full-screen passes": ("pixels", style.PURPLE, "P"),
    "of them resolved empty": ("empty", style.GREY, "X"),
    "words read and written": ("words", style.INK, "|"),
}

KIND = Kind("what each method does in a frame, where measure.counters asks for it, and which limit binds it",
            y=("time_ms",))


def draw(result: Result, options: Options) -> Figure:
    """A panel for each value of x: counts of each method on the left, its time at the device's limits on the right."""
    chart = Work(result, tuple(p for p in series_of(result, options) if p.cell.get("work")))
    if not chart.points:
        raise NothingToDraw("no cell has counted its work, as measure.counters asks for")
    panels = [(v, [p for p in chart.points if p.at(options["x"]) in (v, None)])
              for v in data.values(chart.points, options["x"])] or [(None, list(chart.points))]
    heights = [HEADING_IN + ROW_IN * max(1, len(points)) + FOOT_IN for _, points in panels]
    legend = 0.36
    sheet = sheet_of(result, options, chart.points, chart.notes(), style.WIDTH_IN, sum(heights) + legend)
    figure = sheet.figure()
    names = min(1.9, widest((p.label for p in chart.points), 7.0) + 0.08)
    top = legend
    for (value, points), height in zip(panels, heights, strict=True):
        inner = height - HEADING_IN - FOOT_IN
        width = style.WIDTH_IN - 2 * EDGE - names - LIMITS_IN - GAP_IN
        counts = sheet.axes(figure, EDGE + names, top + HEADING_IN, width, inner)
        limits = sheet.axes(figure, EDGE + names + width + GAP_IN, top + HEADING_IN, LIMITS_IN - 0.1, inner)
        heading = data.heading(options["x"], value) if value is not None else ""
        chart.draw_counts(counts, points, heading)
        chart.draw_limits(limits, points)
        top += height
    handles, labels = figure.axes[0].get_legend_handles_labels()
    shown = dict(zip(labels, handles, strict=True))
    figure.legend(shown.values(), shown.keys(), loc="upper left", ncols=4, fontsize=style.SMALL_PT + 0.6,
                  bbox_to_anchor=(0.0, sheet.y(0.0)), columnspacing=1.2, handletextpad=0.3)
    return figure


@dataclass(frozen=True)
class Work:
    result: Result
    points: tuple[Point, ...]

    @cached_property
    def rates(self) -> Mapping[str, float]:
        """The device's copy bandwidth and fill rate, as the run measured them."""
        return (self.result.manifest.get("calibration") or {}).get("rates") or {}

    def draw_counts(self, axes: Axes, points: Sequence[Point], heading: str) -> None:
        for row, point in enumerate(points):
            total = totals(point.cell["work"])
            places = _spread({name: total[name] for name, _, _ in COUNTED.values() if total[name]})
            for label, (name, colour, marker) in COUNTED.items():
                if total[name]:
                    axes.plot(total[name], row + places[name], linestyle="", marker=marker, color=colour,
                              markersize=4.4, label=label, alpha=0.9, clip_on=False)
        log_axis(axes, "x", 10)
        _rows(axes, [p.label for p in points])
        axes.set_title(heading, loc="left", fontsize=7.0, pad=3)
        axes.set_xlabel("in one frame", fontsize=style.SMALL_PT, labelpad=1.5)
        axes.grid(axis="x")

    def draw_limits(self, axes: Axes, points: Sequence[Point]) -> None:
        """Shares of the frame's time that its bytes would take at the copy bandwidth, its shading at the fill rate."""
        for row, point in enumerate(points):
            for place, share, colour in self._shares(point):
                axes.barh(row + place, share, 0.36, color=colour, linewidth=0)
                axes.text(share + 1.5, row + place, f"{number(share)} %", va="center", fontsize=style.NUMBER_PT)
        _rows(axes, [""] * len(points))
        axes.set_xlim(0, 118)
        axes.set_title("of the time, at the device's limits", loc="left", fontsize=7.0, pad=3)
        axes.set_xlabel("above: bytes at copy bandwidth (%)\nbelow: shading at fill rate (%)", fontsize=style.SMALL_PT,
                        labelpad=1.5)
        axes.grid(axis="x")

    def _shares(self, point: Point) -> list[tuple[float, float, str]]:
        total, time_s = totals(point.cell["work"]), (point.row["time_ms"] or 0.0) / 1e3
        if not self.rates or not time_s:
            return []
        moved = 4 * total["words"] / self.rates["copy_bytes_per_s"]
        shaded = (total["geometry"] + total["pixels"]) / self.rates["fill_pixels_per_s"]
        return [(-0.21, 100 * moved / time_s, style.INK), (0.21, 100 * shaded / time_s, style.GREY)]

    def notes(self) -> list[str]:
        text = "Counted by programs of their own in a frame that is not timed; what a cache saves is not seen."
        if self.rates:
            text += (f" This device copies {self.rates['copy_bytes_per_s'] / 1e9:.3g} GB/s, read and written, and "
                     f"fills {self.rates['fill_pixels_per_s'] / 1e9:.3g} Gpixel/s.")
        return [text]


def totals(work: Mapping[str, Mapping[str, int]]) -> dict[str, int]:
    """Sums over the passes of a frame: of each counter, and of invocations by the kind of pass."""
    def add(name: str, geometry: bool | None = None) -> int:
        return sum(w.get(name, 0) for w in work.values() if geometry is None or bool(w.get("rasterized")) == geometry)

    return {name: add(name) for name in ("stored", "loaded", "moved", "atomics", "empty")} | {
        "geometry": add("invocations", geometry=True), "pixels": add("invocations", geometry=False),
        "words": add("words_read") + add("words_written")}


def _spread(counts: Mapping[str, int]) -> dict[str, float]:
    """The height of each marker within its row, in rows: counts that would hide each other one above the other."""
    groups: list[list[str]] = []
    for name in sorted(counts, key=lambda name: counts[name]):
        near = groups and counts[name] < NEAR * counts[groups[-1][-1]]
        groups[-1].append(name) if near else groups.append([name])
    return {name: 0.52 * ((i + 0.5) / len(group) - 0.5) for group in groups for i, name in enumerate(group)}


def _rows(axes: Axes, labels: Sequence[str]) -> None:
    axes.set_ylim(len(labels) - 0.4, -0.6)
    axes.set_yticks(range(len(labels)), labels, fontsize=7.0)
    axes.tick_params(axis="y", length=0)
    axes.tick_params(axis="x", labelsize=style.SMALL_PT)
