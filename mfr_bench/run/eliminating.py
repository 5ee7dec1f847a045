"""The cells of a scene in rounds of one frame each, in which the clearly slower leave early (measure.eliminate)."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence

from ..measure.elimination import Dropped, Elimination
from .cell import CellWork

WARM_UP = 2  # frames before the first round
TIME_IS_UP = "time limit"  # why rounds ended before they told enough
NEWS_ROUNDS = 8  # after so many rounds the samples are emitted, so that a killed run loses no more

Step = Callable[[CellWork], None]


class Rounds:
    """Rounds among the cells that take part; `apart` has the others, which are sampled as usual.

    A cell takes part if it promises an image, and if its error is within measure.max_error where there is one.
    guarded: runs a step of a cell, whose failure costs that cell alone. news: called when events should be kept.
    deadline: of the rounds, on the monotonic clock.
    """

    def __init__(self, running: Sequence[CellWork], guarded: Callable[[CellWork, Step], None],
                 shuffle: Callable[[list], None], news: Callable[[], None], deadline: float):
        self._guarded, self._shuffle, self._news, self._deadline = guarded, shuffle, news, deadline
        self._measure = running[0].job.cell.measure
        self._cells = {cell.job.key: cell for cell in running if cell.images.promised and not self._too_wrong(cell)}
        self._wrong = [cell for cell in running if cell.images.promised and self._too_wrong(cell)]
        self.apart = [cell for cell in running if not cell.images.promised]

    def _too_wrong(self, cell: CellWork) -> bool:
        bound = self._measure.max_error
        return bound is not None and cell.images.quality["max_error_all"] > bound

    def _may_drop(self, faster: str, slower: str) -> bool:
        """Tell whether the slower cell may go: under a bound on the error, or if its error and memory are no better."""
        if self._measure.max_error is not None:
            return True
        one, other = self._cells[faster], self._cells[slower]
        return one.images.quality["rmse"] <= other.images.quality["rmse"] and one.memory_bytes <= other.memory_bytes

    def run(self, finish: Step) -> None:
        """Draw rounds until one method is left, all that are left are as good, or time or frames run out."""
        for cell in self._wrong:
            self._guarded(cell, lambda c: c.warm_up(1))
            self._guarded(cell, lambda c: c.round())
            self._leave(cell, f"error above measure.max_error ({self._measure.max_error:.3g})", finish)
        if not self._cells:
            return
        elimination = Elimination(list(self._cells), self._may_drop)
        self._warm_up()
        self._drop_failed(elimination)
        reason = self._rounds(elimination, finish)
        end = self._leave if reason == TIME_IS_UP else self._end
        for key in sorted(elimination.left, key=elimination.time_ms):  # the fastest first, where the time is short
            end(self._cells[key], reason, finish)

    def _warm_up(self) -> None:
        """Draw frames that count for nothing, as long as the time leaves room for a round of those that count."""
        begun = time.monotonic()
        for drawn, cell in enumerate(WARM_UP * list(self._cells.values())):
            now = time.monotonic()
            if drawn and now + (now - begun) / drawn * len(self._cells) >= self._deadline:
                return
            self._guarded(cell, lambda c: c.warm_up(1))

    def _rounds(self, elimination: Elimination, finish: Step) -> str:
        """Draw the rounds, one at least, and return why they ended."""
        last_s = 0.0  # of the round before: one that would end late is not begun
        while elimination.left and not elimination.decided:
            if len(elimination.rounds) >= self._measure.max_samples:
                return "most samples"
            begun = time.monotonic()
            if elimination.rounds and begun + last_s >= self._deadline:
                return TIME_IS_UP
            times_ms = self._round(elimination)
            last_s = time.monotonic() - begun
            self._drop_failed(elimination)
            if elimination.left:
                for gone in elimination.add({key: times_ms[key] for key in elimination.left}):
                    self._leave(self._cells[gone.method], self._words(gone), finish)
            if len(elimination.rounds) % NEWS_ROUNDS == 0:
                self._tell(elimination)
        return "precise"

    def _round(self, elimination: Elimination) -> dict[str, float]:
        order, times_ms = list(elimination.left), {}
        self._shuffle(order)
        for key in order:
            self._guarded(self._cells[key], lambda c, key=key: times_ms.__setitem__(key, c.round()))
        return times_ms

    def _drop_failed(self, elimination: Elimination) -> None:
        for key in [key for key in elimination.left if self._cells[key].done]:
            elimination.remove(key)

    def _tell(self, elimination: Elimination) -> None:
        for key in elimination.left:
            self._cells[key].emit_samples()
        self._news()

    def _words(self, gone: Dropped) -> str:
        winner = self._cells[gone.to].job.cell.label
        return f"eliminated after {gone.after_round} frames: {gone.ratio:.3g} times the time of {winner}"

    def _leave(self, cell: CellWork, reason: str, finish: Step) -> None:
        """End a cell early: its passes are not timed."""
        cell.pass_frames = 0
        self._end(cell, reason, finish)

    def _end(self, cell: CellWork, reason: str, finish: Step) -> None:
        cell.sampler.stop_reason = reason
        self._guarded(cell, finish)
