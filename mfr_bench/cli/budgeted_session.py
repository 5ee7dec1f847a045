"""The sessions of `decide`: they write their results as far as the time budget allows, and print none."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from typing import Any

from ..decide.budget import Budget
from ..plan.ending import SAFE, reports_s
from ..plan.forecast import Rates
from ..store import ResultFolder
from .interruption import Interruption
from .progress import PULSE_S, Progress
from .session import Choices, Part, Session
from .time_budget import left_out


class BudgetedSession(Session):
    """A session of one experiment that ends within a budget.

    folder: that of its results. late: by label, the cells that have no row. cut: what else the budget left out, in
    words.
    """

    folder: ResultFolder
    late: Mapping[str, int]

    def __init__(self, supervisor, interruption: Interruption, out: str | None, budget: Budget,
                 answer: Callable[[ResultFolder], Mapping[str, Any]] | None = None):
        """The session into `out`. answer: from the measured folder, for the manifest and so for its figures."""
        super().__init__(supervisor, interruption, Choices(out, False, False, False, quiet=True), time.perf_counter())
        self.budget, self.answer = budget, answer
        self.cut: list[str] = []

    def _deadlines(self, groups, parts: Sequence[Part]) -> tuple[float, float]:
        return self.budget.stop, self.budget.last

    def _progress(self, groups, parts: Sequence[Part], until: float) -> Progress:
        """Like that of a run, without a forecast: what imports and computes one would take time from the race."""
        return Progress(sum(map(len, groups)), "decide", self.interruption.asked, until=until, pulse_s=PULSE_S)

    def _at_the_end(self, parts: Sequence[Part]) -> None:
        if self.budget.room_for(Rates().start_s):
            super()._at_the_end(parts)
        elif parts:
            self.cut.append("the second calibration, which tells whether the machine was steady")

    def _tell(self, part: Part) -> None:
        self.folder, self.late = part.folder, left_out(part.sheet)
        part.manifest["left_out"] = self.late
        if self.answer:
            part.manifest["answer"] = self.answer(part.folder)
        if self.budget.room_for(SAFE * reports_s(1, len(part.experiment.figures), len(part.sheet.statuses))):
            self._report(part)
        else:
            part.folder.write_manifest(part.manifest)
            self.cut.append(f"tables and figures; mfr-bench plot {part.folder.path} draws them")


class CountingSession(BudgetedSession):
    """A session whose cell is read for what it counted in the scene; nothing else is written or told of it."""

    def _progress(self, groups, parts: Sequence[Part], until: float) -> Progress:
        return Progress(sum(map(len, groups)), "decide", self.interruption.asked, quiet=True)

    def _at_the_end(self, parts: Sequence[Part]) -> None:
        """Calibrate nothing."""

    def _tell(self, part: Part) -> None:
        self.folder = part.folder
