"""Bars of one measure grouped by x, one per method, coloured by method; kplus_2015 Figs. 7 and 8."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from ... import style
from ...data import Point, Result
from ..bar_chart import Chart, Segment, bar_figure
from ..kind import FLOOR, GAIN_OF, LOG, LOG_BASE, PANELS, PASSES, PRINTED, Y_LABEL, Kind
from ..series import Options, series_of

if TYPE_CHECKING:
    from matplotlib.figure import Figure

KIND = Kind("bars of one measure grouped by x, one per method; kplus_2015 Figs. 7 and 8",
            keys=(LOG, LOG_BASE, Y_LABEL, PANELS, FLOOR, PASSES, GAIN_OF, PRINTED))


def draw(result: Result, options: Options) -> Figure:
    """Bars of one measure grouped by x, one per method, coloured by method; kplus_2015 Figs. 7 and 8."""
    def segments(point: Point) -> list[Segment]:
        return [Segment("", point.shown(options["y"])[1], style.method_colour(point.method))]

    points = tuple(series_of(result, options))
    return bar_figure(Chart(result, options, points, segments, _variant_hatches(points), {}), [])


def _variant_hatches(points: Iterable[Point]) -> dict[str, str]:
    """Hatching by label: none for the first of a method, so that variants of one colour can be told apart."""
    variants: dict[str, dict[str, None]] = {}
    for p in points:
        variants.setdefault(p.method, {})[p.label] = None
    return {label: style.HATCHES[i % len(style.HATCHES)] for labels in variants.values()
            for i, label in enumerate(labels)}
