"""Predicts that a cell times out, from smaller cells that took too long."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from ..config.model import Measure
from ..scene.kinds import kind_of
from ..scene.spec.kind import mean_depth
from .cells import Cell

NOT_TRIED = "--try-hopeless measures it all the same"  # ends the reason of every cell that was not tried


@dataclass(frozen=True)
class CellOutcome:
    """The end of a cell: its status, its median frame and its fastest one, warm-up included, if it has any."""

    cell: Cell
    status: str
    time_ms: float | None
    fastest_ms: float | None = None

    @classmethod
    def of(cls, cell: Cell, row: Mapping[str, Any]) -> CellOutcome | None:
        """The outcome that a record shows; None if the cell was not tried, which shows nothing."""
        if str(row.get("reason") or "").endswith(NOT_TRIED):
            return None
        frames_ms = [*(row.get("warmup_ms") or ()), *(row.get("samples_ms") or ())]
        return cls(cell, row["status"], row["values"].get("time_ms"), min(frames_ms, default=None))

    def over_limit(self, measure: Measure) -> bool:
        """Whether even its fastest frame takes longer than all frames may by these settings; a stall proves nothing."""
        if self.time_ms is not None:
            fastest_ms = self.time_ms if self.fastest_ms is None else min(self.time_ms, self.fastest_ms)
            return fastest_ms / 1e3 > measure.time_limit_s
        return self.status == "timeout" and self.cell.measure.longest_s >= measure.longest_s

    def within_limit(self, measure: Measure) -> bool:
        """Whether it was measured, and a frame takes no longer than all frames may by these settings."""
        return self.time_ms is not None and self.time_ms / 1e3 <= measure.time_limit_s

    def __str__(self) -> str:
        scene = self.cell.scene
        where = f"{scene.size[0]} x {scene.size[1]} pixels, n = {scene.depth_complexity}"
        where += f" (mean {mean_depth(scene):g})" if kind_of(scene).has_mean_depth(scene) else ""
        where += f", k = {self.cell.params['k']}" if "k" in self.cell.params else ""
        took = "timed out" if self.time_ms is None else f"took {self.time_ms / 1e3:.3g} s a frame"
        return f"{self.cell.label} at {where} {took}"


GROWING = ("pixel_density", "depth_complexity", "fragment_probability")  # more of it is more work


def predicted_timeout(cell: Cell, known: Iterable[CellOutcome]) -> str | None:
    """The reason why a cell cannot be measured within its limits: a smaller one that could not. None without one.

    A smaller one shows nothing if a cell of no less work than it was measured within the limits.
    """
    known = list(known)
    smaller = [k for k in known if k.over_limit(cell.measure) and _no_smaller(cell, k.cell)]
    smaller = [k for k in smaller if not any(_no_smaller(other.cell, k.cell) for other in known
                                             if other.within_limit(cell.measure))]
    found = min(smaller, key=lambda k: k.time_ms is None, default=None)
    return None if found is None else (f"{found}, where time_limit_s allows {cell.measure.time_limit_s:g} s for all "
                                       f"frames; {NOT_TRIED}")


def _no_smaller(cell: Cell, other: Cell) -> bool:
    """Whether a cell is at least the work of another one, and otherwise the same."""
    (kind, size), (other_kind, other_size) = _kind_and_size(cell), _kind_and_size(other)
    return kind == other_kind and all(a >= b for a, b in zip(size, other_size, strict=True))


def _kind_and_size(cell: Cell) -> tuple[tuple, tuple]:
    scene, params = cell.scene.as_dict(), dict(cell.params)
    scene["mean_depth"] = None
    mean = mean_depth(cell.scene) if kind_of(cell.scene).has_mean_depth(cell.scene) else 0
    k = 0 if cell.k_saves_passes else params.pop("k", 0)
    size = (*scene.pop("size"), *(scene.pop(name, 0) for name in GROWING), mean, k)
    return (cell.method, repr(sorted(params.items())), repr(sorted(scene.items()))), size
