"""Pixels by their number of fragments, with the k that was chosen from them; kplus_2015 Figs. 3 and 4."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from ... import data, style
from ...data import Point, Result
from ..kind import LOG, LOG_BASE, X_LABEL, Y_LABEL, Kind, NothingToDraw
from ..scales import log_axes, log_axis, log_base, y_label
from ..series import Options, series_of
from ..sheet import EDGE, HEADING_IN, LEFT, sheet_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

COLUMNS = 4
LABEL_STEP = 0.085  # of the height of a plot, above the highest bar: the line of one k
SYMBOLS = {"memory_mb": "M_b: memory budget (MiB)", "hit_ratio": "R_h: hit ratio that k is chosen for"}
PLOT_HEIGHT, GAP, BELOW = 1.75, 0.16, 0.36  # inches

KIND = Kind("pixels by their number of fragments, with the k that was chosen from them; kplus_2015 Figs. 3 and 4",
            keys=(LOG, LOG_BASE, X_LABEL, Y_LABEL), y=("time_ms",))


@dataclass(frozen=True)
class Panel:
    """One scene's histogram: pixels[i] have i fragments. `chosen`: k, with the words that tell its cell apart."""

    heading: str
    pixels: tuple[int, ...]
    chosen: tuple[tuple[str, int], ...]


def draw(result: Result, options: Options) -> Figure:
    """A panel for each scene that the figure's cells share, and for each frame of an animation."""
    points = [p for p in series_of(result, options) if p.ending.timed]
    panels = _panels(result, points, options["x"])
    if not panels:
        raise NothingToDraw(" ".join(["only moving scenes and methods that choose k have histograms.",
                                      *_notes(result, points)]).rstrip("."))
    columns = min(COLUMNS, len(panels))
    rows = math.ceil(len(panels) / columns)
    step = HEADING_IN + PLOT_HEIGHT + BELOW
    sheet = sheet_of(result, options, points, _notes(result, points), style.WIDTH_IN, rows * step + 0.06)
    figure = sheet.figure()
    width = (style.WIDTH_IN - LEFT - EDGE - GAP * (columns - 1)) / columns
    grid: list[Axes] = []
    for i, panel in enumerate(panels):
        shared = {"sharex": grid[0], "sharey": grid[0]} if grid else {}
        left, top = LEFT + i % columns * (width + GAP), i // columns * step + HEADING_IN
        axes = sheet.axes(figure, left, top, width, PLOT_HEIGHT, **shared)
        grid.append(axes)
        _draw(axes, panel)
    room = LABEL_STEP * max((len({k for _, k in panel.chosen}) for panel in panels), default=0)
    for i, axes in enumerate(grid):
        _finish(axes, options, room, leftmost=i % columns == 0, lowest=i + columns >= len(grid))
    return figure


def _panels(result: Result, points: Sequence[Point], x: str) -> list[Panel]:
    """Panels by scene and by frame; x tells scenes apart where it is a key of the scene."""
    found: dict[tuple, list[tuple[str, int]]] = {}
    several = len(data.values(points, x)) > 1
    for point in points:
        where = data.heading(x, point.at(x)) if several and data.bare(x) in point.cell["scene"] else ""
        for frame, pixels, k in _frames(point):
            chosen = found.setdefault((", ".join(part for part in (where, frame) if part), pixels), [])
            if k is not None:
                chosen.append((_told(result, point), k))
    return [Panel(heading, pixels, tuple(chosen)) for (heading, pixels), chosen in found.items()]


def _frames(point: Point) -> list[tuple[str, tuple[int, ...], int | None]]:
    """Heading, histogram and chosen k: of each frame of an animation, else of the scene."""
    frames = [f for f in point.cell.get("frames") or [] if isinstance(f, dict) and _counts(f.get("histogram"))]
    return [(f"frame {f.get('frame', i)}" if len(frames) > 1 else "", tuple(f["histogram"]), f.get("chosen_k"))
            for i, f in enumerate(frames)]


def _counts(histogram: object) -> bool:
    return isinstance(histogram, list) and bool(histogram) and all(isinstance(v, int) and v >= 0 for v in histogram)


def _told(result: Result, point: Point) -> str:
    """The parameters that were swept: 'M_b 50, R_h 0.9'."""
    names = [n for n in result.axes if n in point.cell["params"]]
    return ", ".join(data.heading(n, point.at(n), " ") for n in names)


def _draw(axes: Axes, panel: Panel) -> None:
    edges = [depth - 0.5 for depth in range(1, len(panel.pixels) + 1)]
    axes.stairs(panel.pixels[1:], edges, fill=True, color=style.HISTOGRAM, linewidth=0, zorder=2)
    axes.set_title(panel.heading, loc="left")
    by_k: dict[int, list[str]] = {}
    for words, k in panel.chosen:
        by_k.setdefault(k, []).append(words)
    for place, (k, words) in enumerate(sorted(by_k.items())):
        axes.axvline(k, color=style.ALARM, linewidth=0.9, zorder=3)
        left = k > 0.6 * len(panel.pixels)
        axes.annotate(_words(k, words), (k, 0.99 - LABEL_STEP * place), (-2.5 if left else 2.5, 0), va="top",
                      ha="right" if left else "left", xycoords=axes.get_xaxis_transform(),
                      textcoords="offset points", fontsize=style.NUMBER_PT,
                      color=style.INK, zorder=5, annotation_clip=False,
                      bbox={"boxstyle": "square,pad=0.1", "facecolor": "white", "edgecolor": "none", "alpha": 0.75})


def _words(k: int, notes: Sequence[str]) -> str:
    notes = [words for words in notes if words]
    return f"k = {k}" + (f" by {'; '.join(notes)}" if notes else "")


def _finish(axes: Axes, options: Options, room: float, leftmost: bool, lowest: bool) -> None:
    if "y" in log_axes(options):
        axes.set_ylim(bottom=0.7)
        high = max(axis.dataLim.intervaly[1] for axis in axes.figure.axes)
        axes.set_ylim(top=0.7 * (1.1 * high / 0.7) ** (1 / (1 - room)) if high > 0 else None)
        log_axis(axes, "y", log_base(options))
    elif room:
        axes.set_ylim(top=1.05 * max(axis.dataLim.intervaly[1] for axis in axes.figure.axes) / (1 - room))
    axes.set_xlim(left=0.4)
    axes.grid(axis="y", which="major")
    axes.tick_params(labelbottom=lowest, labelleft=leftmost)
    if lowest:
        axes.set_xlabel(str(options.get("x_label") or "fragments per pixel"))
    if leftmost:
        y_label(axes, str(options.get("y_label") or "pixels"))


def _notes(result: Result, points: Iterable[Point]) -> list[str]:
    points = list(points)
    lacking = list(dict.fromkeys(p.label for p in points if not _frames(p)))
    told = [text for name, text in SYMBOLS.items()
            if any(data.bare(axis) == name and axis in p.cell["params"] for axis in result.axes for p in points)]
    return [f"No histogram of {'; '.join(lacking)}."] * bool(lacking) + [f"{'; '.join(told)}."] * bool(told)
