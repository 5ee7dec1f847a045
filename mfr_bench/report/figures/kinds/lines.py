"""Lines with their intervals, in panels."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

from ... import data, style
from ...data import Point, Result
from ..fits import DEGREES, Fit, draw_fit, fits_of, room_for
from ..kind import FLOOR, GAIN_OF, LOG, LOG_BASE, PANELS, PASSES, PRINTED, X_LABEL, Y_LABEL, Key, Kind
from ..marks import Guide, Mark, draw_guides, draw_marks, guides_of, marks_of
from ..scales import log_axes, log_axis, log_base, tick, y_label
from ..series import (
    Options,
    axis_label,
    gaps,
    hold_along,
    hold_drawn,
    labels_of,
    panels_of,
    refusals,
    series_of,
    y_text,
)
from ..sheet import EDGE, HEADING_IN, LEFT, LONG_LABEL, fitted, sheet_of, text_width, widest

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

HARD_SPACE, SHORT_PART = "\u00a0", 12  # characters of a part of a label that is not broken
TICK_GAP_IN = 0.07  # between two ticks; values of x that are nearer share one
SEEN_APART = 0.003  # of the value on a logarithmic axis, of the largest one on a linear: less is not seen
MOST_TICKS = 13  # each value of x has one, up to so many

KIND = Kind(
    "x against y, one line per method with its interval; kplus_2015 Fig. 9, gpupro5 Figs. 1.4 to 1.7",
    keys=(LOG, LOG_BASE, X_LABEL, Y_LABEL, PANELS, FLOOR, PASSES, GAIN_OF, PRINTED,
          Key("bound", "the error that rounding explains, as a dotted line", "flag", default=False),
          Key("places", "a table of the methods whose place changes along x", "flag", default=False),
          Key("fit", "a polynomial through each line", tuple(DEGREES))))


def draw(result: Result, options: Options) -> Figure:
    """x against y, one line per method with its interval; kplus_2015 Fig. 9, gpupro5 Figs. 1.4 to 1.7."""
    chart = LineChart(result, options, tuple(series_of(result, options)))
    hold_drawn(chart.points, chart.y)
    hold_along(chart.points, chart.x)
    panels = panels_of(chart.points, options)
    columns = 1 if options.get("fit") else min(3, len(panels)) or 1
    rows = math.ceil(len(panels) / columns)
    entries = {label: "\n".join(_broken(label)) for label in chart.entries}
    legend_width = widest((line for entry in entries.values() for line in entry.splitlines()), 7.5) + 0.52
    alone = max(2.7, 0.13 * sum(1.3 + e.count("\n") for e in entries.values()))
    plot_height = 1.6 if rows > 2 else 2.2 if rows > 1 else alone
    panel_width = (style.WIDTH_IN - LEFT - legend_width - 2 * EDGE - 0.12 * (columns - 1)) / columns
    headings = [fitted(panel, style.RC["axes.titlesize"], panel_width + EDGE) for panel, _ in panels]
    heading = HEADING_IN + 0.13 * (max(map(len, headings)) - 1) if any(panel for panel, _ in panels) else 0.06
    step = heading + plot_height + 0.24
    notes = [*gaps(chart.points, chart.x, options.get("panels")), *chart.same(panels), *refusals(chart.points)]
    sheet = sheet_of(result, options, chart.points, notes, style.WIDTH_IN, rows * step + 0.18)
    figure = sheet.figure()
    grid: list[Axes] = []
    for i, (_, members) in enumerate(panels):
        shared = {name: grid[0] for name in ("sharex", *(() if options.get("fit") else ("sharey",))) if grid}
        axes = sheet.axes(figure, LEFT + i % columns * (panel_width + 0.12), i // columns * step + heading, panel_width,
                          plot_height, **shared)
        grid.append(axes)
        chart.draw(axes, members)
        axes.set_title("\n".join(headings[i]), loc="left", linespacing=1.0)
    for i, axes in enumerate(grid):
        chart.finish(axes, panel_width, leftmost=i % columns == 0, lowest=i + columns >= len(grid))
    handles = chart.handles(grid)
    figure.legend(handles.values(), [entries[name] for name in handles], loc="upper left", handlelength=3.0,
                  labelspacing=0.55, borderpad=0, borderaxespad=0,
                  bbox_to_anchor=(1 - (legend_width + EDGE) / sheet.width, sheet.y(heading)))
    return figure


@dataclass(frozen=True)
class LineChart:
    """The content of a figure of lines, in any number of panels."""

    result: Result
    options: Options
    points: tuple[Point, ...]

    @property
    def x(self) -> str:
        return self.options["x"]

    @property
    def y(self) -> str:
        return self.options["y"]

    @cached_property
    def labels(self) -> list[str]:
        return labels_of(self.points)

    @cached_property
    def marks(self) -> list[Mark]:
        return marks_of(self.result, self.options, self.points)

    def variant(self, point: Point) -> int:
        """The place of the label among those of its method, with the ones that a figure of gains leaves out."""
        found = self.variants[point.method]
        return found.index(point.label) if point.label in found else len(found)

    @cached_property
    def variants(self) -> dict[str, list[str]]:
        """The labels of each method, in the config's order."""
        points = series_of(self.result, {**self.options, "gain_of": None})
        return {method: labels_of(p for p in points if p.method == method) for method in {p.method for p in points}}

    def colour(self, point: Point) -> str:
        """The colour of the method in a tint for each variant; in a figure of one method, the colour of the variant."""
        if len({p.method for p in self.points}) > 1 or len(self.labels) == 1:
            return style.tint(style.method_colour(point.method), self.variant(point))
        return style.VARIANT_COLOURS[self.labels.index(point.label) % len(style.VARIANT_COLOURS)]

    @cached_property
    def guides(self) -> list[Guide]:
        return guides_of(self.result, self.options)

    @property
    def entries(self) -> list[str]:
        """Everything that the legend may have to name."""
        over = dict.fromkeys(p.sign for p in self.points if p.ending.over_memory)
        quoted = dict.fromkeys(mark.text for mark in (*self.marks, *self.guides))
        return [*self.labels, "floor", "bound", *over, *quoted]

    @cached_property
    def numeric(self) -> bool:
        return all(isinstance(v, (int, float)) for v in data.values(self.points, self.x))

    @cached_property
    def places(self) -> dict[Any, float]:
        """Position of each value of x: the number itself, or its rank where it is none."""
        found = data.values(self.points, self.x)
        return {v: float(v) if self.numeric else float(i) for i, v in enumerate(found)}

    def same(self, panels: Sequence[tuple[str, Sequence[Point]]]) -> list[str]:
        """A sentence on lines that lie on each other in every panel that has both, so that only one is seen."""
        lines: dict[str, dict[tuple[int, Any], float]] = {}
        for i, (_, members) in enumerate(panels):
            for p in members:
                if p.status == "ok" and p.at(self.x) is not None and p.shown(self.y)[1] is not None:
                    lines.setdefault(p.label, {})[i, p.at(self.x)] = p.shown(self.y)[1]
        scale = 0.0 if "y" in log_axes(self.options) else max((abs(v) for line in lines.values()
                                                                for v in line.values()), default=0.0)
        groups: list[list[str]] = []
        for label, line in lines.items():
            group = next((g for g in groups if all(_one_line(line, lines[other], scale) for other in g)), None)
            groups.append([label]) if group is None else group.append(label)
        told = [data.listed(group) for group in groups if len(group) > 1]
        return [f"On one line: {'; '.join(told)}."] if told else []

    @property
    def log_x(self) -> bool:
        return "x" in log_axes(self.options) and self.numeric and min(self.places.values(), default=0) > 0

    def draw(self, axes: Axes, points: Sequence[Point]) -> None:
        for label in labels_of(points):
            members = [p for p in points if p.label == label and p.status == "ok" and p.shown(self.y)[1] is not None]
            if members:
                self._line(axes, label, members, sorted({self.places[p.at(self.x)] for p in points
                                                         if p.at(self.x) is not None}))
        if self.options.get("floor") and self.y == "time_ms":
            self._floor(axes, points)
        if self.options.get("bound"):
            self._bound(axes, points)
        self._over(axes, points)
        draw_marks(axes, ((self.places[p.at(self.x)], mark) for mark in self.marks for p in points
                          if p is mark.point and p.at(self.x) is not None))
        draw_guides(axes, self.guides)
        draw_fit(axes, self._fits(points), self.log_x)

    def _fits(self, points: Sequence[Point]) -> list[Fit]:
        return fits_of(points, self.x, self.y, str(self.options.get("fit"))) if self.options.get("fit") else []

    def _over(self, axes: Axes, points: Sequence[Point]) -> None:
        """Draw cells for which there is no memory as crosses above the x axis, in the colour of their method."""
        risen: dict[float, int] = {}
        for p in points:
            if p.ending.over_memory and p.at(self.x) is not None:
                x = self.places[p.at(self.x)]
                risen[x] = risen.get(x, 0) + 1
                axes.plot([x], [0.035 * risen[x] - 0.01], transform=axes.get_xaxis_transform(), label=p.sign,
                          color=self.colour(p), **style.OVER)

    def _line(self, axes: Axes, label: str, members: Sequence[Point], places: Sequence[float]) -> None:
        """Draw one series, broken where a value is missing; level and unmarked where x does not affect the method."""
        found = {self.places[p.at(self.x)]: p.shown(self.y) for p in members if p.at(self.x) is not None}
        level = not found
        if level:
            found = dict.fromkeys(self.places.values() or [0.0], members[0].shown(self.y))
        xs = [v for v in places if min(found) <= v <= max(found)] or list(found)
        intervals = [found.get(v, (None, math.nan, None)) for v in xs]
        lows = [0.0 if low is None else middle - low for low, middle, _ in intervals]
        highs = [0.0 if high is None else high - middle for _, middle, high in intervals]
        i = self.labels.index(label)
        axes.errorbar(xs, [middle for _, middle, _ in intervals], (lows, highs), label=label,
                      color=self.colour(members[0]), linestyle=style.LINES[i % len(style.LINES)],
                      marker="" if level else style.MARKERS[i % len(style.MARKERS)], **self._marker(members[0]),
                      elinewidth=0.8, capsize=1.8, capthick=0.8)

    def _marker(self, point: Point) -> dict[str, Any]:
        """A marker is full with a white edge, and hollow for every second variant of a method."""
        if self.variant(point) % 2:
            return {"markerfacecolor": "white", "markeredgecolor": self.colour(point), "markeredgewidth": 1.0}
        return {"markeredgecolor": "white", "markeredgewidth": 0.4}

    def _floor(self, axes: Axes, points: Sequence[Point]) -> None:
        found = {self.places[p.at(self.x)]: p.floor["values"]["time_ms"] for p in points
                 if p.floor and p.at(self.x) is not None}
        xs = sorted(found)
        if xs:
            axes.plot(xs, [found[v] for v in xs], color=style.INK, linewidth=0.9, linestyle="--", label="floor")

    def _bound(self, axes: Axes, points: Sequence[Point]) -> None:
        """Draw the errors that rounding explains: the least and the most where exact methods round differently."""
        found: dict[float, list[float]] = {}
        for p in points:
            if p.row["error_bound"] is not None and p.at(self.x) is not None:
                found.setdefault(self.places[p.at(self.x)], []).append(p.row["error_bound"])
        xs = sorted(found)
        for pick in (min, max) if xs else ():
            axes.plot(xs, [pick(found[v]) for v in xs], color=style.ALARM, linewidth=0.9, linestyle=":", label="bound")

    def finish(self, axes: Axes, width: float, leftmost: bool, lowest: bool) -> None:
        """Set scales, ticks and labels, which the panels share, once every panel is drawn."""
        if "y" in log_axes(self.options):
            log_axis(axes, "y", log_base(self.options))
        elif not self.options.get("gain_of"):
            axes.set_ylim(bottom=0)
        else:
            axes.axhline(0, color=style.QUIET, linewidth=0.8, zorder=1)
        if axes.texts and self.options.get("fit"):
            room_for(axes, len(axes.texts))
        if self.log_x:
            log_axis(axes, "x", log_base(self.options))
        low, high = self._x_limits()
        axes.set_xlim(low, high)
        axes.grid(which="major")
        if len(self.places) <= MOST_TICKS or not self.numeric:
            axes.set_xticks(*self._ticks(width))
        axes.tick_params(labelbottom=lowest, labelleft=leftmost)
        if lowest:
            axes.set_xlabel(str(self.options.get("x_label") or axis_label(self.x)))
        if leftmost:
            y_label(axes, y_text(self.options))

    def _x_limits(self) -> tuple[float, float]:
        first, last = min(self.places.values(), default=1.0), max(self.places.values(), default=1.0)
        if self.log_x:
            pad = (last / first) ** 0.05 if last > first else 2.0
            return first / pad, last * pad
        pad = 0.05 * (last - first) or 1.0
        return first - pad, last + pad

    def _ticks(self, width: float) -> tuple[list[float], list[str]]:
        """Places and labels of the values of x, apart from those next to another.

        A label that would run into its left neighbour is left blank.
        """
        scale = math.log if self.log_x else float
        low, high = map(scale, self._x_limits())
        places, labels, last, free = [], [], -math.inf, -math.inf
        for value, place in self.places.items():
            text = tick(value)
            middle, half = (scale(place) - low) / (high - low) * width, text_width(text, 7.5) / 2
            if middle - last < TICK_GAP_IN:
                continue
            last, fits = middle, middle - half > free
            places.append(place)
            labels.append(text if fits else "")
            free = middle + half + 0.04 if fits else free
        return places, labels

    def handles(self, grid: Iterable[Axes]) -> dict[str, Any]:
        """Legend entries from the highest line's right end to the lowest, as the eye meets them; the floor last."""
        found: dict[str, Any] = {}
        for axes in grid:
            for handle, label in zip(*axes.get_legend_handles_labels(), strict=True):
                found.setdefault(label, handle.lines[0] if hasattr(handle, "lines") else handle)
        ends = {}
        for p in sorted(self.points, key=lambda p: self.places.get(p.at(self.x), 0.0)):
            if p.label in found and p.status == "ok" and p.shown(self.y)[1] is not None:
                ends[p.label] = p.shown(self.y)[1]
        ordered = [*sorted(ends, key=lambda label: -ends[label]), *(label for label in found if label not in ends)]
        return {label: found[label] for label in ordered}


def _broken(label: str) -> list[str]:
    """A legend entry in lines; short parts between commas stay whole."""
    parts = (part.replace(" ", HARD_SPACE) if len(part) <= SHORT_PART else part for part in label.split(", "))
    return [line.replace(HARD_SPACE, " ") for line in textwrap.wrap(", ".join(parts), LONG_LABEL + 4)]


def _one_line(line: Mapping[Any, float], other: Mapping[Any, float], scale: float) -> bool:
    """Whether two lines that share at least two places cannot be told apart at any of them."""
    shared = line.keys() & other.keys()
    return len(shared) > 1 and all(math.isclose(line[at], other[at], rel_tol=SEEN_APART, abs_tol=SEEN_APART * scale)
                                   for at in shared)
