"""Rules about memory: bytes against a formula, and cells that run out of it."""

from __future__ import annotations

from dataclasses import dataclass

from ..methods.spec import SceneStats, evaluate
from ..report.data import Point
from ..stats import Interval
from .evidence import NOTHING, Bound, Evidence, Outcome
from .measures import column
from .picks import Pick, coordinates, is_number
from .rules import OfOnePick, compared
from .runs import Run


@dataclass(frozen=True)
class Memory:
    """Bytes allocated over those of a formula, taken with the cell's own pixels, n, f, k and f_k."""

    of: tuple[tuple[Pick, str], ...]  # cells, their formula per pixel over n, k, f (mean fragments), f_k (mean kept)
    bytes_each: int  # of what the formulas count
    unit: str
    bound: Bound

    @property
    def text(self) -> str:
        formulas = ", ".join(f"{cells.names} {formula}" for cells, formula in self.of)
        return f"memory / by formula, in {self.unit} per pixel: {formulas}: {self.bound.words}"

    @property
    def needs(self) -> str:
        return ", ".join(cells.names for cells, _ in self.of)

    @property
    def each(self) -> tuple[str, ...]:
        return tuple(method for cells, _ in self.of for method in cells.each)

    def compare(self, run: Run) -> list[Evidence]:
        return [compared(run, f"{p.method} / {formula}", (p,), lambda p=p, formula=formula: self._ratio(p, formula),
                          self.bound, exact=True)
                for cells, formula in self.of for p in run.points if cells.takes(p)]

    def _ratio(self, point: Point, formula: str) -> Interval:
        row = point.row
        wanted = ("width", "height", "max_fragments", "fragments", "memory_bytes", "hit_ratio")
        if any(row[name] is None for name in wanted):
            return NOTHING
        stats = SceneStats(row["width"], row["height"], max(1, row["max_fragments"]), row["fragments"], primitives=0)
        if not stats.P:
            return NOTHING
        known = {"f_k": row["hit_ratio"] * row["fragments"] / stats.P} if "f_k" in formula else {"k": row["k"]}
        if "k" in formula and not all(map(is_number, known.values())):
            return NOTHING
        expected = self.bytes_each * stats.P * evaluate(formula, stats, known if "k" in formula else {})
        return (row["memory_bytes"] / expected,) * 3 if expected else NOTHING


@dataclass(frozen=True)
class RunsOut(OfOnePick):
    """Cells that need more memory than they may have."""

    cells: Pick

    @property
    def text(self) -> str:
        return f"{self.cells.text}: over the memory budget, or out of memory"

    def compare(self, run: Run) -> list[Evidence]:
        return [self._compared(run, p) for p in run.points if self.cells.takes(p)]

    def _compared(self, run: Run, point: Point) -> Evidence:
        ending = point.ending
        outcome = (Outcome.HOLDS if ending.over_memory else Outcome.FAILS if ending.timed
                   else Outcome.LEFT_OUT if ending.refused else Outcome.UNCLEAR)
        used = column("memory_bytes")(point)
        reason = point.cell.get("reason") or (f"ran with {used / 2**20:.1f} MiB" if used is not None else "")
        return Evidence(f"{point.method} is {point.sign}", coordinates(point), NOTHING, outcome, reason, run.folder,
                          exact=True)
