"""Polynomials through the points of a line, with their coefficients and R² written into the panel."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from .. import style
from ..data import Point
from .series import labels_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes

DEGREES = {"linear": 1, "quadratic": 2}
STEPS = 60  # of a drawn curve
LINE_PT = 7.4  # from one equation to the next
CORNER = 0.985  # of the panel's height, where the first stands
POINTS_PER_INCH = 72
MOST_ROOM = 0.6  # of a panel's height, that its equations take
SUPERSCRIPTS = ("", "x", "x²")


@dataclass(frozen=True)
class Fit:
    """y = Σ coefficients[i]·x^i by least squares, and the share of the variance that it explains."""

    label: str
    method: str
    coefficients: tuple[float, ...]
    r_squared: float
    xs: tuple[float, float]

    @property
    def text(self) -> str:
        terms = [f"{c:.3g}{f'·{power}' if power else ''}" for c, power in
                 zip(self.coefficients, SUPERSCRIPTS, strict=False)]
        return f"{self.label}: {' + '.join(terms).replace('+ -', '− ')}, R² {self.r_squared:.4f}"

    def at(self, x: float) -> float:
        return sum(c * x**i for i, c in enumerate(self.coefficients))


def fits_of(points: Sequence[Point], x: str, y: str, kind: str) -> list[Fit]:
    """A fit for each label that has more points than the polynomial has coefficients."""
    found = [(label, [p for p in points if p.label == label and p.status == "ok"]) for label in labels_of(points)]
    return [fit for label, members in found if (fit := _fit(label, members, x, y, DEGREES[kind]))]


def _fit(label: str, points: Sequence[Point], x: str, y: str, degree: int) -> Fit | None:
    import numpy as np

    pairs = {p.at(x): p.shown(y)[1] for p in points if isinstance(p.at(x), (int, float)) and p.shown(y)[1] is not None}
    if len(pairs) <= degree + 1:
        return None
    xs, ys = np.array(list(pairs), dtype=float), np.array(list(pairs.values()))
    coefficients = np.polynomial.Polynomial.fit(xs, ys, degree).convert().coef
    coefficients = tuple(float(f"{c:.7g}") for c in coefficients) + (0.0,) * (degree + 1 - len(coefficients))
    spread = float(((ys - ys.mean()) ** 2).sum())
    missed = float(((ys - sum(c * xs**i for i, c in enumerate(coefficients))) ** 2).sum())
    return Fit(label, points[0].method, coefficients, 1 - missed / spread if spread else 1.0,
               (float(xs.min()), float(xs.max())))


def draw_fit(axes: Axes, fits: Sequence[Fit], log_x: bool) -> None:
    """Each curve as a thin line in its method's colour, its equation in the upper left corner."""
    for place, fit in enumerate(fits):
        first, last = fit.xs
        steps = [i / STEPS for i in range(STEPS + 1)]
        xs = [first * (last / first) ** s if log_x and first > 0 else first + s * (last - first) for s in steps]
        axes.plot(xs, [fit.at(x) for x in xs], color=style.method_colour(fit.method), linewidth=0.7, alpha=0.8,
                  linestyle=(0, (1, 1)), zorder=1.5)
        axes.annotate(fit.text, (0.015, CORNER), (0, -place * LINE_PT), xycoords="axes fraction", ha="left", va="top",
                      textcoords="offset points", fontsize=style.NUMBER_PT, color=style.INK,
                      bbox={"boxstyle": "square,pad=0.1", "facecolor": "white", "edgecolor": "none", "alpha": 0.75})


def room_for(axes: Axes, equations: int) -> None:
    """Raise the top of the y axis, linear or logarithmic, so that equations in the corner cover no data."""
    height_pt = axes.get_position().height * axes.figure.get_figheight() * POINTS_PER_INCH
    share = min(MOST_ROOM, 1 - CORNER + equations * LINE_PT / height_pt)
    to_even, back = axes.yaxis.get_transform(), axes.yaxis.get_transform().inverted()
    low, high = to_even.transform(list(axes.get_ylim()))
    axes.set_ylim(top=float(back.transform([low + (high - low) / (1 - share)])[0]))
