"""Time left of a run while it goes on: the forecast of the cells to come, learned anew from those that are done. Pure.

Every cell that is done becomes a record of the forecast, so that a method's larger scenes are foretold by its smaller
ones. What the forecast errs by on the whole is taken from the run so far: apart for frames that records foretell, for
frames that the calibration alone foretells, and for what surrounds frames.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from ..methods.spec import SceneStats
from .cells import Cell
from .expected import expected_stats
from .forecast import CALIBRATED, Forecast, frames_s

TRUST = 0.2  # share of all that is foretold that counts as if it had come true, for each kind
SAMPLED = 0.7  # of what a cell's frames take; then passes are timed, and the last image is checked
RECORDED, GUESSED, AROUND = "recorded", "guessed", "around"
Seconds = dict[str, float]  # by kind: frames that records foretell, frames that only the calibration does, all else


@dataclass
class TimeLeft:
    """The time that a run's cells have taken and will take. `elapsed_s` of every call counts from the same moment on.

    cells: those that are to be measured, by key. end_s: what follows the last of them.
    """

    forecast: Forecast
    cells: Mapping[str, Cell]
    end_s: float = 0.0
    _spent: Seconds = field(default_factory=lambda: dict.fromkeys((RECORDED, GUESSED, AROUND), 0.0))
    _foretold: Seconds = field(default_factory=lambda: dict.fromkeys((RECORDED, GUESSED, AROUND), 0.0))
    _shares: Mapping[str, float] = field(default_factory=dict)
    _last_s: float = 0.0

    def __post_init__(self) -> None:
        self._stats = {cell.scene: expected_stats(cell.scene) for cell in self.cells.values()}
        self._left = {key: self._predicted(cell) for key, cell in self.cells.items()}
        self._first_s = {key: sum(seconds.values()) for key, seconds in self._left.items()}
        self._trust_s = TRUST * sum(self._first_s.values())

    def _predicted(self, cell: Cell) -> Seconds:
        stats: SceneStats = self._stats[cell.scene]
        frame = self.forecast.frame(cell, stats)
        return {GUESSED if frame.source == CALIBRATED else RECORDED: frames_s(frame, cell.measure),
                AROUND: self.forecast.rates.around_s(stats)}

    def hold(self, shares: Mapping[str, float], elapsed_s: float) -> None:
        """Take in which cells are prepared, each with the fraction of the most frames or time that it may take."""
        self._spend(elapsed_s, any(share > self._shares.get(key, 0.0) for key, share in shares.items()))
        self._shares = dict(shares)

    def done(self, key: str, row: Mapping[str, Any], elapsed_s: float) -> None:
        """Take in a cell's row."""
        self._spend(elapsed_s, key in self._shares)
        if key not in self._left:
            return
        cell, first = self.cells[key], self._left.pop(key)
        self.forecast.learn(row)
        for kind, seconds in first.items():
            self._foretold[kind] += seconds
        self._shares = {held: share for held, share in self._shares.items() if held != key}
        for other in self._left.keys() - self._shares.keys():
            if self.cells[other].method == cell.method:
                self._left[other] = self._predicted(self.cells[other])

    def _spend(self, elapsed_s: float, on_frames: bool) -> None:
        """The time since the last event went to the frames of the cells in hand, or to what surrounds frames."""
        passed_s, self._last_s = max(0.0, elapsed_s - self._last_s), elapsed_s
        held = [self._left[key] for key in self._shares if key in self._left]
        weights = {kind: sum(seconds.get(kind, 0.0) for seconds in held) for kind in (RECORDED, GUESSED)}
        if not on_frames or not any(weights.values()):
            weights = {AROUND: 1.0}
        for kind, weight in weights.items():
            self._spent[kind] += passed_s * weight / sum(weights.values())

    def left_s(self, elapsed_s: float) -> float:
        """Seconds until the run has ended."""
        held = [(self._left[key], share) for key, share in self._shares.items() if key in self._left]
        waiting = [seconds for key, seconds in self._left.items() if key not in self._shares]
        left_s = 0.0
        for kind in self._spent:
            of_held = [(seconds.get(kind, 0.0), 1.0 if kind == AROUND else SAMPLED * share) for seconds, share in held]
            to_come_s = (sum(seconds.get(kind, 0.0) for seconds in waiting)
                         + sum(seconds * (1 - share) for seconds, share in of_held))
            passed_s = self._foretold[kind] + sum(seconds * share for seconds, share in of_held)
            if to_come_s:
                left_s += to_come_s * (self._spent[kind] + self._trust_s) / (passed_s + self._trust_s)
        return max(0.0, left_s - max(0.0, elapsed_s - self._last_s)) + self.end_s

    @property
    def share(self) -> float:
        """The share of the time forecast at the start that is over, by the cells that are done."""
        whole_s = sum(self._first_s.values())
        return 1 - sum(self._first_s[key] for key in self._left) / whole_s if whole_s else 1.0
