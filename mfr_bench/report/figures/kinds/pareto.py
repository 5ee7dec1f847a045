"""Error against cost: every measured cell, and the frontier of those that nothing measured beats in both."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import TYPE_CHECKING, Any

from ....store.columns import COLUMNS, DERIVED, names
from ... import data, style
from ...data import Point, Result
from ...frontier import ScenePoints, equal, places
from ..kind import LOG, X_LABEL, Y_LABEL, Kind, NothingToDraw
from ..placing import Place, Placed, around
from ..scales import log_axis, y_label
from ..series import Options, chosen
from ..sheet import EDGE, HEADING_IN, LEFT, LEGEND_LINE_IN, legend_columns, sheet_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

LEAST = 1e-9  # where an error of 0 is drawn
NAME_PT, NUMBER_PT = 5.4, 4.6  # of what stands next to points on a frontier, and on none
BESIDE = ((3.0, -3.0), (-3.0, -3.0), (4.0, 0.0), (-4.0, 0.0), (-3.0, 3.0), (3.0, -9.5), (-3.0, -9.5), (-3.0, 9.5),
          (3.0, -16.0), (-3.0, -16.0), (3.0, 3.0), (3.0, 9.5))  # offsets of a name, in points
NEAR = around(2.4, 5.0, 8.5, 12.5, 17.0, 22.0)  # offsets of a number, in points
SOLID, HOLLOW = 2.4, 1.6  # half the side of a mark on a frontier, and of one on none, in points
PLOT_IN, LABEL_CHARACTERS = 2.3, 34
FADED = 0.6

KIND = Kind("an error y against a cost x, and what nothing measured beats in both", keys=(LOG, X_LABEL, Y_LABEL),
            x=names((*COLUMNS, *DERIVED), "cost"), y=names(COLUMNS, "error"), needs=("y",))


def draw(result: Result, options: Options) -> Figure:
    """x is a cost, y an error, both logarithmic; a panel for each scene."""
    chart = FrontierChart(result, options, tuple(places(result, chosen(result, options))))
    if not any(place.frontier(chart.x, chart.y) for place in chart.places):
        raise NothingToDraw(f"no cell has both {data.column_of(chart.x)} and {chart.y}")
    columns = min(3, len(chart.places))
    rows = math.ceil(len(chart.places) / columns)
    names = [*chart.labels, "on no frontier"]
    across = legend_columns(names, style.WIDTH_IN - 2 * EDGE, 6.5)
    legend_in = LEGEND_LINE_IN * 0.92 * math.ceil(len(names) / across)
    step = HEADING_IN + PLOT_IN + 0.24
    points = [p for place in chart.places for p in place.points]
    zero = any(p.measure(chart.y)[1] == 0 for p in points)
    judged = "cell of these methods" if options.get("methods") else "measured cell"
    key = (f"Solid: no {judged} is both cheaper and more accurate ({equal(chart.y)}). Hollow: some cell is. "
           "Bars: 95 % interval of the median.")
    notes = [key, *chart.others(), f"An error of 0 is drawn at {LEAST:g}." * zero]
    sheet = sheet_of(result, options, points, notes, style.WIDTH_IN, rows * step + 0.2 + legend_in)
    figure = sheet.figure()
    width = (sheet.width - LEFT - EDGE - 0.12 * (columns - 1)) / columns
    grid: list[Axes] = []
    for i, place in enumerate(chart.places):
        shared = {name: grid[0] for name in ("sharex", "sharey") if grid}
        axes = sheet.axes(figure, LEFT + i % columns * (width + 0.12), i // columns * step + HEADING_IN, width, PLOT_IN,
                          **shared)
        grid.append(axes)
        chart.draw(axes, place)
        axes.set_title("\n".join(textwrap.wrap(place.name, LABEL_CHARACTERS)), loc="left")
    for i, axes in enumerate(grid):
        chart.finish(axes, leftmost=i % columns == 0, lowest=i + columns >= len(grid))
    for axes, place in zip(grid, chart.places, strict=True):  # when the scales, which they share, are set
        chart.name(axes, place)
    figure.legend(handles=chart.handles(), loc="lower left", ncol=across, fontsize=6.5, handlelength=1.2,
                  columnspacing=1.0, labelspacing=0.35, borderpad=0, borderaxespad=0,
                  bbox_to_anchor=(EDGE / sheet.width, sheet.bottom / sheet.height))
    return figure


@dataclass(frozen=True)
class FrontierChart:
    """The content of a figure, in any number of panels."""

    result: Result
    options: Options
    places: tuple[ScenePoints, ...]

    @property
    def x(self) -> str:
        return data.IN_MIB.get(self.options["x"], self.options["x"])

    @property
    def y(self) -> str:
        return self.options["y"]

    @cached_property
    def labels(self) -> list[str]:
        """Labels of the points on any frontier, in the order of methods in the config."""
        return list(self._members)

    @cached_property
    def _members(self) -> dict[str, Point]:
        on = {p.label: p for place in self.places for p in place.frontier(self.x, self.y)}
        return {p.label: on[p.label] for place in self.places for p in place.points if p.label in on}

    def draw(self, axes: Axes, place: ScenePoints) -> None:
        frontier = place.frontier(self.x, self.y)
        on = {p.cell["key"] for p in frontier}
        shown = self._shown(place)
        self._faded(axes, [p for p in shown if p.cell["key"] not in on])
        for p in shown:
            if p.cell["key"] in on:
                axes.plot([p.measure(self.x)[1]], [self._error(p)], zorder=3, **self._look(p))
        self._intervals(axes, [p for p in shown if p.cell["key"] in on], zorder=3)
        if frontier:
            axes.step([p.measure(self.x)[1] for p in frontier], [self._error(p) for p in frontier], where="post",
                      color=style.INK, linewidth=0.9, zorder=2.5)

    @cached_property
    def numbers(self) -> dict[str, int]:
        """The number of each label that has a point on no frontier: those of one entry of the config in a row."""
        entries: dict[str, dict[str, None]] = {}
        for place in self.places:
            on = {p.cell["key"] for p in place.frontier(self.x, self.y)}
            for p in self._shown(place):
                if p.cell["key"] not in on:
                    entries.setdefault(p.cell["label"], {})[p.label] = None
        return {label: number for number, label in enumerate((label for labels in entries.values() for label in labels),
                                                             1)}

    def others(self) -> list[str]:
        """The sentence that names the numbers: '3 F2B; 4–6 K+B-Array, k 2, 4, 8'."""
        runs: dict[tuple[str, str], list[str]] = {}
        for label in self.numbers:
            start, _, end = label.rpartition(" ")
            runs.setdefault((start, "") if end.isdigit() else ("", label), []).append(label)
        told = [f"{_span([self.numbers[label] for label in labels])} {labels[0]}"
                + "".join(f", {label.rpartition(' ')[2]}" for label in labels[1:]) for labels in runs.values()]
        return [f"On no frontier, by number where there is room: {'; '.join(told)}."] if told else []

    def name(self, axes: Axes, place: ScenePoints) -> None:
        """Write the labels of the frontier beside it, most below, and the others' numbers, as far as they fit.

        The legend names the points on a frontier too, by their marks.
        """
        frontier = place.frontier(self.x, self.y)
        on = {p.cell["key"] for p in frontier}
        marks = [(self._at(p), SOLID if p.cell["key"] in on else HOLLOW) for p in self._shown(place)]
        placed = Placed(axes, marks, self._steps(frontier))
        clear = {"boxstyle": "square,pad=0.05", "facecolor": "white", "edgecolor": "none", "alpha": 0.7}
        for p in frontier:
            placed.put(self._at(p), p.label, NAME_PT, BESIDE, color=style.INK, zorder=4, bbox=clear)
        for p in self._shown(place):
            if p.cell["key"] not in on:
                placed.put(self._at(p), str(self.numbers[p.label]), NUMBER_PT, NEAR, color=style.QUIET, zorder=3.5)

    def _steps(self, frontier: Sequence[Point]) -> list[tuple[Place, Place]]:
        """The ends of the lines that a frontier is drawn with: from each point right, then down to the next."""
        corners = [(self._at(p), (self._at(q)[0], self._at(p)[1]), self._at(q)) for p, q in pairwise(frontier)]
        return [ends for corner in corners for ends in pairwise(corner)]

    def _shown(self, place: ScenePoints) -> list[Point]:
        return [p for p in place.points if p.measure(self.x)[1] and p.measure(self.y)[1] is not None]

    def _at(self, point: Point) -> tuple[float, float]:
        return point.measure(self.x)[1], self._error(point)

    def _error(self, point: Point) -> float:
        return max(LEAST, point.measure(self.y)[1])

    def _faded(self, axes: Axes, points: Sequence[Point]) -> None:
        """Points on no frontier, hundreds of them in a figure: one artist for all."""
        if points:
            axes.scatter([p.measure(self.x)[1] for p in points], [self._error(p) for p in points], s=3.2**2,
                         facecolors="none", edgecolors=[style.method_colour(p.method) for p in points], linewidths=0.6,
                         alpha=FADED, zorder=1.5)
            self._intervals(axes, points, alpha=FADED, zorder=1.5)

    def _intervals(self, axes: Axes, points: Sequence[Point], **look: Any) -> None:
        """The intervals of the points that have one."""
        known = [(p, *p.measure(self.x)) for p in points]
        known = [(p, low, high) for p, low, _, high in known if low is not None and high is not None]
        if known:
            axes.hlines([self._error(p) for p, _, _ in known], [low for _, low, _ in known],
                        [high for _, _, high in known], colors=[style.method_colour(p.method) for p, _, _ in known],
                        linewidths=0.7, **look)

    def _look(self, point: Point) -> dict[str, Any]:
        """The mark of a point on a frontier."""
        return {"linestyle": "", "marker": self._marker(point.label), "color": style.method_colour(point.method),
                "markersize": 4.8, "markeredgecolor": "white", "markeredgewidth": 0.4, "label": point.label}

    def _marker(self, label: str) -> str:
        return style.MARKERS[self.labels.index(label) % len(style.MARKERS)]

    def finish(self, axes: Axes, leftmost: bool, lowest: bool) -> None:
        axes.margins(0.08, 0.12)
        log_axis(axes, "x", 10)
        log_axis(axes, "y", 10)
        axes.grid(which="major")
        axes.tick_params(labelbottom=lowest, labelleft=leftmost)
        if lowest:
            axes.set_xlabel(str(self.options.get("x_label") or data.MEASURES[self.x]))
        if leftmost:
            y_label(axes, str(self.options.get("y_label") or data.MEASURES[self.y]))

    def handles(self) -> Sequence:
        from matplotlib.lines import Line2D

        named = [Line2D([], [], **self._look(point)) for point in self._members.values()]
        return [*named, Line2D([], [], linestyle="", marker="o", markersize=3.2, color=style.QUIET, alpha=FADED,
                               markerfacecolor="none", markeredgewidth=0.6,
                               label="on no frontier")]


def _span(numbers: Sequence[int]) -> str:
    """Numbers in a row: 3, or 4–6."""
    return "–".join(map(str, dict.fromkeys((numbers[0], numbers[-1]))))
