"""The figures of a result folder, drawn from the store alone and the same to the byte each time.

`build` returns the matplotlib Figure of one entry of the config's `figures`:

    kind     stacked_passes | bars | lines
    x, y     a swept key or column (see `data.Point.at`), a measure (see `data.MEASURES`)
    log      x | y | xy; log_base 2 or 10
    panels   a swept key or column: one panel for each of its values
    methods  labels or ids: only these series
    floor    true: the floor as a dashed line
    title, x_label, y_label
"""

from __future__ import annotations

import gc
import io
import math
import os
import re
import textwrap
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cache, cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..errors import StoreError, nearest
from ..store import ResultFolder, write_file
from . import data, style
from .data import Point, Result, number

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Options = Mapping[str, Any]

FORMATS: Mapping[str, Mapping[str, Any]] = {
    "png": {"dpi": style.DPI, "metadata": {"Software": None}, "pil_kwargs": {"compress_level": 4}},
    "svg": {"metadata": {"Date": None, "Creator": None}},
}
SLOTS_PER_ROW = 48  # bars side by side whose labels can still be read
GROUP_GAP = 1.0  # in bars
LONG_LABEL = 24  # characters from which a label is broken where there is room
WHOLE = "whole frame"
UNMEASURED = "not measured"


def write_figures(folder: ResultFolder, processes: int = 1) -> list[Path]:
    """Write figures/<name>.png and .svg, numbered where there are several. Raises StoreError.

    With 2 `processes` a forked child draws every other figure; not where the process holds a GL context.
    """
    result = data.load(folder)
    name = re.sub(r"[^\w.-]+", "-", result.name).strip("-.") or "figure"
    several = len(result.figures) > 1
    tasks = [(folder.path / "figures" / (f"{name}-{i}" if several else name), options)
             for i, options in enumerate(result.figures, 1)]
    with _uncollected():
        if processes > 1 and several:
            _write_shared(result, tasks)
        else:
            _write(result, tasks)
    return [path.with_name(f"{path.name}.{suffix}") for path, _ in tasks for suffix in FORMATS]


def _write(result: Result, tasks: Iterable[tuple[Path, Options]]) -> None:
    for path, options in tasks:
        for suffix, content in render(build(result, options)).items():
            write_file(path.with_name(f"{path.name}.{suffix}"), content)


def _write_shared(result: Result, tasks: Sequence[tuple[Path, Options]]) -> None:
    from matplotlib.backends import backend_agg, backend_svg  # noqa: F401  loaded once, for both

    child = os.fork()
    if child == 0:
        try:
            _write(result, tasks[1::2])
        except BaseException:  # noqa: BLE001 - a forked child must never return into its parent's code
            os._exit(1)
        os._exit(0)
    _write(result, tasks[::2])
    if os.waitpid(child, 0)[1]:
        _write(result, tasks[1::2])  # its error, told here


@contextmanager
def _uncollected():
    """No garbage collection meanwhile: it would take a fifth of the time, and everything lives to the end anyway."""
    was_enabled = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if was_enabled:
            gc.enable()


def build(result: Result, options: Options) -> Figure:
    """The Figure of one entry of the config's `figures`. Raises StoreError for an option that cannot be drawn."""
    where = f"{result.folder.path}: figure"
    kind = options.get("kind")
    if kind not in KINDS:
        raise StoreError(f"{where}: kind: {kind!r} unknown; allowed: {', '.join(KINDS)}{nearest(str(kind), KINDS)}")
    y = data.drawn_measure(str(options.get("y") or "time_ms"), where)
    if not options.get("x"):
        raise StoreError(f"{where}: x: missing; allowed: a swept key such as k, or a column of results.csv")
    with _styled():
        return KINDS[kind](result, {**options, "y": y})


def render(figure: Figure) -> dict[str, bytes]:
    """The figure as file contents by suffix. Nothing in them depends on when or where they were made."""
    contents = {}
    with _styled():
        for suffix, options in FORMATS.items():
            file = io.BytesIO()
            figure.savefig(file, format=suffix, **options)
            contents[suffix] = file.getvalue()
    return contents


def _styled():
    """The library's defaults and this package's style, whatever the user's own matplotlibrc says."""
    import matplotlib as mpl

    ours = {k: v for k, v in mpl.rcParamsDefault.items() if not k.startswith(("backend", "webagg", "date."))}
    return mpl.rc_context(ours | style.RC)


# --- layout, in inches from the lower left ---------------------------------------------------------

LEFT, RIGHT, EDGE = 0.76, 0.08, 0.07  # room for y labels; at the right; around text
HINTING = 1.03  # glyphs fitted to a screen's pixels are up to this much wider than their outlines
TITLE_IN, HEADING_IN, LEGEND_LINE_IN, SMALL_LINE_IN = 0.2, 0.2, 0.165, 0.112


def text_width(text: str, points: float, weight: str = "normal") -> float:
    """Width of one line of text."""
    return _width_per_point(text, weight) * points / 72


@cache
def _width_per_point(text: str, weight: str) -> float:
    from matplotlib.font_manager import FontProperties
    from matplotlib.textpath import text_to_path

    font = FontProperties(family=style.RC["font.family"], weight=weight, size=100)
    return HINTING * text_to_path.get_text_width_height_descent(text, font, False)[0] / 100


def _widest(texts: Iterable[str], points: float) -> float:
    return max((text_width(text, points) for text in texts), default=0.0)


@dataclass(frozen=True)
class Sheet:
    """A figure's frame: title on top, small print at the bottom, and the height between them."""

    width: float
    title: tuple[str, ...]
    small: tuple[str, ...]
    body: float

    @property
    def height(self) -> float:
        return self.top + self.body + self.bottom

    @property
    def top(self) -> float:
        return EDGE + TITLE_IN * len(self.title) + 0.04

    @property
    def bottom(self) -> float:
        return EDGE + SMALL_LINE_IN * len(self.small) + 0.04

    def figure(self) -> Figure:
        from matplotlib.backends.backend_agg import FigureCanvasAgg
        from matplotlib.figure import Figure

        figure = Figure(figsize=(self.width, self.height))
        FigureCanvasAgg(figure)
        self._write(figure, self.title, self.height - EDGE, "top", fontsize=style.TITLE_PT, fontweight="bold")
        self._write(figure, self.small, EDGE, "bottom", fontsize=style.SMALL_PT, color=style.QUIET, linespacing=1.3)
        return figure

    def _write(self, figure: Figure, lines: Sequence[str], y: float, side: str, **look: Any) -> None:
        figure.text(EDGE / self.width, y / self.height, "\n".join(lines), ha="left", va=side, **look)

    def axes(self, figure: Figure, left: float, top: float, width: float, height: float, **shared: Any) -> Axes:
        """Axes whose upper left corner is `top` below the body's upper edge."""
        bottom = self.bottom + self.body - top - height
        return figure.add_axes((left / self.width, bottom / self.height, width / self.width, height / self.height),
                               **shared)

    def y(self, below: float) -> float:
        """Figure fraction of a place `below` the body's upper edge."""
        return (self.bottom + self.body - below) / self.height


def _sheet(result: Result, options: Options, notes: Iterable[str], width: float, body: float) -> Sheet:
    title = str(options.get("title") or result.manifest.get("title") or result.name)
    small = [part for line in (*notes, result.provenance) if line for part in _fitted(line, style.SMALL_PT, width)]
    return Sheet(width, tuple(_fitted(title, style.TITLE_PT, width, "bold")), tuple(small), body)


def _fitted(text: str, points: float, width: float, weight: str = "normal") -> list[str]:
    """The text in lines that fit between the edges, broken between words."""
    room = width - 2 * EDGE
    if text_width(text, points, weight) <= room:
        return [text]
    lines = [""]
    for word in text.split():
        longer = f"{lines[-1]} {word}".strip()
        if not lines[-1] or text_width(longer, points, weight) <= room:
            lines[-1] = longer
        else:
            lines.append(word)
    return lines


def _legend_columns(names: Sequence[str], width: float, points: float = 7.5) -> int:
    """Most columns of a legend that fits into `width`."""
    for columns in range(len(names), 1, -1):
        parts = [_widest(names[i::columns], points) + 3.4 * points / 72 for i in range(columns)]
        if sum(parts) <= width:
            return columns
    return 1


# --- what is drawn -------------------------------------------------------------------------------


def _series(result: Result, options: Options) -> list[Point]:
    """The points of a figure, labelled so that each label is one line or one bar per group."""
    wanted = options.get("methods")
    points = [p for p in result.points if (p.method in wanted or p.label in wanted or p.cell["label"] in wanted
                                           if wanted else not data.is_floor(p))]
    return data.series(result, points, [n for n in (options["x"], options.get("panels")) if n])


def _panels(points: Sequence[Point], options: Options) -> list[tuple[str, list[Point]]]:
    """Points by panel, with its heading; methods that the panel's parameter does not touch are in each."""
    name = options.get("panels")
    if not name:
        return [("", list(points))]
    found = data.values(points, name)
    return [(data.heading(name, v), [p for p in points if p.at(name) in (v, None)]) for v in found]


def _labels(points: Iterable[Point]) -> list[str]:
    return list(dict.fromkeys(p.label for p in points))


def _drawn(point: Point, y: str) -> bool:
    return point.status in ("ok", "wrong") and point.measure(y)[1] is not None


def _axis_label(name: str) -> str:
    names = {"n": "fragments per pixel, n", "k": "fragments kept per pixel, k", "p_d": "pixel density, p_d",
             "f_p": "fragment probability, f_p"}
    return names.get(data.short(name), data.short(name))


# --- scales --------------------------------------------------------------------------------------


def _log_axis(axes: Axes, which: str, base: int) -> None:
    """A logarithmic axis whose ticks are plain numbers: 8, 16, 32."""
    from matplotlib.ticker import FuncFormatter, LogLocator, NullLocator

    axis = getattr(axes, f"{which}axis")
    getattr(axes, f"set_{which}scale")("log", base=base)
    axis.set_major_locator(LogLocator(base=base, numticks=12))
    axis.set_major_formatter(FuncFormatter(lambda v, _: f"{v:,.10g}" if 1 <= v < 1e6 else f"{v:.3g}"))
    axis.set_minor_locator(NullLocator())
    low, high = getattr(axes, f"get_{which}lim")()
    if base == 10 and high / low < 40:  # fewer than two decades: 1, 2, 5, 10
        axis.set_major_locator(LogLocator(base=10, subs=(1, 2, 5), numticks=12))


def _y_label(axes: Axes, text: str) -> None:
    """The label at the figure's left edge, whatever the width of the tick labels."""
    from matplotlib.transforms import blended_transform_factory

    axes.set_ylabel(text, va="top")
    width = axes.figure.get_figwidth()
    axes.yaxis.set_label_coords(EDGE / width, 0.5, blended_transform_factory(axes.figure.transFigure, axes.transAxes))


def _log_axes(options: Options) -> str:
    return str(options.get("log") or "")


def _log_base(options: Options) -> int:
    return int(options.get("log_base") or 10)


# --- bars ----------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Slot:
    """The place of one bar. `point` is None for a cell without a record."""

    x: float
    label: str
    point: Point | None


@dataclass(frozen=True)
class Group:
    heading: str
    slots: tuple[Slot, ...]

    @property
    def span(self) -> tuple[float, float]:
        return self.slots[0].x - 0.5, self.slots[-1].x + 0.5


def _groups(points: Sequence[Point], x: str) -> list[tuple[str, list[tuple[str, Point | None]]]]:
    """Per value of x every series that varies with x; then, once, the series that do not."""
    found: dict[tuple[Any, str], Point] = {}
    for p in points:
        found.setdefault((p.at(x), p.label), p)
    varying = _labels(p for p in points if p.at(x) is not None)
    groups = [(data.heading(x, v), [(label, found.get((v, label))) for label in varying])
              for v in data.values(points, x)]
    constant = [(label, p) for (v, label), p in found.items() if v is None]
    return [*groups, (data.heading(x, None), constant)] if constant else groups


def _rows(points: Sequence[Point], options: Options) -> list[tuple[str, list[Group]]]:
    """Groups in even rows of at most SLOTS_PER_ROW bars (but at least one group), panel by panel."""
    rows = []
    for panel, members in _panels(points, options):
        groups = _groups(members, options["x"])
        widest = max((len(entries) for _, entries in groups), default=1) + GROUP_GAP
        most = max(1, int((SLOTS_PER_ROW + GROUP_GAP) // widest))
        count = max(1, math.ceil(len(groups) / most))
        each = math.ceil(len(groups) / count)
        rows += [(panel, _placed(groups[i:i + each])) for i in range(0, max(1, len(groups)), max(1, each))]
    return rows


def _placed(groups) -> list[Group]:
    placed, x = [], 0.0
    for heading, entries in groups:
        placed.append(Group(heading, tuple(Slot(x + i, label, point) for i, (label, point) in enumerate(entries))))
        x += len(entries) + GROUP_GAP
    return placed


@dataclass(frozen=True)
class Segment:
    """A piece of a bar: `name` is its legend entry, or empty."""

    name: str
    height: float
    colour: str


def _pass_segments(point: Point, colours: Mapping[str, str], share: bool) -> list[Segment]:
    whole = sum(interval[1] for interval in point.passes_ms.values()) if share else 1.0
    timed = [Segment(name, interval[1] / whole, colours[name]) for name, interval in point.passes_ms.items()]
    return timed or [Segment(WHOLE, point.row["time_ms"], style.WHOLE_FRAME)]


def stacked_passes(result: Result, options: Options) -> Figure:
    """Bars grouped by x, one per method, stacked by pass; kplus_2015 Fig. 6, gpupro5 Fig. 1.3."""
    points = _series(result, options)
    colours = style.pass_colours({name: None for p in points if _drawn(p, "time_ms") for name in p.passes_ms})
    hatches = dict(zip(_labels(points), style.HATCHES * (1 + len(points) // len(style.HATCHES)), strict=False))
    note = ("bar: sum of the passes' medians, timed in frames of their own; "
            "line and number: the whole frame's median (ms) with its 95 % interval")
    share = options["y"] == "share"
    chart = Chart(result, {**options, "y": "share" if share else "time_ms"}, tuple(points),
                  lambda p: _pass_segments(p, colours, share), hatches, colours)
    return _bar_figure(chart, [] if share else [note])


def bars(result: Result, options: Options) -> Figure:
    """Bars of one measure grouped by x, one per method, coloured by method."""
    def segments(point: Point) -> list[Segment]:
        return [Segment("", point.measure(options["y"])[1], style.method_colour(point.method))]

    return _bar_figure(Chart(result, options, tuple(_series(result, options)), segments, {}, {}), [])


@dataclass(frozen=True)
class Chart:
    """What a figure of bars shows: `legend` maps names to colours, `hatches` labels to patterns."""

    result: Result
    options: Options
    points: tuple[Point, ...]
    segments: Callable[[Point], list[Segment]]
    hatches: Mapping[str, str]
    legend: Mapping[str, str]

    @property
    def y(self) -> str:
        return self.options["y"]

    @property
    def log(self) -> bool:
        return "y" in _log_axes(self.options)

    def floors_ms(self, points: Iterable[Point]) -> list[float]:
        """Times of the floor that belong to the points, if the figure asks for them."""
        if not self.options.get("floor") or self.y != "time_ms":
            return []
        return sorted({p.floor["values"]["time_ms"] for p in points if p.floor and _drawn(p, self.y)})

    def limits(self) -> tuple[float, float]:
        """One range for all rows, so that bars of different rows compare. Room above is for the numbers."""
        drawn = [p for p in self.points if _drawn(p, self.y)]
        tops = [max(sum(s.height for s in self.segments(p)), *(v or 0 for v in p.measure(self.y))) for p in drawn]
        firsts = [self.segments(p)[0].height for p in drawn]
        if max(tops, default=0) <= 0:
            return (0.1, 10.0) if self.log else (0.0, 1.0)
        if not self.log:
            return 0.0, max(tops) * 1.2
        lowest = min(v for v in (*firsts, *self.floors_ms(drawn), *(top / 2 for top in tops)) if v > 0)
        low = max(0.7 * lowest, max(tops) / 1e5)
        return low, max(tops) * (max(tops) / low) ** 0.16


def _extent(groups: Sequence[Group]) -> float:
    """Width of a row in bars, with a margin of half a bar at either end."""
    return groups[-1].slots[-1].x + 2.0 if groups else 2.0


def _bar_figure(chart: Chart, notes: Sequence[str]) -> Figure:
    rows = _rows(chart.points, chart.options)
    slots = max(_extent(groups) for _, groups in rows)
    width = min(style.WIDTH_IN, max(style.NARROW_IN, LEFT + RIGHT + 0.3 * slots))
    slot_width = (width - LEFT - RIGHT) / slots
    legend = [*chart.legend, *(["floor"] if chart.floors_ms(chart.points) else [])]
    columns = _legend_columns(legend, width - 2 * EDGE)
    legend_height = LEGEND_LINE_IN * math.ceil(len(legend) / columns) + 0.08 if legend else 0.0
    label_lines = (line for label in _labels(chart.points) for line in _broken(label, slot_width).splitlines())
    label_height = _widest(label_lines, _label_size(slot_width)) + 0.07
    plot_height = 2.3 if len(rows) == 1 else 1.75
    panelled = any(panel for panel, _ in rows)
    row_height = HEADING_IN * (2 if panelled else 1) + plot_height + label_height
    gap = 0.06
    sheet = _sheet(chart.result, chart.options, notes, width, legend_height + len(rows) * (row_height + gap))
    figure = sheet.figure()
    top = legend_height
    for panel, groups in rows:
        own = _extent(groups) * slot_width
        axes = sheet.axes(figure, LEFT, top + row_height - plot_height - label_height, own, plot_height)
        _bar_row(axes, chart, groups, slot_width)
        if panel:
            axes.set_title(panel, loc="left", pad=16)
        top += row_height + gap
    if legend:
        figure.legend(*_legend_entries(chart, legend), loc="upper left", ncols=columns, handlelength=1.2,
                      handleheight=0.9, handletextpad=0.5, columnspacing=1.4, borderpad=0, borderaxespad=0,
                      bbox_to_anchor=(EDGE / width, sheet.y(0.0)))
    return figure


def _legend_entries(chart: Chart, names: Sequence[str]):
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    floor = Line2D([], [], color=style.INK, linewidth=0.9, linestyle="--")
    handles = [Patch(facecolor=chart.legend[n], edgecolor="none") if n in chart.legend else floor for n in names]
    return handles, [name.replace("_", " ") for name in names]


def _bar_row(axes: Axes, chart: Chart, groups: Sequence[Group], slot_width: float) -> None:
    slots = [slot for group in groups for slot in group.slots]
    axes.set_ylim(*chart.limits())
    axes.set_xlim(-1.0, _extent(groups) - 1.0)
    if chart.log:
        _log_axis(axes, "y", _log_base(chart.options))
    _y_label(axes, str(chart.options.get("y_label") or data.MEASURES[chart.y]))
    _headings(axes, chart, groups, slot_width)
    drawn = [slot for slot in slots if slot.point is not None and _drawn(slot.point, chart.y)]
    for slot in drawn:
        _bar(axes, slot, chart.segments(slot.point), chart.hatches.get(slot.label, ""))
    if chart.y != "share":  # every bar's is 1
        _totals(axes, drawn, chart.y)
    for slot in slots:
        if slot not in drawn or slot.point.status == "wrong":
            _sign(axes, slot)
    for floor_ms in chart.floors_ms(slot.point for slot in drawn):
        axes.axhline(floor_ms, color=style.INK, linewidth=0.8, linestyle="--", zorder=1, label="floor")
    axes.set_xticks([])
    for slot in slots:
        axes.annotate(_broken(slot.label, slot_width), (slot.x, 0), (0, -3), xycoords=axes.get_xaxis_transform(),
                      rotation=90, textcoords="offset points", ha="center", va="top", linespacing=1.0,
                      fontsize=_label_size(slot_width))
    if not slots:
        _nothing(axes)
    axes.grid(axis="y", which="major")


def _headings(axes: Axes, chart: Chart, groups: Sequence[Group], slot_width: float) -> None:
    """'k = 8' over each group, or only the 8 where that is too wide, with 'k' before the first."""
    room = min((g.span[1] - g.span[0] + GROUP_GAP for g in groups), default=1.0) * slot_width
    long = _widest((g.heading for g in groups), 9) > room
    across = {"transform": axes.get_xaxis_transform(), "va": "bottom", "fontweight": "bold", "fontsize": 8}
    if long:
        axes.text(-1.0, 1.01, data.short(chart.options["x"]), ha="right", **across)
    for group in groups:
        axes.axvspan(*group.span, color=style.BAND, linewidth=0, zorder=0)
        axes.text(sum(group.span) / 2, 1.01, group.heading.split(" = ")[-1] if long else group.heading, ha="center",
                  **across)


def _label_size(slot_width: float) -> float:
    return min(7.5, max(6.0, 72 * slot_width * 0.68))


def _broken(label: str, slot_width: float) -> str:
    """A long label in as many lines as a bar has room for."""
    count = min(3, int(72 * slot_width / (1.15 * _label_size(slot_width))))
    return "\n".join(textwrap.wrap(label, max(LONG_LABEL, math.ceil(1.2 * len(label) / max(1, count))),
                                   break_on_hyphens=False))


def _nothing(axes: Axes) -> None:
    axes.text(0.5, 0.5, "nothing measured", transform=axes.transAxes, ha="center", color=style.QUIET, style="italic")


def _bar(axes: Axes, slot: Slot, segments: Sequence[Segment], hatch: str) -> None:
    """Segments from the bottom up, then the method's hatching once over all of them."""
    from matplotlib.patches import Rectangle

    below, alpha = 0.0, 0.35 if slot.point.status == "wrong" else None
    for segment in segments:
        axes.add_artist(Rectangle((slot.x - 0.42, below), 0.84, segment.height, facecolor=segment.colour,
                                  edgecolor="white", linewidth=0.3, alpha=alpha, zorder=2,
                                  label=f"{slot.label}: {segment.name}" if segment.name else slot.label))
        below += segment.height
    if hatch:
        axes.add_artist(Rectangle((slot.x - 0.42, 0.0), 0.84, below, facecolor="none", edgecolor=style.HATCH_INK,
                                  hatch=hatch, linewidth=0, zorder=2.5, label=f"hatch {hatch}"))


def _totals(axes: Axes, slots: Sequence[Slot], y: str) -> None:
    """The measured value of each bar with its interval, and its number above. A wrong image has none."""
    intervals = [(slot.x, *slot.point.measure(y)) for slot in slots if slot.point.status == "ok"]
    with_ends = [interval for interval in intervals if interval[1] is not None]
    if with_ends:
        xs, lows, middles, highs = zip(*with_ends, strict=True)
        axes.vlines(xs, lows, highs, colors=style.INK, linewidth=0.7, zorder=4)
        axes.hlines(middles, [x - 0.42 for x in xs], [x + 0.42 for x in xs], colors=style.INK, linewidth=0.9, zorder=4)
    for x, _, middle, high in intervals:
        axes.annotate(number(middle), (x, high or middle), (0, 2.5), textcoords="offset points", rotation=90,
                      ha="center", va="bottom", fontsize=style.NUMBER_PT, annotation_clip=False, zorder=5)


def _sign(axes: Axes, slot: Slot) -> None:
    """Why there is no bar, or a pale one, in words, at its base."""
    text = slot.point.sign if slot.point is not None and slot.point.status != "ok" else UNMEASURED
    wrong = slot.point is not None and slot.point.status == "wrong"
    axes.text(slot.x, 0.02, text, transform=axes.get_xaxis_transform(), rotation=90, ha="center", va="bottom",
              fontsize=style.SIGN_PT, color=style.ALARM if wrong else style.QUIET, style="italic", zorder=3)


# --- lines ---------------------------------------------------------------------------------------


def lines(result: Result, options: Options) -> Figure:
    """x against y, one line per method with its interval; kplus_2015 Figs. 8 and 9."""
    plot = Plot(result, options, tuple(_series(result, options)))
    panels = _panels(plot.points, options)
    columns = min(3, len(panels)) or 1
    rows = math.ceil(len(panels) / columns)
    entries = {label: "\n".join(textwrap.wrap(label, LONG_LABEL + 4)) for label in [*plot.labels, "floor"]}
    legend_width = _widest((line for entry in entries.values() for line in entry.splitlines()), 7.5) + 0.52
    plot_height = 2.2 if rows > 1 else max(2.7, 0.13 * sum(1.3 + e.count("\n") for e in entries.values()))
    heading = HEADING_IN if any(panel for panel, _ in panels) else 0.06
    step = heading + plot_height + 0.24
    sheet = _sheet(result, options, _gaps(plot.points, plot.x, plot.y), style.WIDTH_IN, rows * step + 0.18)
    figure = sheet.figure()
    panel_width = (sheet.width - LEFT - legend_width - 2 * EDGE - 0.12 * (columns - 1)) / columns
    grid: list[Axes] = []
    for i, (panel, members) in enumerate(panels):
        shared = {"sharex": grid[0], "sharey": grid[0]} if grid else {}
        axes = sheet.axes(figure, LEFT + i % columns * (panel_width + 0.12), i // columns * step + heading, panel_width,
                          plot_height, **shared)
        grid.append(axes)
        plot.draw(axes, members)
        axes.set_title(panel, loc="left")
    for i, axes in enumerate(grid):
        plot.finish(axes, panel_width, leftmost=i % columns == 0, lowest=i + columns >= len(grid))
    handles = plot.handles(grid)
    if handles:
        figure.legend(handles.values(), [entries[name] for name in handles], loc="upper left", handlelength=3.0,
                      labelspacing=0.55, borderpad=0, borderaxespad=0,
                      bbox_to_anchor=(1 - (legend_width + EDGE) / sheet.width, sheet.y(heading)))
    elif grid:
        _nothing(grid[0])
    return figure


@dataclass(frozen=True)
class Plot:
    """What a figure of lines shows, in any number of panels."""

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
        return _labels(self.points)

    @cached_property
    def numeric(self) -> bool:
        return all(isinstance(v, (int, float)) for v in data.values(self.points, self.x))

    @cached_property
    def places(self) -> dict[Any, float]:
        """Position of each value of x: the number itself, or its rank where it is none."""
        found = data.values(self.points, self.x)
        return {v: float(v) if self.numeric else float(i) for i, v in enumerate(found)}

    @property
    def log_x(self) -> bool:
        return "x" in _log_axes(self.options) and self.numeric and min(self.places.values(), default=0) > 0

    def draw(self, axes: Axes, points: Sequence[Point]) -> None:
        for label in _labels(points):
            members = [p for p in points if p.label == label and p.status == "ok" and p.measure(self.y)[1] is not None]
            if members:
                self._line(axes, label, members)
        if self.options.get("floor") and self.y == "time_ms":
            self._floor(axes, points)

    def _line(self, axes: Axes, label: str, members: Sequence[Point]) -> None:
        """One series, broken where a value is missing; level and unmarked where x does not touch the method."""
        found = {self.places[p.at(self.x)]: p.measure(self.y) for p in members if p.at(self.x) is not None}
        level = not found
        if level:
            found = dict.fromkeys(self.places.values() or [0.0], members[0].measure(self.y))
        xs = [v for v in self.places.values() if min(found) <= v <= max(found)] or list(found)
        intervals = [found.get(v, (None, math.nan, None)) for v in xs]
        lows = [0.0 if low is None else middle - low for low, middle, _ in intervals]
        highs = [0.0 if high is None else high - middle for _, middle, high in intervals]
        i = self.labels.index(label)
        axes.errorbar(xs, [middle for _, middle, _ in intervals], (lows, highs), label=label,
                      color=style.method_colour(members[0].method), linestyle=style.LINES[i % len(style.LINES)],
                      marker="" if level else style.MARKERS[i % len(style.MARKERS)], markeredgecolor="white",
                      markeredgewidth=0.4, elinewidth=0.8, capsize=1.8, capthick=0.8)

    def _floor(self, axes: Axes, points: Sequence[Point]) -> None:
        found = {self.places[p.at(self.x)]: p.floor["values"]["time_ms"] for p in points
                 if p.floor and p.at(self.x) is not None}
        xs = sorted(found)
        if xs:
            axes.plot(xs, [found[v] for v in xs], color=style.INK, linewidth=0.9, linestyle="--", label="floor")

    def finish(self, axes: Axes, width: float, leftmost: bool, lowest: bool) -> None:
        """Scales, ticks and labels, once every panel is drawn: the panels share them."""
        if "y" in _log_axes(self.options):
            _log_axis(axes, "y", _log_base(self.options))
        else:
            axes.set_ylim(bottom=0)
        if self.log_x:
            _log_axis(axes, "x", _log_base(self.options))
        low, high = self._x_limits()
        axes.set_xlim(low, high)
        axes.grid(which="major")
        axes.set_xticks(list(self.places.values()), self._tick_labels(width))
        axes.tick_params(labelbottom=lowest, labelleft=leftmost)
        if lowest:
            axes.set_xlabel(str(self.options.get("x_label") or _axis_label(self.x)))
        if leftmost:
            _y_label(axes, str(self.options.get("y_label") or data.MEASURES[self.y]))

    def _x_limits(self) -> tuple[float, float]:
        first, last = min(self.places.values(), default=1.0), max(self.places.values(), default=1.0)
        if self.log_x:
            pad = (last / first) ** 0.05 if last > first else 2.0
            return first / pad, last * pad
        pad = 0.05 * (last - first) or 1.0
        return first - pad, last + pad

    def _tick_labels(self, width: float) -> list[str]:
        """The values of x; one that would run into its left neighbour is left blank."""
        scale = math.log if self.log_x else float
        low, high = map(scale, self._x_limits())
        labels, free = [], -math.inf
        for value, place in self.places.items():
            text = data.plain(value)
            middle, half = (scale(place) - low) / (high - low) * width, text_width(text, 7.5) / 2
            fits = middle - half > free
            labels.append(text if fits else "")
            free = middle + half + 0.04 if fits else free
        return labels

    def handles(self, grid: Iterable[Axes]) -> dict[str, Any]:
        """Legend entries from the highest line's right end to the lowest, as the eye meets them; the floor last."""
        found: dict[str, Any] = {}
        for axes in grid:
            for handle, label in zip(*axes.get_legend_handles_labels(), strict=True):
                found.setdefault(label, handle.lines[0] if label != "floor" else handle)
        ends = {}
        for p in sorted(self.points, key=lambda p: self.places.get(p.at(self.x), 0.0)):
            if p.label in found and p.status == "ok" and p.measure(self.y)[1] is not None:
                ends[p.label] = p.measure(self.y)[1]
        ordered = [*sorted(ends, key=lambda label: -ends[label]), *(label for label in found if label not in ends)]
        return {label: found[label] for label in ordered}


def _gaps(points: Sequence[Point], x: str, y: str) -> list[str]:
    """A sentence for each method with cells that are no points of its line."""
    groups: dict[tuple[str, str], list[str]] = {}
    for p in points:
        if p.status != "ok":
            groups.setdefault((p.label, p.sign), []).append(data.plain(p.at(x)) if p.at(x) is not None else "")
    texts = [f"{label}: {sign}{_at(x, where, sum(p.label == label for p in points))}"
             for (label, sign), where in groups.items()]
    return [f"Not drawn: {'; '.join(texts)}"] if texts else []


def _at(x: str, where: Sequence[str], cells: int) -> str:
    found = list(dict.fromkeys(w for w in where if w))
    return f" at {data.short(x)} = {', '.join(found)}" if found and len(where) < cells else ""


KINDS: Mapping[str, Callable[[Result, Options], Figure]] = {
    "stacked_passes": stacked_passes, "bars": bars, "lines": lines}
