"""A value of one method in every scene as a coloured table: its time over the best other method's, or any measure."""

from __future__ import annotations

import json
import math
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

from ... import data, style
from ...data import Point, Result, number
from ..kind import Key, Kind, NothingToDraw
from ..series import Options, axis_label, chosen, of_methods
from ..sheet import EDGE, fitted, sheet_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

BEST = "best_ratio"  # time over that of the fastest other method whose image is right
COLUMNS = 3  # panels side by side
ROW_IN, HEADING_IN, FOOT_IN, LEFT_IN, GAP_IN = 0.19, 0.36, 0.36, 0.52, 0.12
EVEN = 0.1  # ratios within it of 1 are neither faster nor slower

KIND = Kind("a table of y, `rows` down and x across, with a panel for each value of all other axes; y may be "
            "best_ratio, the time over that of the fastest other method",
            keys=(Key("rows", "a row for each of its values", names="column"),), other_y=(BEST,), needs=("rows",))


def draw(result: Result, options: Options) -> Figure:
    """A panel for each value of all other axes: `rows` down, x across, the value of y in each field."""
    chart = Heat(result, options)
    if not chart.values:
        raise NothingToDraw(f"no cell along {options['x']} and {options['rows']} has a value to compare")
    columns = min(COLUMNS, max(1, len(chart.panels)))
    width = (style.WIDTH_IN - 2 * EDGE) / columns
    heading_in = HEADING_IN if any(heading for heading, _ in chart.panels) else 0.06
    height = heading_in + ROW_IN * max(1, len(chart.rows)) + FOOT_IN
    lines = math.ceil(len(chart.panels) / columns)
    sheet = sheet_of(result, options, chart.points, chart.notes(), style.WIDTH_IN, max(1, lines) * height)
    figure = sheet.figure()
    for i, (heading, points) in enumerate(chart.panels):
        left = EDGE + (i % columns) * width + LEFT_IN
        top = (i // columns) * height + heading_in
        axes = sheet.axes(figure, left, top, width - LEFT_IN - GAP_IN, height - heading_in - FOOT_IN)
        chart.draw(axes, heading, points, first=i % columns == 0)
    return figure


@dataclass(frozen=True)
class Heat:
    """The content of the figure: the points of the methods picked, or of the first of the config."""

    result: Result
    options: Options

    @cached_property
    def points(self) -> list[Point]:
        placed = [p for p in chosen(self.result, self.options)
                  if not data.is_floor(p) and None not in (p.at(self.options["x"]), p.at(self.options["rows"]))]
        return placed if self.options.get("methods") else [p for p in placed if of_methods(p, (placed[0].label,))]

    @cached_property
    def rivals(self) -> dict[str, list[Point]]:
        """Points with a time and the right image that are not drawn themselves, by scene."""
        drawn = {p.method for p in self.points}
        found: dict[str, list[Point]] = {}
        for p in self.result.points:
            if p.method not in drawn and not data.is_floor(p) and p.status == "ok" and p.row["time_ms"]:
                found.setdefault(_scene(p), []).append(p)
        return found

    def best(self, point: Point) -> Point | None:
        return min(self.rivals.get(_scene(point), []), key=lambda p: p.row["time_ms"], default=None)

    def value(self, point: Point) -> float | None:
        if point.status != "ok":
            return None
        if self.options["y"] != BEST:
            return point.measure(self.options["y"])[1]
        best = self.best(point)
        return data.time_ratio(point.cell, best.cell)[1] if best else None

    @cached_property
    def values(self) -> dict[str, float]:
        found = {p.cell["key"]: self.value(p) for p in self.points}
        return {key: value for key, value in found.items() if value}

    @cached_property
    def rows(self) -> list[Any]:
        return data.values(self.points, self.options["rows"])[::-1]

    @cached_property
    def panels(self) -> list[tuple[str, list[Point]]]:
        """Points by heading, which names what sets a panel apart from most of the panels."""
        placed = [data.bare(self.options[name]) for name in ("x", "rows")]
        axes = [a for a in self.result.axes if data.bare(a) not in placed and len(data.values(self.points, a)) > 1]
        usual = {a: Counter(p.at(a) for p in self.points).most_common(1)[0][0] for a in axes}
        found: dict[str, list[Point]] = {}
        for p in self.points:
            named = [a for a in axes if p.at(a) != usual[a]] or axes
            found.setdefault(", ".join(data.heading(a, p.at(a), " ") for a in named), []).append(p)
        return list(found.items())

    @property
    def spread(self) -> float:
        """The ratio to 1, or the largest value, that has the strongest colour."""
        logs = [abs(math.log(v)) for v in self.values.values()]
        return max([*logs, math.log(2)]) if self.options["y"] == BEST else max([*self.values.values(), 1.0])

    def draw(self, axes: Axes, heading: str, points: Sequence[Point], first: bool) -> None:
        x, rows = self.options["x"], self.options["rows"]
        columns = data.values(self.points, x)
        axes.set_xlim(-0.5, max(1, len(columns)) - 0.5)
        axes.set_ylim(-0.5, max(1, len(self.rows)) - 0.5)
        for p in points:
            self._field(axes, columns.index(p.at(x)), len(self.rows) - 1 - self.rows.index(p.at(rows)), p)
        axes.set_xticks(range(len(columns)), [data.plain(v) for v in columns], fontsize=style.SMALL_PT)
        names = [data.plain(v) for v in self.rows[::-1]]
        axes.set_yticks(range(len(names)), names, fontsize=style.SMALL_PT)
        axes.tick_params(length=0)
        axes.set_xlabel(axis_label(x), fontsize=style.SMALL_PT, labelpad=1.5)
        if first:
            axes.set_ylabel(data.short(rows), fontsize=style.SMALL_PT, labelpad=2)
        lines = fitted(heading, 7.0, axes.get_position().width * style.WIDTH_IN + 2 * EDGE)
        axes.set_title("\n".join(lines), loc="left", fontsize=7.0, pad=3, linespacing=1.1)
        for side in axes.spines.values():
            side.set_visible(False)

    def _field(self, axes: Axes, column: int, row: int, point: Point) -> None:
        from matplotlib.patches import Rectangle

        value = self.values.get(point.cell["key"])
        shade, ink = self._colours(value)
        axes.add_patch(Rectangle((column - 0.48, row - 0.46), 0.96, 0.92, color=shade, linewidth=0))
        sign = point.sign.replace(" ", "\n") if point.status != "ok" else "none"
        axes.text(column, row, number(value, 2 if value < 1 else 3) if value else sign, ha="center", va="center",
                  color=ink, linespacing=0.9, fontsize=style.NUMBER_PT if value else style.NUMBER_PT - 1.6)

    def _colours(self, value: float | None) -> tuple[Any, str]:
        """The field's colour, and the ink that can be read on it."""
        import matplotlib as mpl

        if not value:
            return style.BAND, style.QUIET
        if self.options["y"] == BEST:
            place = 0.5 - 0.5 * math.log(value) / self.spread
            return mpl.colormaps["RdBu"](place), "white" if abs(place - 0.5) > 0.36 else style.INK
        place = math.log(max(value, 1.0)) / math.log(max(self.spread, 1.01))
        return mpl.colormaps["YlOrBr"](0.05 + 0.75 * place), "white" if place > 0.8 else style.INK

    def notes(self) -> list[str]:
        shown = list(self.values.values())
        if self.options["y"] != BEST:
            text = (f"{data.MEASURES[self.options['y']]}: from {number(min(shown))} to {number(max(shown))}, median "
                    f"{number(sorted(shown)[len(shown) // 2])}, over {len(shown)} scenes.")
            return [text]
        faster, slower = sum(v < 1 for v in shown), sum(v > 1 + EVEN for v in shown)
        text = (f"Time over that of the fastest other method: below 1 in {faster} of {len(shown)} scenes "
                f"({100 * faster / len(shown):.0f} %), above {1 + EVEN:g} in {slower}; from {number(min(shown))} to "
                f"{number(max(shown))}. Blue is faster.")
        return [text, *self._who()]

    def _who(self) -> list[str]:
        """The number of times that each other method is the fastest of them."""
        best: dict[str, int] = {}
        for p in self.points:
            if p.cell["key"] in self.values and (rival := self.best(p)):
                best[rival.label] = best.get(rival.label, 0) + 1
        counted = sorted(best.items(), key=lambda item: -item[1])
        return [f"The fastest of the others: {', '.join(f'{label} ({count})' for label, count in counted)}."]


def _scene(point: Point) -> str:
    return json.dumps([point.cell["scene"], point.row["device"]], sort_keys=True)
