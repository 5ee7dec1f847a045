"""Maps: an array that each cell kept, as pixels; kplus_2015 Fig. 10, occupancy_2015 Figs. 1 and 5."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

from ....store.columns import ARRAYS
from ... import data, style
from ...checkerboard import over_checkerboard
from ...data import Point, Result, number
from ..bar_chart import UNMEASURED
from ..kind import Kind, NothingToDraw
from ..series import Options, labels_of, refusals, series_of
from ..sheet import EDGE, fitted, sheet_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

MOST_COLUMNS = 5
GAP, HEADING, LINE, BAR = 0.1, 0.3, 0.12, 0.62  # inches; HEADING: room for two lines
HEADING_PT = 7.0
LEAST_SEEN = 1 / 255
CHECKS, CHECKER_GREYS = 16, (0.85, 1.0)  # squares of the checkerboard along the longer side
MEANINGS = {"error": "largest channel error against the promised image", "loss": "largest channel error against the "
            "image of all fragments", "fragments": "fragments per pixel", "discarded": "fragments refused per pixel",
            "image": ""}

KIND = Kind("the array y that each cell keeps, as pixels; kplus_2015 Fig. 10, occupancy_2015 Figs. 1 and 5",
            y=tuple(ARRAYS), arrays=True)


def draw(result: Result, options: Options) -> Figure:
    """A panel for each cell: rows by label and columns by x where x varies, else the labels in rows."""
    chart = Maps(result, options, tuple(p for p in series_of(result, options) if not data.is_floor(p)))
    if not chart.kept:
        raise NothingToDraw(f"no cell keeps the array {chart.name}")
    rows = chart.rows()
    columns = max(map(len, rows))
    bar = BAR if chart.scaled else 0.0
    room = style.WIDTH_IN - 2 * EDGE - bar - GAP * (columns - 1)
    width = min(2.2, room / columns)
    height = width * chart.aspect
    lines = max((len(chart.heading(point, width)) for point in chart.points), default=0)
    heading = HEADING + LINE * max(0, lines - 2)
    sheet = sheet_of(result, options, chart.points, chart.notes(), style.WIDTH_IN,
                     len(rows) * (height + heading + 0.06))
    figure = sheet.figure()
    drawn = None
    for i, row in enumerate(rows):
        for j, point in enumerate(row):
            axes = sheet.axes(figure, EDGE + j * (width + GAP), i * (height + heading + 0.06) + heading, width, height)
            drawn = chart.draw(axes, point, width) or drawn
    if drawn is not None and chart.scaled:
        left = EDGE + columns * (width + GAP)
        bar_axes = sheet.axes(figure, left, heading, 0.11, height)
        figure.colorbar(drawn, cax=bar_axes)
        bar_axes.tick_params(labelsize=style.SMALL_PT)
    return figure


@dataclass(frozen=True)
class Maps:
    """The content of a figure of maps; every panel has the same scale of colours."""

    result: Result
    options: Options
    points: tuple[Point, ...]

    @property
    def name(self) -> str:
        return self.options["y"]

    @property
    def scaled(self) -> bool:
        return self.name != "image"

    @cached_property
    def kept(self) -> dict[str, Any]:
        """The arrays that there are, by the key of the cell."""
        found = {p.cell["key"]: p.arrays.get(self.name) for p in self.points}
        return {key: array for key, array in found.items() if array is not None}

    @property
    def aspect(self) -> float:
        height, width = next(iter(self.kept.values())).shape[:2]
        return min(2.0, max(0.2, height / width))

    @cached_property
    def highest(self) -> float:
        """The end of the scale; for errors at least one step of 8 bits, the least that a display shows."""
        most = max((float(array.max()) for array in self.kept.values()), default=0.0) or 1.0
        return max(most, LEAST_SEEN) if self.name in ("error", "loss") else most

    def rows(self) -> list[list[Point]]:
        x, labels = self.options["x"], labels_of(self.points)
        if len(data.values(self.points, x)) > 1:
            return [[p for p in self.points if p.label == label] for label in labels]
        columns = min(MOST_COLUMNS, math.ceil(len(self.points) / math.ceil(len(self.points) / MOST_COLUMNS)) or 1)
        return [list(self.points[i:i + columns]) for i in range(0, len(self.points), columns)]

    def draw(self, axes: Axes, point: Point, width: float) -> Any:
        """A panel; what it was drawn with, for the scale, or None where the cell kept no array."""
        axes.set_xticks([])
        axes.set_yticks([])
        for side in axes.spines.values():
            side.set_visible(True)
        axes.set_title("\n".join(self.heading(point, width)), loc="left", fontsize=HEADING_PT, pad=2.5,
                       linespacing=1.15)
        array = self.kept.get(point.cell["key"])
        if array is None:
            sign = point.sign if point.status != "ok" else f"{self.name} {UNMEASURED}"
            axes.text(0.5, 0.5, sign, transform=axes.transAxes, ha="center", va="center", color=style.QUIET,
                      style="italic", fontsize=style.SMALL_PT)
            return None
        if not self.scaled:
            axes.imshow(over_checks(array), origin="lower", interpolation="nearest", aspect="auto")
            return None
        return axes.imshow(array.astype("float32"), origin="lower", interpolation="nearest", aspect="auto",
                           cmap=style.MAP_COLOURS, vmin=0.0, vmax=self.highest)

    def heading(self, point: Point, width: float) -> list[str]:
        """The lines over a panel that is so many inches wide."""
        return fitted(self._heading(point), HEADING_PT, width + 2 * EDGE)

    def _heading(self, point: Point) -> str:
        x = self.options["x"]
        where = data.heading(x, point.at(x)) if len(data.values(self.points, x)) > 1 else ""
        return ", ".join(part for part in (point.label, where, self._told(point)) if part)

    def _told(self, point: Point) -> str:
        """The mean of the map, or the share of the fragments that it counts."""
        array = self.kept.get(point.cell["key"])
        if array is None or not self.scaled:
            return ""
        if self.name == "discarded" and point.row["fragments"]:
            return f"{100 * float(array.sum(dtype='int64')) / point.row['fragments']:.1f} %"
        return f"mean {number(float(array.mean(dtype='float64')))}"

    def notes(self) -> list[str]:
        meaning = MEANINGS.get(self.name, "")
        if not meaning:
            return refusals(self.points)
        found = [f"Colour: {meaning}; one scale for all panels, from 0 to {number(self.highest)}."]
        most = max((float(array.max()) for array in self.kept.values()), default=0.0)
        if self.name in ("error", "loss") and most < LEAST_SEEN:
            found.append(f"The largest error of all panels is {number(most, 2)}, less than one step of 8 bits "
                         f"({LEAST_SEEN:.2g}): the panels are black because the images are right.")
        return [*found, *refusals(self.points)]


def over_checks(image: Any) -> Any:
    """Premultiplied RGBA (H, W, 4) uint8 over a checkerboard: float RGB."""
    return over_checkerboard(image.astype("float64") / 255, max(1, max(image.shape[:2]) // CHECKS), CHECKER_GREYS)
