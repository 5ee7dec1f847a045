"""Bars of one measure grouped by x, one per method, coloured by method; kplus_2015 Figs. 7 and 8."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ... import style
from ...data import Point, Result
from ..bar_chart import Chart, Segment, bar_figure
from ..kind import FLOOR, GAIN_OF, LOG, LOG_BASE, PANELS, PASSES, PRINTED, SORTED, Y_LABEL, Kind
from ..series import Options, series_of

if TYPE_CHECKING:
    from matplotlib.figure import Figure

KIND = Kind("bars of one measure grouped by x, one per method; kplus_2015 Figs. 7 and 8",
            keys=(LOG, LOG_BASE, Y_LABEL, PANELS, FLOOR, PASSES, GAIN_OF, PRINTED, SORTED))


def draw(result: Result, options: Options) -> Figure:
    """Bars of one measure grouped by x, one per method, coloured by method; kplus_2015 Figs. 7 and 8."""
    def segments(point: Point) -> list[Segment]:
        return [Segment("", point.shown(options["y"])[1], style.method_colour(point.method))]

    return bar_figure(Chart(result, options, tuple(series_of(result, options)), segments, {}, coloured=True), [])
