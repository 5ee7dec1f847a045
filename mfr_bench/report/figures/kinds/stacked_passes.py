"""Bars grouped by x, one per method, stacked by pass; kplus_2015 Fig. 6, gpupro5 Fig. 1.3."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from ....store.columns import PASS_COLUMNS, names
from ... import style
from ...data import Point, Result
from ..bar_chart import Chart, Segment, bar_figure
from ..kind import FLOOR, LOG, LOG_BASE, PANELS, PRINTED, Y_LABEL, Kind
from ..series import Options, is_drawn, series_of

if TYPE_CHECKING:
    from matplotlib.figure import Figure

WHOLE = "whole frame"
KIND = Kind("bars grouped by x, one per method, stacked by pass; kplus_2015 Fig. 6, gpupro5 Fig. 1.3",
            keys=(LOG, LOG_BASE, Y_LABEL, PANELS, FLOOR, PRINTED), y=names(PASS_COLUMNS, "measure"))


def draw(result: Result, options: Options) -> Figure:
    """Bars grouped by x, one per method, stacked by pass; kplus_2015 Fig. 6, gpupro5 Fig. 1.3."""
    points = series_of(result, options)
    colours = style.pass_colours({name: None for p in points if is_drawn(p, "time_ms") for name in p.passes_ms})
    share = options["y"] == "share"
    chart = Chart(result, {**options, "y": "share" if share else "time_ms"}, tuple(points),
                  lambda p: _pass_segments(p, colours, share), colours, coloured=False)
    return bar_figure(chart, [] if share else _notes(points))


def _pass_segments(point: Point, colours: Mapping[str, str], share: bool) -> list[Segment]:
    """The passes from the first up, as shares of the whole frame: their own frames were drawn at other times."""
    whole = 1.0 if share else point.row["time_ms"]
    timed = [Segment(name, whole * interval[1] / _sum_ms(point), colours[name])
             for name, interval in point.passes_ms.items()]
    return timed or [Segment(WHOLE, point.row["time_ms"], style.WHOLE_FRAME)]


def _sum_ms(point: Point) -> float:
    return sum(interval[1] for interval in point.passes_ms.values())


def _notes(points: Sequence[Point]) -> list[str]:
    """How a bar is divided, and how far the sum of its passes is from it."""
    sums = sorted(_sum_ms(p) / p.row["time_ms"] for p in points if is_drawn(p, "time_ms") and p.passes_ms)
    ends = " to ".join(dict.fromkeys(f"{end:.2f}" for end in sums[:1] + sums[-1:]))
    said = ("Bar and number: the whole frame's median (ms) with its 95 % interval, divided as the passes' medians are, "
            f"which were timed in frames of their own and add up to {ends} times the whole frame.")
    return [said] * bool(sums)
