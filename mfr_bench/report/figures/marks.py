"""Marks beside what was measured: the paper's printed numbers."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from .. import printed, style
from ..data import Point, Result
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


def draw_marks(axes: Axes, placed: Iterable[tuple[float, Mark]]) -> None:
    """Hollow diamonds."""
    for x, mark in placed:
        axes.plot([x], [mark.value], zorder=6, label=mark.text, clip_on=False, **style.PRINTED)
