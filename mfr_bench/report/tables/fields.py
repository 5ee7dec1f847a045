"""The fields of a table for a point: its time, ratios of it, its memory."""

from __future__ import annotations

from ...methods import FLOOR
from .. import data
from ..data import Point, number

ALIKE = "≈"  # before a ratio of times that noise alone may make
TIME_NOTE = ("median of whole frames, ± half of its 95 % interval; ~ stopped before the target interval; "
             "±? fewer than 6 samples")
RATIO_NOTE = ("time / time of the same geometry with plain blending, ± half of its 95 % interval; "
              "≈ r [low, high]: not told from 1, which the interval or the noise floor holds; "
              "of frames drawn in turns: it may differ from the quotient of the medians")
FASTEST_NOTE = ("of the methods that show every fragment: time / the fastest's, ± half of its 95 % interval; "
                "≈ r [low, high]: not told from the fastest's, for the interval or the noise floor holds 1; "
                "of frames drawn in turns: it may differ from the quotient of the medians")
ITSELF = 1.0, 1.0, 1.0  # the ratio of a time to itself
NOISY = "noisy"  # instead of half an interval that is wider than the value itself
NOISY_NOTE = ("noisy: uncertain by more than the value itself, as other work on the machine makes it; measured again "
              "by run --force while the machine does nothing else")
MEMORY_NOTE = "measured / by the paper's formula"


def noise_text(noise: float) -> str:
    """A noise floor in percent; of one above 1000 % no digits, which tell nothing of it."""
    return "above 1000 %" if noise > 10 else data.percent(noise)


def spread(interval: data.Interval) -> str:
    """Half of an interval in percent of its middle; NOISY where that tells nothing of the value."""
    low, middle, high = interval
    if low is None or high is None or not middle:
        return "±?"
    percent = 100 * max(high - middle, middle - low) / middle
    if percent > 100:
        return NOISY
    return f"±{percent:.1f} %" if percent < 9.95 else f"±{percent:.0f} %"


def time_field(point: Point) -> str:
    if point.status != "ok" or point.row["time_ms"] is None:
        return point.sign if point.status != "ok" else ""
    return f"{number(point.row['time_ms'])} {spread(point.time_ms)}{' ~' if point.row['noisy'] else ''}"


def ratio_field(point: Point) -> str:
    ratio = point.floor_ratio[1]
    if point.status != "ok" or ratio is None:
        return point.sign if point.status != "ok" else ""
    return ratio_text(point, point.floor_ratio)


def ratio_text(point: Point, ratio: data.Interval) -> str:
    """A ratio of times; one that noise alone may cause counts as 1, and shows its interval."""
    if ratio == ITSELF:
        return "1"
    if None in ratio or point.apart(ratio) or point.method == FLOOR:
        return f"{number(ratio[1])} {spread(ratio)}"
    low, middle, high = map(number, ratio)
    return f"{ALIKE} {middle} [{low}, {high}]"


def ratio_to_fastest(point: Point, fastest: Point) -> str:
    """Ratio of the time to that of the fastest method."""
    return "fastest" if point is fastest else ratio_text(point, point.over(fastest))


def memory_field(point: Point) -> str:
    measured, model = (point.measure(name)[1] for name in ("memory_mib", "memory_model_mib"))
    if measured is None:
        return point.sign if point.status != "ok" else ""
    return f"{number(measured)} / {number(model)}" if model is not None else number(measured)
