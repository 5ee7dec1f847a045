"""Predicts that a cell times out, from smaller cells that took too long."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from ..config.settings import Measure
from ..scene.kinds import kind_of
from ..scene.spec.kind import mean_depth
from .cells import Cell

Kind, Size = tuple[str, str, str], tuple[float, ...]  # of a cell: what it is, and how much of it

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


class Outcomes:
    """How cells ended, by what they are apart from their size: a cell is held to those that it can be compared with."""

    def __init__(self, known: Iterable[CellOutcome] = ()):
        self._of_kind: dict[Kind, list[tuple[Size, CellOutcome]]] = defaultdict(list)
        for outcome in known:
            self.add(outcome)

    def add(self, outcome: CellOutcome) -> None:
        """Take in how a cell ended."""
        kind, size = _kind_and_size(outcome.cell)
        self._of_kind[kind].append((size, outcome))

    def predicted_timeout(self, cell: Cell) -> str | None:
        """The reason why a cell cannot be measured within its limits: a smaller one that could not. None without one.

        A smaller one shows nothing if a cell of no less work than it was measured within the limits.
        """
        if not self._of_kind:
            return None
        kind, size = _kind_and_size(cell)
        known = self._of_kind.get(kind, ())
        smaller = [(at, k) for at, k in known if k.over_limit(cell.measure) and _no_smaller(size, at)]
        within = [at for at, k in known if k.within_limit(cell.measure)] if smaller else []
        smaller = [k for at, k in smaller if not any(_no_smaller(other, at) for other in within)]
        found = min(smaller, key=lambda k: k.time_ms is None, default=None)
        return None if found is None else (f"{found}, where time_limit_s allows {cell.measure.time_limit_s:g} s for "
                                           f"all frames; {NOT_TRIED}")


def predicted_timeout(cell: Cell, known: Iterable[CellOutcome]) -> str | None:
    """The reason why a cell cannot be measured within its limits, by how these ended; see `Outcomes`."""
    return Outcomes(known).predicted_timeout(cell)


def _no_smaller(size: Size, other: Size) -> bool:
    """Whether a cell is at least the work of another one, which is otherwise the same."""
    return all(a >= b for a, b in zip(size, other, strict=True))


def _kind_and_size(cell: Cell) -> tuple[Kind, Size]:
    scene, params = cell.scene.as_dict(), dict(cell.params)
    scene["mean_depth"] = None
    mean = mean_depth(cell.scene) if kind_of(cell.scene).has_mean_depth(cell.scene) else 0
    k = 0 if cell.k_saves_passes else params.pop("k", 0)
    size = (*scene.pop("size"), *(scene.pop(name, 0) for name in GROWING), mean, k)
    return (cell.method, repr(sorted(params.items())), repr(sorted(scene.items()))), size
