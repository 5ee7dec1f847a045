"""A cell as tables and figures see it: a labelled point with coordinates and measures."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

from ...environment import MIB
from ...methods import FLOOR
from ...stats import (
    Interval,
    interleaved_ratio,
    median_interval,
    ratio_interval,
    ratio_of_all_turns,
    real,
    sampled_interval,
)
from ...store import Cell, ResultFolder, Row
from ...store.arrays import read_arrays
from ...store.status import EXACT_ERROR, STATUSES, Status
from .measures import NOTHING
from .words import bare

# A measure, and the power of the memory that it is multiplied by.
BY_MEMORY = {"ms_per_mib": ("time_ms", -1), "ms_times_mib": ("time_ms", 1), "fps_per_mib": ("fps", -1)}


LOSES_TIES = "of fragments of equal depth it keeps one"


@dataclass(frozen=True)
class Point:
    """One cell. `label` names its series and is unique to its method and fixed parameters."""

    cell: Cell
    row: Row
    label: str
    floor: Cell | None
    parameters: frozenset[str]  # parameter names of any cell of the folder
    drawn: Interval | None = None  # what a figure shows instead of the measure that its y names
    folder: ResultFolder | None = None
    noise: float = 0.0  # of its run: how far a method measured twice is from itself, relative
    known: dict[str, Any] = field(default_factory=dict, compare=False, repr=False)  # see `_once`

    @property
    def method(self) -> str:
        return self.cell["method"]

    @property
    def status(self) -> str:
        return self.cell["status"]

    @property
    def ending(self) -> Status:
        """The entry of the point's status in the table of statuses."""
        return STATUSES[self.status]

    @property
    def sign(self) -> str:
        """The status in words."""
        return self.ending.sign

    def _once(self, name: str, found: Callable[[], Any]) -> Any:
        """What `found` gives, asked once for the point and its copies of other labels, which share `known`."""
        if name not in self.known:
            self.known[name] = found()
        return self.known[name]

    def at(self, name: str) -> Any:
        """Coordinate of the point along a swept key or column; None where its method has no such parameter.

        Of a parameter and a key of the scene that share their name the latter is meant by a dotted one: scene.opaque.
        """
        where = f"at {name}"
        if where not in self.known:
            self.known[where] = self._at(name)
        return self.known[where]

    def _at(self, name: str) -> Any:
        if name in self.cell["point"] and "." in name and bare(name) != "alpha":
            return _hashable(self.cell["point"][name])
        of_scene, name = name.startswith("scene."), bare(name)
        if name in self.cell["params"] and not (of_scene and name in self.cell["scene"]):
            return self.cell["params"][name]
        if name in self.cell["scene"]:
            value = _hashable(self.cell["scene"][name])
            return value[0] if name == "alpha" and isinstance(value, tuple) and len(set(value)) == 1 else value
        if name in self.row:
            return self.row[name]
        return None if name in self.parameters else _hashable(self.cell["point"].get(name))

    @cached_property
    def time_ms(self) -> Interval:
        return self.row["time_ms_low"], self.row["time_ms"], self.row["time_ms_high"]

    @property
    def floor_ratio(self) -> Interval:
        """Ratio of the time to that of the floor."""
        if self.floor is None or self.row["time_ms"] is None:
            return None, None, None
        return self._once("floor_ratio", lambda: time_ratio(self.cell, self.floor))

    def over(self, other: Point) -> Interval:
        """Ratio of the time to that of another point of the run."""
        return time_ratio(self.cell, other.cell)

    def apart(self, ratio: Interval) -> bool:
        """Whether a ratio of times tells it from another point of its run: beyond its interval and the noise floor."""
        return real(ratio, self.noise)

    @property
    def shows_all(self) -> bool:
        """Whether the point was measured with a right image in which every fragment shows."""
        rmse = self.row["rmse"]
        return self.status == "ok" and self.row["time_ms"] is not None and rmse is not None and rmse <= EXACT_ERROR

    @property
    def passes_ms(self) -> dict[str, Interval]:
        """Interval of each timed pass, in the order of the frame."""
        timed = self.cell.get("passes") or {}
        return self._once("passes_ms", lambda: {name: median_interval(samples) for name, samples in timed.items()
                                                if samples})

    def pass_ms(self, names: Iterable[str]) -> Interval:
        """Interval of the first of these passes that the method has."""
        return next((self.passes_ms[name] for name in names if name in self.passes_ms), NOTHING)

    def shown(self, name: str) -> Interval:
        """The value and interval that a figure of the measure shows."""
        return self.measure(name) if self.drawn is None else self.drawn

    @cached_property
    def arrays(self) -> dict[str, Any]:
        """The arrays that the cell kept, by name."""
        return read_arrays(self.folder, self.cell["key"]) if self.folder else {}

    def measure(self, name: str) -> Interval:
        """A measure (see MEASURES) between the ends of its interval, which are None where it has none."""
        if name in ("time_ms", "floor_ratio"):
            return getattr(self, name)
        if name == "fps":
            low, middle, high = self.time_ms
            return tuple(1000 / t if t else None for t in (high, middle, low))
        if name in BY_MEMORY:
            of, power = BY_MEMORY[name]
            memory = self.row["memory_bytes"]
            return tuple(v * (memory / MIB) ** power if v is not None and memory else None for v in self.measure(of))
        return None, self._counted(name), None

    def _counted(self, name: str) -> float | None:
        """A measure that is counted, not timed."""
        if name in ("memory_mib", "memory_model_mib"):
            value = self.row[name.replace("mib", "bytes")]
            return None if value is None else value / MIB
        if name == "words_per_pixel":
            value = self.row["memory_bytes"]
            pixels = self.row["width"] * self.row["height"]
            return None if value is None or not pixels else value / 4 / pixels
        if name == "tied_share":
            tied, covered = self.row["tied_pixels"], self.row["covered_pixels"]
            return None if tied is None or not covered else tied / covered
        if name == "culled_of_unkept":
            return self._culled_of_unkept()
        if name == "share":
            return 1.0 if self.passes_ms else None
        return self.row[name]

    def _culled_of_unkept(self) -> float | None:
        """Share of the fragments not kept that are refused before they ask for the lock."""
        culled, kept = self.row["culled_share"], self.row["hit_ratio"]
        return None if culled is None or kept is None or kept >= 1 else culled / (1 - kept)

    @property
    def exact(self) -> bool | None:
        """Whether the image is the promised one; None where no image was checked."""
        error = self.row["max_abs_error"]
        return None if error is None else error <= EXACT_ERROR and self.ending.image != "wrong"

    @property
    def loses_ties(self) -> bool:
        """Whether the image is the promised one but where fragments of one depth meet, of which the method loses some.
        """
        return bool(self.exact) and (self.row["tied_error"] or 0.0) > EXACT_ERROR


def time_ratio(over: Cell, under: Cell, confidence: float = 0.95) -> Interval:
    """The frame time of one cell over that of another; from raw samples, so that the interval keeps its confidence.

    Cells of one scene and settings were sampled in turns: what slowed both down alike is left out of the interval, and
    so are samples without a counterpart. Where one stalled turn among few that remain hides what the intervals of both
    medians tell apart, the interval is that of all turns. A cell over itself is 1.
    """
    above, below = (cell.get("samples_ms") or [] for cell in (over, under))
    if over["key"] == under["key"] and above and above == below:
        return 1.0, 1.0, 1.0
    least, most = (over["measure"].get(name) for name in ("min_samples", "max_samples"))
    if not (all(over[name] == under[name] for name in ("scene", "measure")) and least and most):
        return ratio_interval(above, below, confidence)
    in_turns = interleaved_ratio(above, below, least, most, confidence)
    hidden = None not in in_turns and in_turns[0] <= 1 <= in_turns[2]
    if hidden and _disjoint(above, below, confidence):
        return ratio_of_all_turns(above, below, least, most, confidence)
    return in_turns


def _disjoint(first: Sequence[float], second: Sequence[float], confidence: float) -> bool:
    """Whether two medians have intervals that share nothing."""
    first_low, _, first_high = sampled_interval(first, confidence)
    second_low, _, second_high = sampled_interval(second, confidence)
    if None in (first_low, second_low):
        return False
    return first_low > second_high or second_low > first_high


def is_floor(point: Point) -> bool:
    return point.method == FLOOR


def _hashable(value: Any) -> Any:
    """A JSON value with tuples for lists, and for mappings the tuple of their members."""
    if isinstance(value, dict):
        return tuple((name, _hashable(member)) for name, member in value.items())
    return tuple(map(_hashable, value)) if isinstance(value, list) else value
