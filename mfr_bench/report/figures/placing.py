"""Places small texts next to points so that none hides another."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any

from .. import style
from .sheet import POINTS, text_width

if TYPE_CHECKING:
    from matplotlib.axes import Axes

LINE = 1.05  # height of a line, in sizes of its type
CLEAR = 0.9  # points on either side of a line that stay free, half its width included
FAR = 6.0  # points, from which on a thin line leads from a text to its point
DIRECTIONS = ((1, 0), (-1, 0), (0, 1), (0, -1), (1, 1), (-1, 1), (1, -1), (-1, -1))
SIDES = {1: ("left", "bottom"), 0: ("center", "center"), -1: ("right", "top")}  # alignments by direction

Place = tuple[float, float]  # in data
Box = tuple[float, float, float, float]  # left, bottom, right, top, in points


def around(*distances: float) -> list[tuple[float, float]]:
    """Offsets in points in every direction, the nearest first."""
    return [(d * x, d * y) for d in distances for x, y in DIRECTIONS]


class Placed:
    """The texts of one panel whose scales and limits are set, and what they must leave free."""

    def __init__(self, axes: Axes, marks: Iterable[tuple[Place, float]], lines: Iterable[tuple[Place, Place]] = ()):
        """marks: places in data, each with half the side of the square around it that stays free, in points.

        lines: the two ends of each line, level or upright, that no text may cross.
        """
        share, (width, height) = axes.get_position(), axes.figure.get_size_inches()
        self._axes, self._width, self._height = axes, POINTS * width * share.width, POINTS * height * share.height
        self._taken = [self._box(*point, 0.0, 0.0, half, half) for point, half in marks]
        self._taken += [self._along(*ends) for ends in lines]

    def put(self, point: Place, text: str, size: float, offsets: Sequence[tuple[float, float]],
            **look: Any) -> bool:
        """Write the text at the first of the offsets, in points, where it hides nothing; whether there is one."""
        half = POINTS * text_width(text, size) / 2, LINE * size / 2
        for dx, dy in offsets:
            box = self._box(*point, dx + _sign(dx) * half[0], dy + _sign(dy) * half[1], *half)
            if self._fits(box):
                self._taken.append(box)
                (across, _), (_, up) = SIDES[_sign(dx)], SIDES[_sign(dy)]
                led = {"arrowstyle": "-", "linewidth": 0.3, "color": style.QUIET, "shrinkA": 0.0, "shrinkB": 1.5}
                self._axes.annotate(text, point, (dx, dy), textcoords="offset points", fontsize=size, ha=across, va=up,
                                    arrowprops=led if math.hypot(dx, dy) > FAR else None, **look)
                return True
        return False

    def _along(self, start: Place, end: Place) -> Box:
        """The box around a line."""
        one, other = (self._box(*place, 0.0, 0.0, CLEAR, CLEAR) for place in (start, end))
        return min(one[0], other[0]), min(one[1], other[1]), max(one[2], other[2]), max(one[3], other[3])

    def _fits(self, box: Box) -> bool:
        left, bottom, right, top = box
        within = left >= 0 and bottom >= 0 and right <= self._width and top <= self._height
        return within and not any(left < other[2] and right > other[0] and bottom < other[3] and top > other[1]
                                  for other in self._taken)

    def _box(self, x: float, y: float, dx: float, dy: float, half_width: float, half_height: float) -> Box:
        """A box around a place that is so far from a point, from the panel's lower left corner."""
        at = self._axes.transAxes.inverted().transform(self._axes.transData.transform((x, y)))
        middle = at[0] * self._width + dx, at[1] * self._height + dy
        return middle[0] - half_width, middle[1] - half_height, middle[0] + half_width, middle[1] + half_height


def _sign(value: float) -> int:
    return (value > 0) - (value < 0)
