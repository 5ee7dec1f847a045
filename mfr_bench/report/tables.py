"""A result folder as tables: images, time, ratio to the floor, memory, passes, and what was not measured."""

from __future__ import annotations

import textwrap
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from ..methods import FLOOR
from ..store import ResultFolder, csv_text, write_file
from ..store.status import EXACT_ERROR
from . import breaking, data, frontier, printed
from .breaking import FAULTS, Ladder
from .data import Point, Result, number

WIDTH = 120  # columns of a terminal
LABEL_WIDTH = 34
NAME_WIDTH = 58  # of a printed number
ABSENT = "–"  # a cell that was never measured
ALIKE = "≈ 1"  # a ratio of times that noise alone may make

TIME_NOTE = ("median of whole frames, ± half of its 95 % interval; ~ stopped before the target interval; "
             "±? fewer than 6 samples")
RATIO_NOTE = ("time / time of the same geometry with plain blending, ± half of its 95 % interval; "
              "≈ 1 where the interval or the noise floor holds 1")
FASTEST_NOTE = ("of the methods that show every fragment: time / the fastest's, ± half of its 95 % interval; "
                "≈ 1 where it cannot be told from the fastest")
MEMORY_NOTE = "measured / by the paper's formula"
BREAKING_NOTE = ("; ".join(f"{name}: {meaning}" for name, meaning in FAULTS.items())
                 + "; error and bound: where a method that holds is nearest to what rounding explains")
PASS_NOTE = "medians of separate frames: their sum may differ from the whole frame's time"


PRINTED_NOTE = ("as the paper prints them, on its device; here: of the cells that they are about; speed-ups and gains "
                "are judged by mfr-bench claims")


@dataclass(frozen=True)
class Grid:
    """A table of text: `rows` have as many fields as `header`; the first is the row's name."""

    title: str
    note: str
    header: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    left: int = 1  # columns set flush left

    def chunks(self, width: int) -> Iterable[Grid]:
        """The grid in pieces of whole columns, each at most `width` wide and with the first column."""
        lengths = self.lengths()
        start = 1
        while start < len(self.header) or start == 1:
            end, used = start, lengths[0] + 4
            while end < len(lengths) and (end == start or used + lengths[end] + 3 <= width):
                used, end = used + lengths[end] + 3, end + 1
            yield replace(self, header=self._piece(self.header, start, end), left=max(1, self.left - start + 1),
                          rows=tuple(self._piece(row, start, end) for row in self.rows))
            start = max(end, start + 1)

    @staticmethod
    def _piece(row: tuple[str, ...], start: int, end: int) -> tuple[str, ...]:
        return row[0], *row[start:end]

    def lengths(self) -> list[int]:
        return [max(map(len, column)) for column in zip(self.header, *self.rows, strict=True)]

    def aligned(self) -> list[list[str]]:
        lengths = self.lengths()
        return [[field.ljust(width) if i < self.left else field.rjust(width)
                 for i, (field, width) in enumerate(zip(row, lengths, strict=True))]
                for row in (self.header, *self.rows)]

    def text(self) -> str:
        header, *rows = ("   ".join(fields).rstrip() for fields in self.aligned())
        return "\n".join([header, "-" * len(header), *rows])

    def markdown(self) -> str:
        header, *rows = (tuple(field.replace("|", "\\|") for field in row) for row in (self.header, *self.rows))
        escaped = replace(self, header=header, rows=tuple(rows))
        lines = [f"| {' | '.join(fields)} |" for fields in escaped.aligned()]
        rule = "|".join(f":{'-' * (w + 1)}" if i < self.left else f"{'-' * (w + 1)}:"
                        for i, w in enumerate(escaped.lengths()))
        return "\n".join([lines[0], f"|{rule}|", *lines[1:]])


# --- fields --------------------------------------------------------------------------------------


def _spread(interval: data.Interval) -> str:
    low, middle, high = interval
    if low is None or high is None or not middle:
        return "±?"
    percent = 100 * max(high - middle, middle - low) / middle
    return f"±{percent:.1f}%" if percent < 9.95 else f"±{percent:.0f}%"


def _time(point: Point) -> str:
    if point.status != "ok" or point.row["time_ms"] is None:
        return point.sign if point.status != "ok" else ""
    return f"{number(point.row['time_ms'])} {_spread(point.time_ms)}{'~' if point.row['noisy'] else ''}"


def _ratio(point: Point) -> str:
    ratio = point.floor_ratio[1]
    if point.status != "ok" or ratio is None:
        return point.sign if point.status != "ok" else ""
    return _told(point, point.floor_ratio)


def _told(point: Point, ratio: data.Interval) -> str:
    """A ratio of times; one that is no more than noise is not told apart from 1."""
    if None in ratio or point.apart(ratio) or point.method == FLOOR:
        return f"{number(ratio[1])} {_spread(ratio)}"
    return ALIKE


def _beside(point: Point, fastest: Point) -> str:
    """Its time over the fastest's. One that was the faster of both while they took turns is not told apart."""
    if point is fastest:
        return "fastest"
    ratio = point.over(fastest)
    return ALIKE if ratio[1] and ratio[1] < 1 else _told(point, ratio)


def _memory(point: Point) -> str:
    measured, model = (point.measure(name)[1] for name in ("memory_mib", "memory_model_mib"))
    if measured is None:
        return point.sign if point.status != "ok" else ""
    return f"{number(measured)} / {number(model)}" if model is not None else number(measured)


# --- grids ---------------------------------------------------------------------------------------


def _column_axis(result: Result) -> str | None:
    """The axis laid out as columns: the first figure's, else the one with most values."""
    drawn = [data.bare(str(figure.get("x"))) for figure in result.figures][:1]
    preferred = [axis for axis in result.axes if data.bare(axis) in drawn]
    return next(iter(preferred), max(result.axes, key=lambda a: len(data.values(result.points, a)), default=None))


@dataclass(frozen=True)
class Block:
    """Points of one place on the scene axes that are neither columns nor told in the labels."""

    where: str
    axis: str | None
    points: tuple[Point, ...]

    def columns(self) -> list[Any]:
        if self.axis is None:
            return [None]
        unswept = [None] if any(p.at(self.axis) is None for p in self.points) else []
        return [*data.values(self.points, self.axis), *unswept]

    def pivot(self, title: str, note: str, entries: Iterable[tuple[str, Point, str]], corner: str = "method") -> Grid:
        """Entries (row name, point, text) by row name and column; rows without any text are left out."""
        found: dict[tuple[str, Any], str] = {}
        for name, point, text in entries:
            found.setdefault((name, point.at(self.axis) if self.axis else None), text)
        columns, names = self.columns(), dict.fromkeys(name for name, _ in found)
        swept = {name for name, value in found if value is not None}
        rows = tuple((name, *(found.get((name, c), ABSENT if c is not None and name in swept else "") for c in columns))
                     for name in names)
        heads = (data.heading(self.axis, c) if self.axis else "all" for c in columns)
        title = f"{title} ({self.where})" if self.where else title
        return Grid(title, note, (corner, *heads), tuple(row for row in rows if set(row[1:]) - {"", ABSENT}))

    def measure_grids(self) -> list[Grid]:
        fields = (("Time, ms", TIME_NOTE, _time), ("Ratio to the floor", RATIO_NOTE, _ratio),
                  ("Memory, MiB", MEMORY_NOTE, _memory))
        grids = [self.pivot(title, note, [(_cut(p.label), p, field(p)) for p in self.points])
                 for title, note, field in fields]
        grids.insert(2, self.pivot("Ratio to the fastest", FASTEST_NOTE, self._to_the_fastest()))
        grids = [grid for grid in grids if grid.rows]
        return grids if self.axis else [_side_by_side(grids)]

    def _to_the_fastest(self) -> list[tuple[str, Point, str]]:
        """Of each column the methods that show every fragment, where there are several."""
        columns: dict[Any, list[Point]] = {}
        for p in self.points:
            if p.shows_all and p.method != FLOOR:
                columns.setdefault(p.at(self.axis) if self.axis else None, []).append(p)
        entries = []
        for points in columns.values():
            fastest = min(points, key=lambda p: p.row["time_ms"])
            entries += [(_cut(p.label), p, _beside(p, fastest)) for p in points if points[1:]]
        return entries

    def pass_grid(self) -> Grid:
        entries = [(f"{_cut(p.label)} · {name}", p, number(interval[1]))
                   for p in self.points if p.status == "ok" for name, interval in p.passes_ms.items()]
        return self.pivot("Pass times, ms", PASS_NOTE, entries, "method · pass")


def _side_by_side(grids: Sequence[Grid]) -> Grid:
    """One grid of several with a single column each."""
    names = dict.fromkeys(row[0] for grid in grids for row in grid.rows)
    columns = [dict(grid.rows) for grid in grids]
    rows = tuple((name, *(column.get(name, "") for column in columns)) for name in names)
    titles = [grid.title for grid in grids]
    note = "\n".join(f"{title.split(',')[0]}: {grid.note}" for title, grid in zip(titles, grids, strict=True))
    return Grid("Measured", note, ("method", *titles), rows)


def _cut(label: str) -> str:
    return label if len(label) <= LABEL_WIDTH else f"{label[:LABEL_WIDTH - 1]}…"


def _blocks(result: Result) -> list[Block]:
    """Blocks by the scene axes that are not columns; axes of parameters are told in the labels instead."""
    axis = _column_axis(result)
    used = [axis] if axis else []
    parameters = {name for p in result.points for name in p.parameters}
    rest = [a for a in result.split(result.points, used) if data.bare(a) not in parameters]
    places: dict[tuple, list[Point]] = {}
    for p in data.series(result, result.points, [*used, *rest]):
        places.setdefault(tuple(p.at(a) for a in rest), []).append(p)
    return [Block(", ".join(map(data.heading, rest, place)), axis, tuple(members))
            for place, members in places.items()]


def _image(points: Sequence[Point]) -> str:
    checked = [p.exact for p in points if p.exact is not None]
    wrong = sum(p.ending.image == "wrong" for p in points)
    if wrong:
        return f"WRONG in {wrong} of {len(checked) or len(points)}"
    if not checked:
        return "not checked"
    exact = sum(checked)
    return "exact" if exact == len(checked) else f"exact in {exact} of {len(checked)}" if exact else "differs"


def _image_grid(result: Result) -> Grid:
    rows = []
    for label in result.labels:
        points = [p for p in result.points if p.label == label]
        measured = sum(p.status == "ok" for p in points)
        rows.append((_cut(label), points[0].method, f"{measured} of {len(points)}", _image(points),
                     _worst(points, "max_abs_error", max), _worst(points, "wrong_pixels", max),
                     _worst(points, "hit_ratio", min)))
    header = ("method", "id", "cells ok", "image", "max error", "wrong pixels", "hit ratio")
    return Grid("Images", f"exact: no channel differs by more than {EXACT_ERROR:g} from the promised image; "
                          "the worst of all cells is shown", header, tuple(rows), left=2)


def _worst(points: Sequence[Point], column: str, worst) -> str:
    found = [p.row[column] for p in points if p.row[column] is not None]
    return number(worst(found, default=None), 2 if column == "max_abs_error" else 4)


def _printed_grid(result: Result) -> Grid:
    found = printed.rows(result)
    rows = [(textwrap.shorten(name, NAME_WIDTH, placeholder="…"), printed.value_text(row),
             printed.here_text(row, result.points) or ABSENT, row.device or "")
            for name, row in zip(printed.names(found), found, strict=True)]
    return Grid("The paper's numbers", PRINTED_NOTE, ("quantity", "printed", "here", "device"), tuple(rows))


# --- text ----------------------------------------------------------------------------------------


def _skipped(result: Result) -> list[str]:
    """A line for each method, status and reason that kept cells from being ok."""
    groups: dict[tuple[str, str, str], list[Point]] = {}
    for p in result.points:
        if p.status != "ok":
            groups.setdefault((p.label, p.sign, p.cell.get("reason") or ""), []).append(p)
    lines = [f"{label}{_places(result, label, points)}: {sign}{f': {reason}' if reason else ''}"
             for (label, sign, reason), points in groups.items()]
    missing = result.unmeasured
    return [*lines, f"{missing} planned cells have no record yet; run the same command again"] if missing else lines


def _places(result: Result, label: str, points: Sequence[Point]) -> str:
    if len(points) == sum(p.label == label for p in result.points):
        return ", every cell" if len(points) > 1 else ""
    places = [", ".join(data.heading(a, p.at(a)) for a in result.axes if p.at(a) is not None) for p in points]
    shown = "; ".join(places[:4])
    return f" at {shown}{f'; … ({len(places)} cells)' if len(places) > 4 else ''}"


def _about(result: Result) -> list[str]:
    """Title, source, device, timer and noise floor: what a reader needs to judge the numbers."""
    manifest = result.manifest
    title = f"{result.name}: {manifest['title']}" if manifest.get("title") else result.name
    noise = manifest.get("noise_floor_rel")
    noise_line = "" if noise is None else f"noise floor {data.percent(noise)} (the same method measured twice)"
    drift = manifest.get("calibration_drift")
    return [line for line in (title, result.provenance, noise_line, drift and f"unsteady: {drift}") if line]


def _head(result: Result, width: int) -> str:
    return "\n".join(part for line in _about(result) for part in textwrap.wrap(line, width, break_on_hyphens=False))


def _wrapped(lines: Iterable[str], width: int) -> list[str]:
    return [part for line in lines for part in
            textwrap.wrap(line, width, initial_indent="- ", subsequent_indent="  ", break_on_hyphens=False)]


def breaking_grids(result: Result) -> list[Grid]:
    """A grid for each figure of kind `breaking`: the first level at which each method breaks, in each panel."""
    grids = []
    for figure in result.figures:
        if figure.get("kind") == "breaking":
            axis, panels = str(figure["x"]), figure.get("panels")
            points = data.series(result, [p for p in result.points if not data.is_floor(p)],
                                 [name for name in (axis, panels) if name])
            grids.append(_breaking_grid(breaking.ladders(result, points, axis, panels), axis, panels))
    return grids


def _breaking_grid(ladders: Sequence[Ladder], axis: str, panels: str | None) -> Grid:
    names = dict.fromkeys(ladder.panel for ladder in ladders)
    rows = []
    for label in dict.fromkeys(ladder.label for ladder in ladders):
        mine = {ladder.panel: ladder for ladder in ladders if ladder.label == label}
        worst = max((p for p in (ladder.worst for ladder in mine.values()) if p), default=None,
                    key=lambda p: p.row["max_abs_error"] / p.row["error_bound"])
        errors = [number(worst.row[name], 2) if worst else "" for name in ("max_abs_error", "error_bound")]
        rows.append((_cut(label), *errors, *(breaking.told(mine[n]) if n in mine else ABSENT for n in names)))
    heads = [data.heading(panels, n) if panels else "breaks at" for n in names]
    return Grid(f"First level of {data.short(axis)} that breaks each method", BREAKING_NOTE,
                ("method", "error", "bound", *heads), tuple(rows))


def _sections(result: Result, passes: bool) -> list[Grid]:
    blocks = _blocks(result)
    grids = [*breaking_grids(result), _image_grid(result)]
    grids += [grid for block in blocks for grid in block.measure_grids()]
    grids += [block.pass_grid() for block in blocks] if passes else []
    grids.append(_printed_grid(result))
    errors = dict.fromkeys(str(figure["y"]) for figure in result.figures if figure.get("kind") == "pareto")
    grids += [Grid(*table) for error in list(errors)[:1] for table in frontier.tables(result, error)]
    return [grid for grid in grids if grid.rows]


def terminal_table(folder: ResultFolder, width: int = WIDTH) -> str:
    """The tables as plain text, at most `width` columns wide where labels allow."""
    result = data.load(folder)
    parts = [_head(result, width)]
    for grid in _sections(result, passes=False):
        tables = "\n\n".join(chunk.text() for chunk in grid.chunks(width))
        parts.append("\n".join([grid.title, *_notes(grid, width), tables]))
    for title, lines in (("Not ok, or not measured", _skipped(result)), ("Files not used", folder.damaged)):
        if lines:
            parts.append("\n".join([title, *_wrapped(lines, width)]))
    return "\n\n".join(parts) + "\n"


def breaking_text(folder: ResultFolder, width: int = WIDTH) -> str:
    """What `stress` prints of a folder: where each method breaks."""
    result = data.load(folder)
    parts = [_head(result, width)]
    parts += ["\n".join([grid.title, "\n\n".join(chunk.text() for chunk in grid.chunks(width))])
              for grid in breaking_grids(result)]
    return "\n\n".join(parts) + "\n"


def _notes(grid: Grid, width: int) -> list[str]:
    return [part for line in grid.note.splitlines() for part in textwrap.wrap(f"({line})", width)]


def markdown(result: Result) -> str:
    """results.md: everything that `terminal_table` shows, and the pass times."""
    title, *about = _about(result)
    parts = [f"# {title}", *about]
    for grid in _sections(result, passes=True):
        parts += [f"## {grid.title}", *grid.note.splitlines(), *(chunk.markdown() for chunk in grid.chunks(WIDTH))]
    for heading, lines in (("Not ok, or not measured", _skipped(result)), ("Files not used", result.folder.damaged)):
        if lines:
            parts += [f"## {heading}", "\n".join(f"- {line}" for line in lines)]
    return "\n\n".join(parts) + "\n"


def write_tables(folder: ResultFolder) -> list[Path]:
    """Write tables/results.md, summary.csv (a row per cell) and pass_times.csv. Raises StoreError."""
    result = data.load(folder)
    target = folder.path / "tables"
    contents = {"results.md": markdown(result).encode(), "summary.csv": _summary_csv(result),
                "pass_times.csv": _passes_csv(result)}
    for name, content in contents.items():
        write_file(target / name, content)
    (target / "results.csv").unlink(missing_ok=True)  # the name of summary.csv in earlier versions
    return [target / name for name in contents]


CSV_COLUMNS = ("status", "exact", "max_abs_error", "rmse", "psnr_db", "flip", "hit_ratio", "wrong_pixels", "time_ms",
               "time_ms_low", "time_ms_high", "noisy", "floor_ratio", "floor_ratio_low", "floor_ratio_high",
               "memory_mib", "memory_model_mib", "reason")


def _coordinates(result: Result, point: Point) -> dict[str, Any]:
    return {"label": point.label, "method": point.method} | {
        axis: data.plain(v) if (v := point.at(axis)) is not None else None for axis in result.axes}


def _summary_csv(result: Result) -> bytes:
    rows = []
    for p in result.points:
        low, ratio, high = p.floor_ratio
        derived = {"exact": p.exact, "floor_ratio": ratio, "floor_ratio_low": low, "floor_ratio_high": high,
                   "memory_mib": p.measure("memory_mib")[1], "memory_model_mib": p.measure("memory_model_mib")[1]}
        rows.append(p.row | derived | _coordinates(result, p))
    return csv_text(("label", "method", *result.axes, *CSV_COLUMNS), rows)


def _passes_csv(result: Result) -> bytes:
    names = dict.fromkeys(name for p in result.points for name in p.passes_ms)
    rows = [_coordinates(result, p) | {name: interval[1] for name, interval in p.passes_ms.items()}
            for p in result.points if p.passes_ms]
    return csv_text(("label", "method", *result.axes, *names), rows)
