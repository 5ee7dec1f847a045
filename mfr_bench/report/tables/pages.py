"""The tables of a result as text for a terminal, and as results.md."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from dataclasses import replace

from ...store import ResultFolder
from .. import data, frontier
from ..data import Point, Result
from .blocks import blocks_of
from .checks import breaking_grids, image_grid, printed_grid
from .fields import NOISY, NOISY_NOTE, noise_text
from .grid import Grid, bulleted
from .nodes import nodes_grid
from .places import places_grids

WIDTH = 120  # columns of a terminal
NO_METHOD = "No method but the floor has a cell at any of its levels."


def _skipped(result: Result) -> list[str]:
    """A line for each status and reason that kept cells from being ok; methods of which the same is to say share it."""
    groups: dict[tuple[str, str, str], list[Point]] = {}
    for p in result.points:
        if p.status != "ok":
            groups.setdefault((p.label, p.sign, p.cell.get("reason") or ""), []).append(p)
    told: dict[tuple[str, str], list[str]] = {}
    for (label, sign, reason), points in groups.items():
        told.setdefault((_places(result, label, points), f"{sign}{f': {reason}' if reason else ''}"), []).append(label)
    lines = [f"{data.listed(labels)}{where}: {what}" for (where, what), labels in told.items()]
    if result.unmeasured:
        lines.append(f"{data.without_record(result.unmeasured)} yet{result.why_unmeasured}; run the same command again")
    return [*lines, result.foreign] if result.foreign else lines


def _places(result: Result, label: str, points: Sequence[Point]) -> str:
    if len(points) == sum(p.label == label for p in result.points):
        return ", every cell" if len(points) > 1 else ""
    places = [", ".join(data.heading(a, p.at(a)) for a in result.axes if p.at(a) is not None) for p in points]
    shown = "; ".join(places[:4])
    return f" at {shown}{f'; … ({len(places)} cells)' if len(places) > 4 else ''}"


def _about(result: Result) -> list[str]:
    """Title, source, device, timer, noise floor, steadiness: what a reader needs to judge the numbers, if any."""
    manifest = result.manifest
    title = f"{result.name}: {manifest['title']}" if manifest.get("title") else result.name
    if not result.points:
        return [title]
    noise = manifest.get("noise_floor_rel")
    noise_line = "" if noise is None else f"noise floor {noise_text(noise)} (the same method measured twice)"
    lines = title, result.provenance, result.scene, noise_line, result.unsteady and f"unsteady: {result.unsteady}"
    return [line for line in lines if line]


def _head(result: Result, width: int) -> str:
    return "\n".join(part for line in _about(result) for part in textwrap.wrap(line, width, break_on_hyphens=False))


def _sections(result: Result, passes: bool) -> list[Grid]:
    blocks = blocks_of(result)
    grids = [*breaking_grids(result), image_grid(result), nodes_grid(result)]
    grids += [grid for block in blocks for grid in block.measure_grids()]
    grids += places_grids(result, blocks)
    grids += [block.pass_grid() for block in blocks] if passes else []
    grids.append(printed_grid(result))
    errors = dict.fromkeys(figure["y"] for figure in result.figures
                           if figure.get("kind") == "pareto" and figure.get("y") in data.MEASURES)
    grids += [Grid(*table) for error in list(errors)[:1] for table in frontier.tables(result, error)]
    return _noisy_told([grid for grid in grids if grid.rows])


def _noisy_told(grids: Sequence[Grid]) -> list[Grid]:
    """The grids, the first that calls a time or a ratio noisy with the note on what that means."""
    first = next((grid for grid in grids if any(f" {NOISY}" in text for row in grid.rows for text in row[1:])), None)
    return [replace(grid, note=f"{grid.note}\n{NOISY_NOTE}") if grid is first else grid for grid in grids]


def terminal_table(folder: ResultFolder, width: int = WIDTH) -> str:
    """The tables as plain text, at most `width` columns wide where labels allow."""
    result = data.load(folder)
    parts = [_head(result, width)]
    for grid in _sections(result, passes=False):
        tables = "\n\n".join(chunk.text() for chunk in grid.chunks(width))
        parts.append("\n".join([grid.title, *_notes(grid, width), tables]))
    for title, lines in (("Not ok, or not measured", _skipped(result)), ("Files not used", folder.damaged)):
        if lines:
            parts.append("\n".join([title, *bulleted(lines, width)]))
    return "\n\n".join(parts) + "\n"


def breaking_text(folder: ResultFolder, width: int = WIDTH) -> str:
    """The text that `stress` prints of a folder: where each method breaks."""
    result = data.load(folder)
    parts = [_head(result, width)]
    for grid in breaking_grids(result) if result.points else ():
        tables = "\n\n".join(chunk.text() for chunk in grid.chunks(width))
        parts.append("\n".join([grid.title, tables if grid.rows else NO_METHOD]))
    if result.unmeasured:
        said = f"{data.without_record(result.unmeasured)} yet{result.why_unmeasured}"
        parts.append("\n".join(textwrap.wrap(said, width, break_on_hyphens=False)))
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
