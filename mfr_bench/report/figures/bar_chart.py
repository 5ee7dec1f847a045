"""Bars in groups, of one piece or stacked: what the kinds `bars` and `stacked_passes` share."""

from __future__ import annotations

import math
import textwrap
from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, TypeVar

from .. import data, style
from ..data import Point, Result, number
from .marks import Mark, draw_marks, marks_of
from .scales import log_axes, log_axis, log_base, y_label
from .series import Options, hold_drawn, is_drawn, labels_of, panels_of, refusals, y_text
from .sheet import (
    EDGE,
    HEADING_IN,
    LEFT,
    LEGEND_LINE_IN,
    LONG_LABEL,
    RIGHT,
    legend_columns,
    sheet_of,
    text_width,
    widest,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

T = TypeVar("T")
SLOTS_PER_ROW = 48  # bars side by side whose labels can still be read
ROW_IN, NUMBER_GAP_IN = 1.75, 0.08  # least height of a plot; around the number above a bar
GROUP_GAP = 1.0  # in bars
HEADING_PT, HEADING_RISE_PT = 8, 3.5  # of the words over a group, which clear the highest tick's label
SAID_BELOW = ("width", "height", "order", "layout")  # a lone value of these stands in the small print alone
SIGN_START, MARK_SHARE = 0.02, 0.04  # of a plot's height: the foot of a sign, half a printed mark with its gap
UNMEASURED = "not measured"


@dataclass(frozen=True)
class Slot:
    """The place of one bar. `point` is None for a cell without a record."""

    x: float
    label: str
    point: Point | None


@dataclass(frozen=True)
class BarGroup:
    heading: str
    slots: tuple[Slot, ...]

    @property
    def span(self) -> tuple[float, float]:
        return self.slots[0].x - 0.5, self.slots[-1].x + 0.5


def _groups(points: Sequence[Point], x: str) -> list[tuple[str, list[tuple[str, Point | None]]]]:
    """The bars of each value of x, of every series that varies with it; then, once, those of series that do not.

    With each group stands its heading, which is empty where no series varies with x.
    """
    found: dict[tuple[Any, str], Point] = {}
    for p in points:
        found.setdefault((p.at(x), p.label), p)
    varying = labels_of(p for p in points if p.at(x) is not None)
    groups = [(data.heading(x, v), [(label, found.get((v, label))) for label in varying])
              for v in data.values(points, x)]
    constant = [(label, p) for (v, label), p in found.items() if v is None]
    return [*groups, (data.heading(x, None) if groups else "", constant)] if constant else groups


def _rows(points: Sequence[Point], options: Options) -> list[tuple[str, list[BarGroup]]]:
    """Groups in even rows of at most SLOTS_PER_ROW bars, panel by panel; one with more goes on in the rows below."""
    rows = []
    for panel, members in panels_of(points, options):
        groups = _groups(members, options["x"])
        if options.get("sorted"):
            groups = [(name, _ranked(entries, options["y"])) for name, entries in groups]
        groups = [(name, part) for name, entries in groups for part in _even_parts(entries)]
        widest = max((len(entries) for _, entries in groups), default=1) + GROUP_GAP
        most = max(1, int((SLOTS_PER_ROW + GROUP_GAP) // widest))
        count = max(1, math.ceil(len(groups) / most))
        each = math.ceil(len(groups) / count)
        rows += [(panel, _placed(groups[i:i + each])) for i in range(0, max(1, len(groups)), max(1, each))]
    return rows


def _ranked(entries: Sequence[tuple[str, Point | None]], y: str) -> list[tuple[str, Point | None]]:
    """The bars by their values; of more than SLOTS_PER_ROW those without a value are left out."""
    found = sorted(entries, key=lambda entry: height(entry[1], y))
    return found if len(found) <= SLOTS_PER_ROW else [each for each in found if math.isfinite(height(each[1], y))]


def _left_out(points: Iterable[Point], rows: Iterable[tuple[str, list[BarGroup]]]) -> list[str]:
    """A sentence on the cells that have no place among the bars, by how they ended."""
    placed = {id(slot.point) for _, groups in rows for group in groups for slot in group.slots}
    signs = Counter(p.sign for p in points if id(p) not in placed)
    return [f"Without a bar: {', '.join(f'{count} {sign}' for sign, count in signs.most_common())}."] if signs else []


def _even_parts(entries: Sequence[T]) -> list[Sequence[T]]:
    """The entries of a group in as few parts as have at most SLOTS_PER_ROW each, nearly equally many."""
    each = math.ceil(len(entries) / max(1, math.ceil(len(entries) / SLOTS_PER_ROW)))
    return [entries[start:start + each] for start in range(0, len(entries), max(1, each))]


def height(point: Point | None, y: str) -> float:
    """The value of a bar; more than any where there is none."""
    return point.shown(y)[1] if point is not None and is_drawn(point, y) else math.inf


def _placed(groups) -> list[BarGroup]:
    placed, x = [], 0.0
    for heading, entries in groups:
        placed.append(BarGroup(heading, tuple(Slot(x + i, label, point) for i, (label, point) in enumerate(entries))))
        x += len(entries) + GROUP_GAP
    return placed


@dataclass(frozen=True)
class Segment:
    """A piece of a bar: `name` is its legend entry, or empty."""

    name: str
    height: float
    colour: str


@dataclass(frozen=True)
class Chart:
    """The content of a figure of bars.

    legend: colours by the names of segments. coloured: whether a bar has the colour of its method, and no others.
    """

    result: Result
    options: Options
    points: tuple[Point, ...]
    segments: Callable[[Point], list[Segment]]
    legend: Mapping[str, str]
    coloured: bool

    @property
    def y(self) -> str:
        return self.options["y"]

    @cached_property
    def hatches(self) -> dict[str, str]:
        """Patterns by label, which find a method again from group to group; sorted bars go by the names below them."""
        methods = {p.label: p.method for p in self.points}
        return {} if self.options.get("sorted") else style.hatches(methods, self.coloured)

    @cached_property
    def marks(self) -> list[Mark]:
        """The paper's printed numbers at their bars."""
        return marks_of(self.result, self.options, self.points)

    @cached_property
    def answer(self) -> Point | None:
        """The cell that a decision named, if the manifest has one and it is drawn."""
        key = (self.result.manifest.get("answer") or {}).get("key")
        return next((p for p in self.points if p.cell["key"] == key), None)

    @property
    def answered(self) -> list[str]:
        """The sentence on how the answer of a decision is marked."""
        if self.answer is None:
            return []
        chance = data.percent(self.result.manifest["answer"]["confidence"])
        return [f"Framed: the answer, {self.answer.label}, the fastest with a chance of {chance}."]

    @property
    def log(self) -> bool:
        return "y" in log_axes(self.options)

    def floors_ms(self, points: Iterable[Point]) -> list[float]:
        """Times of the floor that belong to the points, if the figure asks for them."""
        if not self.options.get("floor") or self.y != "time_ms":
            return []
        return sorted({p.floor["values"]["time_ms"] for p in points if p.floor and is_drawn(p, self.y)})

    def above(self, point: Point, top: float) -> tuple[float, float]:
        """The height of a bar's number, and its points above: on the top, or on a mark that would hide it."""
        hiding = [mark.value for mark in self.marks if mark.point is point and mark.value > 0
                  and -0.03 < self.share(mark.value) - self.share(top) < 0.14]
        return max([top, *hiding]), 5.0 if hiding else 2.5

    def share(self, value: float) -> float:
        """The place of a value along the y axis, 0 at its lower end and 1 at its upper."""
        low, high = self.limits
        return math.log(value / low) / math.log(high / low) if self.log else value / high

    def clear_of_marks(self, point: Point | None, text: str, height_in: float) -> float:
        """The y at which upright small words begin, in a plot so many inches high: the base, or above the marks."""
        length = text_width(text, style.SIGN_PT) / height_in
        start = SIGN_START
        for place in sorted(self.share(mark.value) for mark in self.marks if mark.point is point and mark.value > 0):
            if start - MARK_SHARE < place < start + length + MARK_SHARE:
                start = place + MARK_SHARE
        return start if start + length <= 1 else SIGN_START

    @property
    def numbers_share(self) -> float:
        """Part of the height of a plot that the longest number above a bar takes, set upright."""
        numbers = (number(p.shown(self.y)[1]) for p in self.points if is_drawn(p, self.y))
        return min(0.4, (widest(numbers, style.NUMBER_PT) + NUMBER_GAP_IN) / ROW_IN)

    @cached_property
    def limits(self) -> tuple[float, float]:
        """One range for all rows, so that bars of different rows compare. Room above is for the numbers."""
        drawn = [p for p in self.points if is_drawn(p, self.y)]
        tops = [max(sum(s.height for s in self.segments(p)), *(v or 0 for v in p.shown(self.y))) for p in drawn]
        tops += [mark.value for mark in self.marks]
        firsts = [self.segments(p)[0].height for p in drawn]
        if max(tops, default=0) <= 0:
            return (0.1, 10.0) if self.log else (0.0, 1.0)
        if not self.log:
            return 0.0, max(tops) / (1 - self.numbers_share)
        lowest = min(v for v in (*firsts, *self.floors_ms(drawn), *(top / 2 for top in tops)) if v > 0)
        shortest = min(top for top in tops if top > 0)
        low = min(max(0.7 * lowest, max(tops) / 1e5), 0.7 * shortest)
        return low, max(tops) * (max(tops) / low) ** (self.numbers_share / (1 - self.numbers_share))


def _extent(groups: Sequence[BarGroup]) -> float:
    """Width of a row in bars, with a margin of half a bar at either end."""
    return groups[-1].slots[-1].x + 2.0 if groups else 2.0


def bar_figure(chart: Chart, notes: Sequence[str]) -> Figure:
    """The figure, with what the notes say in its small print. Raises NothingToDraw where no bar has a height."""
    hold_drawn(chart.points, chart.y)
    rows = _rows(chart.points, chart.options)
    slots = max((_extent(groups) for _, groups in rows), default=_extent([]))
    width = min(style.WIDTH_IN, max(style.NARROW_IN, LEFT + RIGHT + 0.3 * slots))
    slot_width = (width - LEFT - RIGHT) / slots
    legend = [*chart.legend, *(["floor"] if chart.floors_ms(chart.points) else []),
              *dict.fromkeys(mark.text for mark in chart.marks)]
    columns = legend_columns(legend, width - 2 * EDGE)
    legend_height = LEGEND_LINE_IN * math.ceil(len(legend) / columns) + 0.08 if legend else 0.0
    labels = dict.fromkeys(slot.label for _, groups in rows for group in groups for slot in group.slots)
    label_lines = (line for label in labels for line in _broken(label, slot_width).splitlines())
    label_height = widest(label_lines, _label_size(slot_width)) + 0.07
    plot_height = 2.3 if len(rows) == 1 else ROW_IN
    panelled = any(panel for panel, _ in rows)
    row_height = HEADING_IN * (2 if panelled else 1) + plot_height + label_height
    gap = 0.06
    notes = [*notes, *chart.answered, *_left_out(chart.points, rows), *refusals(chart.points)]
    sheet = sheet_of(chart.result, chart.options, chart.points, notes, width,
                     legend_height + len(rows) * (row_height + gap))
    figure = sheet.figure()
    top = legend_height
    for panel, groups in rows:
        own = _extent(groups) * slot_width
        axes = sheet.axes(figure, LEFT, top + row_height - plot_height - label_height, own, plot_height)
        _bar_row(axes, chart, groups, slot_width)
        if panel:
            axes.set_title(panel, loc="left", pad=17)
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
    printed = Line2D([], [], **style.PRINTED)
    handles = [Patch(facecolor=chart.legend[n], edgecolor="none") if n in chart.legend
               else floor if n == "floor" else printed for n in names]
    return handles, [name.replace("_", " ") for name in names]


def _bar_row(axes: Axes, chart: Chart, groups: Sequence[BarGroup], slot_width: float) -> None:
    slots = [slot for group in groups for slot in group.slots]
    axes.set_ylim(*chart.limits)
    axes.set_xlim(-1.0, _extent(groups) - 1.0)
    if chart.log:
        log_axis(axes, "y", log_base(chart.options))
    y_label(axes, y_text(chart.options))
    _headings(axes, chart, groups, slot_width)
    drawn = [slot for slot in slots if slot.point is not None and is_drawn(slot.point, chart.y)]
    for slot in drawn:
        _bar(axes, slot, chart.segments(slot.point), chart.hatches.get(slot.label, ""))
    if chart.y != "share":  # every bar's is 1
        _totals(axes, drawn, chart)
    draw_marks(axes, ((slot.x, mark) for slot in slots for mark in chart.marks if mark.point is slot.point))
    for slot in slots:
        if slot not in drawn or slot.point.ending.image == "wrong":
            _sign(axes, slot, chart)
    for floor_ms in chart.floors_ms(slot.point for slot in drawn):
        axes.axhline(floor_ms, color=style.INK, linewidth=0.8, linestyle="--", zorder=1, label="floor")
    axes.set_xticks([])
    for slot in slots:
        answer = slot.point is not None and slot.point is chart.answer
        axes.annotate(_broken(slot.label, slot_width), (slot.x, 0), (0, -3), xycoords=axes.get_xaxis_transform(),
                      rotation=90, textcoords="offset points", ha="center", va="top", linespacing=1.0,
                      fontsize=_label_size(slot_width), fontweight="bold" if answer else "normal")
        if answer:
            axes.axvspan(slot.x - 0.5, slot.x + 0.5, facecolor="none", edgecolor=style.INK, linewidth=1.0, zorder=5)
    axes.grid(axis="y", which="major")


def _headings(axes: Axes, chart: Chart, groups: Sequence[BarGroup], slot_width: float) -> None:
    """'k = 8' over each group, or only the 8 where that is too wide, with 'k' before the first."""
    room = min((g.span[1] - g.span[0] + GROUP_GAP for g in groups), default=1.0) * slot_width
    long = widest((g.heading for g in groups), 9) > room
    across = {"xycoords": axes.get_xaxis_transform(), "xytext": (0, HEADING_RISE_PT), "textcoords": "offset points",
              "va": "bottom", "fontweight": "bold", "annotation_clip": False}
    if long:
        name = data.short(chart.options["x"])
        size = min(HEADING_PT, HEADING_PT * (LEFT - EDGE) / text_width(name, HEADING_PT, "bold"))
        axes.annotate(name, (-1.0, 1.0), ha="right", fontsize=size, **across)
    said_below = data.bare(chart.options["x"]) in SAID_BELOW and len(data.values(chart.points, chart.options["x"])) == 1
    for group in groups:
        axes.axvspan(*group.span, color=style.BAND, linewidth=0, zorder=0)
        if said_below:
            continue
        axes.annotate(group.heading.split(" = ")[-1] if long else group.heading, (sum(group.span) / 2, 1.0),
                      ha="center", fontsize=HEADING_PT, **across)


def _label_size(slot_width: float) -> float:
    return min(7.5, max(6.0, 72 * slot_width * 0.68))


def _broken(label: str, slot_width: float) -> str:
    """A long label in as many lines as a bar has room for."""
    count = min(3, int(72 * slot_width / (1.15 * _label_size(slot_width))))
    return "\n".join(textwrap.wrap(label, max(LONG_LABEL, math.ceil(1.2 * len(label) / max(1, count))),
                                   break_on_hyphens=False))


def _bar(axes: Axes, slot: Slot, segments: Sequence[Segment], hatch: str) -> None:
    """Segments from the bottom up, then the method's hatching once over all of them."""
    from matplotlib.patches import Rectangle

    below, alpha = 0.0, 0.35 if slot.point.ending.image == "wrong" else None
    for segment in segments:
        axes.add_artist(Rectangle((slot.x - 0.42, below), 0.84, segment.height, facecolor=segment.colour,
                                  edgecolor="white", linewidth=0.3, alpha=alpha, zorder=2,
                                  label=f"{slot.label}: {segment.name}" if segment.name else slot.label))
        below += segment.height
    if hatch:
        ink = style.hatch_ink([segment.colour for segment in segments])
        axes.add_artist(Rectangle((slot.x - 0.42, 0.0), 0.84, below, facecolor="none", edgecolor=ink, hatch=hatch,
                                  linewidth=0, zorder=2.5, label=f"hatch {hatch}"))


def _totals(axes: Axes, slots: Sequence[Slot], chart: Chart) -> None:
    """The measured value of each bar with its interval, and its number above. A wrong image has none.

    A value without an interval has its line where it is not the height of the bar.
    """
    measured = [(slot, sum(segment.height for segment in chart.segments(slot.point)), *slot.point.shown(chart.y))
                for slot in slots if slot.point.status == "ok"]
    ends = [(slot.x, low, high) for slot, _, low, _, high in measured if low is not None]
    lines = [(slot.x, middle) for slot, stack, low, middle, _ in measured if low is not None or stack != middle]
    if ends:
        axes.vlines(*zip(*ends, strict=True), colors=style.INK, linewidth=0.7, zorder=4)
    if lines:
        xs, middles = zip(*lines, strict=True)
        axes.hlines(middles, [x - 0.42 for x in xs], [x + 0.42 for x in xs], colors=style.INK, linewidth=0.9, zorder=4)
    for slot, stack, _, middle, high in measured:
        top, raised = chart.above(slot.point, max(stack, high or middle))
        axes.annotate(number(middle), (slot.x, top), (0, raised), textcoords="offset points", rotation=90, ha="center",
                      va="bottom", fontsize=style.NUMBER_PT, annotation_clip=False, zorder=5)


def _sign(axes: Axes, slot: Slot, chart: Chart) -> None:
    """Writes why there is no bar, or a pale one, at its base; above a printed mark that would cover the words."""
    text = slot.point.sign if slot.point is not None and slot.point.status != "ok" else UNMEASURED
    wrong = slot.point is not None and slot.point.ending.image == "wrong"
    foot = chart.clear_of_marks(slot.point, text, axes.bbox.height / axes.figure.dpi)
    axes.text(slot.x, foot, text, transform=axes.get_xaxis_transform(), rotation=90, ha="center", va="bottom",
              fontsize=style.SIGN_PT, color=style.ALARM if wrong else style.QUIET, style="italic", zorder=3)
