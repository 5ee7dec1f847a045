"""Method against level of a stressor: what becomes of each cell, the first that breaks framed."""

from __future__ import annotations

import textwrap
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

from ... import breaking as found_by
from ... import data, style
from ...breaking import FAULTS, HOLDS, Ladder, state
from ...data import Result
from ..kind import PANELS, X_LABEL, Kind, NothingToDraw
from ..series import Options, axis_label, labels_of, series_of
from ..sheet import EDGE, HEADING_IN, sheet_of, text_width, widest

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

ROW_IN, LEGEND_IN, TICKS_IN, GAP_IN = 0.125, 0.34, 0.42, 0.1
LABEL_PT, SIGN_PT = 6.4, 5.4
LONGEST = 34  # characters of a label
TURNED_IN = 0.2  # that the foot has room for below the ticks

KIND = Kind("where along x, from mild to harsh in the order of the sweep, each method breaks", keys=(PANELS, X_LABEL))


def draw(result: Result, options: Options) -> Figure:
    """A row per method, a column per level from mild to harsh, a panel per value of `panels`."""
    axis, panels = str(options["x"]), options.get("panels")
    points = series_of(result, options)
    ladders = found_by.ladders(result, points, axis, panels)
    if not ladders:
        raise NothingToDraw("no cell was measured")
    labels = [label for label in labels_of(points) if any(ladder.label == label for ladder in ladders)]
    groups: dict[Any, list[Ladder]] = {}
    for ladder in ladders:
        groups.setdefault(ladder.panel, []).append(ladder)
    shown = {label: textwrap.shorten(label, LONGEST, placeholder="…") for label in labels}
    height = ROW_IN * max(1, len(labels))
    left = widest(shown.values(), LABEL_PT) + 2 * EDGE
    room = style.WIDTH_IN - left - EDGE - GAP_IN * (len(groups) - 1)
    order = found_by.levels(result, axis)
    columns = {panel: [v for v in order if any(v in ladder.points for ladder in members)]
               for panel, members in groups.items()}
    total = sum(map(len, columns.values())) or 1
    longest = widest(map(data.plain, order), SIGN_PT)
    foot = TICKS_IN + (longest if longest > TURNED_IN and _turned(order, room / total) else 0)
    sheet = sheet_of(result, options, points, (), style.WIDTH_IN, LEGEND_IN + HEADING_IN + height + foot)
    figure = sheet.figure()
    for i, (panel, members) in enumerate(groups.items()):
        width = room * len(columns[panel]) / total
        axes = sheet.axes(figure, left, LEGEND_IN + HEADING_IN, width, height)
        left += width + GAP_IN
        _draw(axes, members, labels, columns[panel], width)
        axes.set_title(data.heading(panels, panel) if panels else "", loc="left")
        axes.set_yticks(range(len(labels)), shown.values() if i == 0 else [""] * len(labels), fontsize=LABEL_PT)
        axes.set_xlabel(str(options.get("x_label") or axis_label(axis)))
    figure.legend(*_legend(ladders), loc="upper left", ncols=4, fontsize=SIGN_PT + 1, columnspacing=1.2,
                  handlelength=1.2, bbox_to_anchor=(EDGE / sheet.width, sheet.y(0)), borderaxespad=0, borderpad=0)
    return figure


def _draw(axes: Axes, ladders: list[Ladder], labels: list[str], columns: list[Any], width: float) -> None:
    from matplotlib.patches import Rectangle

    step = width / max(1, len(columns))
    for ladder in ladders:
        y, first = labels.index(ladder.label), ladder.first
        for level, point in ladder.points.items():
            x, found = columns.index(level), state(point)
            fill, ink = style.STATE_COLOURS[found]
            edge = style.INK if first and first[0] == level else "white"
            axes.add_patch(Rectangle((x - 0.5, y - 0.5), 1, 1, facecolor=fill, edgecolor=edge,
                                     linewidth=0.9 if edge == style.INK else 0.4, zorder=2 if edge == style.INK else 1))
            sign = _sign(point, step)
            if sign:
                axes.text(x, y, sign, ha="center", va="center", fontsize=SIGN_PT, color=ink, zorder=3)
    axes.set_xlim(-0.5, len(columns) - 0.5)
    axes.set_ylim(len(labels) - 0.5, -0.5)
    names = [data.plain(v) for v in columns]
    axes.set_xticks(range(len(columns)), names, fontsize=SIGN_PT, rotation=90 if _turned(columns, step) else 0)
    axes.tick_params(length=0)
    for side in axes.spines.values():
        side.set_visible(False)


def _turned(levels: Iterable[Any], step: float) -> bool:
    """Whether the names of the levels stand upright, since one of them is wider than a column."""
    return widest(map(data.plain, levels), SIGN_PT) + 0.03 > step


def _sign(point: data.Point, room: float) -> str:
    """The error where one was measured and fits, for a reader to compare."""
    error = point.row["max_abs_error"]
    text = "" if error is None else "0" if error == 0 else f"{error:.0e}".replace("e-0", "e-")
    return text if text_width(text, SIGN_PT) + 0.02 <= room else ""


def _legend(ladders: list[Ladder]) -> tuple[list[Any], list[str]]:
    from matplotlib.patches import Patch

    met = {state(p) for ladder in ladders for p in ladder.points.values()}
    names = [HOLDS, *(name for name in FAULTS if name != HOLDS)]
    patches = [(Patch(facecolor=style.STATE_COLOURS[name][0]), name) for name in names if name in met]
    framed = Patch(facecolor="white", edgecolor=style.INK, linewidth=0.9)
    return [patch for patch, _ in patches] + [framed], [name for _, name in patches] + ["first level that breaks"]
