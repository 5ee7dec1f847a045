"""Marks in a figure of measurements: the paper's printed numbers."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from .. import printed, style
from ..data import Point, Result, short
from .series import Options

if TYPE_CHECKING:
    from matplotlib.axes import Axes


@dataclass(frozen=True)
class Mark:
    """A printed number at a point of the figure; `text` is its legend entry."""

    point: Point
    value: float
    text: str


def marks_of(result: Result, options: Options, points: Sequence[Point]) -> list[Mark]:
    """The printed numbers of the quantity that `printed` names, at the cells that they are about."""
    rows = [row for row in printed.rows(result) if row.quantity == options.get("printed")]
    return [Mark(match.point, value, _text(row, match)) for row in rows for match in printed.matches(row, points)
            if (value := match.printed_here(row)) is not None]


def _text(row: printed.Printed, match: printed.Match) -> str:
    device = f", {row.device}" if row.device else ""
    if match.scale == 1:
        return f"printed{device}"
    scaled = " by pixels" if row.quantity in printed.BY_PIXELS else ", not scaled"
    return f"printed{device} (viewport {match.scale} times as wide{scaled})"


@dataclass(frozen=True)
class Guide:
    """A printed number that belongs to no cell: a place on x, a height on y, or both."""

    x: float | None
    y: float | None
    text: str


def guides_of(result: Result, options: Options) -> list[Guide]:
    """The printed numbers of the quantity that `printed` names, where they are of an axis of a figure of lines."""
    rows = [row for row in printed.rows(result) if row.quantity == options.get("printed") and row.value is not None]
    return [guide for row in rows if row.quantity not in printed.HERE and (guide := _guide(row, options))]


def _guide(row: printed.Printed, options: Options) -> Guide | None:
    """A share is a height where gains are drawn, a speed-up a point at its n; what x counts is a place on x."""
    text = ", ".join(part for part in (f"printed: {printed.value_text(row)}", row.device) if part)
    if options.get("gain_of") and row.unit == "%":
        return Guide(None, row.value, text)
    if options.get("gain_of") and row.unit == "times" and row.n is not None:
        return Guide(row.n, 100 * (row.value - 1), text)
    counts = (row.unit or "").endswith(short(options["x"]))
    return Guide(row.value, None, text) if counts and not options.get("gain_of") else None


def draw_guides(axes: Axes, guides: Iterable[Guide]) -> None:
    """Dotted lines across the panel, or hollow diamonds."""
    for guide in guides:
        if guide.x is not None and guide.y is not None:
            axes.plot([guide.x], [guide.y], zorder=6, label=guide.text, **style.PRINTED)
        elif guide.y is not None:
            axes.axhline(guide.y, label=guide.text, **style.GUIDE)
        else:
            axes.axvline(guide.x, label=guide.text, **style.GUIDE)


def draw_marks(axes: Axes, placed: Iterable[tuple[float, Mark]]) -> None:
    """Hollow diamonds."""
    for x, mark in placed:
        axes.plot([x], [mark.value], zorder=6, label=mark.text, clip_on=False, **style.PRINTED)
