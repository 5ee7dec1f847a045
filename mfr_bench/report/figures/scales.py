"""Axes: logarithmic scales with plain numbers, labels at the figure's edge."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from .. import style
from ..data import plain
from .series import Options
from .sheet import EDGE, fitted

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def log_axis(axes: Axes, which: str, base: int) -> None:
    """A logarithmic axis whose ticks are plain numbers: 8, 16, 32."""
    from matplotlib.ticker import FuncFormatter, LogLocator, NullLocator

    axis = getattr(axes, f"{which}axis")
    getattr(axes, f"set_{which}scale")("log", base=base)
    axis.set_major_locator(LogLocator(base=base, numticks=12))
    axis.set_major_formatter(FuncFormatter(lambda v, _: f"{v:,.10g}" if 1 <= v < 1e8 else f"{v:.3g}"))
    axis.set_minor_locator(NullLocator())
    low, high = getattr(axes, f"get_{which}lim")()
    if base == 10 and (high / low < 40 or _powers_of_ten(low, high) < 2):  # one tick gives no scale: 1, 2, 5, 10
        axis.set_major_locator(LogLocator(base=10, subs=(1, 2, 5), numticks=12))


def tick(value: Any) -> str:
    """A coordinate as the text of a tick, as those of a logarithmic axis: 24,500."""
    return f"{value:,}" if type(value) is int else plain(value)


def _powers_of_ten(low: float, high: float) -> int:
    """The powers of ten from low to high, both positive."""
    return math.floor(math.log10(high) + 1e-9) - math.ceil(math.log10(low) - 1e-9) + 1


def y_label(axes: Axes, text: str) -> None:
    """The label at the figure's left edge, whatever the width of the tick labels."""
    from matplotlib.transforms import blended_transform_factory

    width, height = axes.figure.get_size_inches()
    axes.set_ylabel("\n".join(fitted(text, style.RC["axes.labelsize"], axes.get_position().height * height + 2 * EDGE)),
                    va="top", linespacing=1.0)
    axes.yaxis.set_label_coords(EDGE / width, 0.5, blended_transform_factory(axes.figure.transFigure, axes.transAxes))


def log_axes(options: Options) -> str:
    return str(options.get("log") or "")


def log_base(options: Options) -> int:
    return int(options.get("log_base") or 10)
