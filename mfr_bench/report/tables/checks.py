"""Tables of what was checked: images, the levels that break methods, the numbers that the paper prints."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence

from ...store.status import EXACT_ERROR
from .. import breaking, data, printed
from ..breaking import FAULTS, Ladder
from ..data import LOSES_TIES, Point, Result, number
from .grid import ABSENT, Grid, cut

NAME_WIDTH = 58  # of a printed number
BREAKING_NOTE = ("; ".join(f"{name}: {meaning}" for name, meaning in FAULTS.items())
                 + "; error and bound: where a method that holds is nearest to what rounding explains")
PRINTED_NOTE = ("as the paper prints them, on its device; here: of the cells that they are about; speed-ups and gains "
                "are judged by mfr-bench claims")


def _image(points: Sequence[Point]) -> str:
    checked = [p.exact for p in points if p.exact is not None]
    wrong = sum(p.ending.image == "wrong" for p in points)
    if wrong:
        return f"WRONG in {wrong} of {len(checked) or len(points)}"
    if not checked:
        return "not checked"
    kept, word = sum(checked), "exact" if all(map(_whole, points)) else "as promised"
    return word if kept == len(checked) else f"{word} in {kept} of {len(checked)}" if kept else "differs"


def _whole(point: Point) -> bool:
    """Whether the point promises every fragment, or its image shows what all of them give; True where nothing tells."""
    if point.loses_ties:
        return False
    row, error = point.row, point.row["max_error_all"]
    share = row["hit_ratio"] if row["promised_ratio"] is None else row["promised_ratio"]
    return share is None or share >= 1 or (error is not None and error <= EXACT_ERROR)


def image_grid(result: Result) -> Grid:
    rows = []
    for label in result.labels:
        points = [p for p in result.points if p.label == label]
        measured = sum(p.status == "ok" for p in points)
        rows.append((cut(label), points[0].method, f"{measured} of {len(points)}", _image(points),
                     _worst(points, "max_abs_error", max), _worst(points, "wrong_pixels", max),
                     _worst(points, "hit_ratio", min)))
    header = ("method", "id", "cells ok", "image", "max error", "wrong pixels", "hit ratio")
    note = (f"exact: no channel differs by more than {EXACT_ERROR:g} from the image of all fragments; as promised: "
            "from that of the fewer fragments that the method promises; the worst of all cells is shown")
    if losers := data.listed(cut(p.label) for p in result.points if p.loses_ties):
        note += f"\nas promised, but for equal depths that meet by chance: {losers} ({LOSES_TIES})"
    return Grid("Images", note, header, tuple(rows), left=2)


def _worst(points: Sequence[Point], column: str, worst) -> str:
    found = [p.row[column] for p in points if p.row[column] is not None]
    return number(worst(found, default=None), 2 if column == "max_abs_error" else 4)


def printed_grid(result: Result) -> Grid:
    found = printed.rows(result)
    rows = [(textwrap.shorten(name, NAME_WIDTH, placeholder="…"), printed.value_text(row),
             printed.here_text(row, result.points) or ABSENT, row.device or "")
            for name, row in zip(printed.names(found), found, strict=True)]
    return Grid("The paper's numbers", PRINTED_NOTE, ("quantity", "printed", "here", "device"), tuple(rows))


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
        rows.append((cut(label), *errors, *(breaking.first_break(mine[n]) if n in mine else ABSENT for n in names)))
    heads = [data.heading(panels, n) if panels else "breaks at" for n in names]
    return Grid(f"First level of {data.short(axis)} that breaks each method", BREAKING_NOTE,
                ("method", "error", "bound", *heads), tuple(rows))
