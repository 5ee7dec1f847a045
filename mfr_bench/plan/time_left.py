"""Time left of a run while it goes on: the forecast of the cells to come, learned anew from what the run shows. Pure.

Every cell with samples becomes a record of the forecast, so that a method's larger scenes are foretold by its smaller
ones while these are still being measured. Frames that the calibration alone foretells are corrected by how far it was
off for the frames that were sampled. The time limit bounds frames however slow they are, so both are put into the
sampling rules, not behind them. What is left of the error is a factor for each kind of work, taken from the run so far:
programs that this run compiles first, programs that it has compiled before, and frames. Until a kind of work has shown
its factor, that of programs is as much larger as the start of the process took longer than on a quiet machine, and that
of frames follows what all work has shown. What follows the last cell is no part of that: it is given.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from statistics import median
from typing import Any

from .cells import Cell
from .expected import expected_stats
from .forecast import ALIKE, CALIBRATED, Forecast, FrameTime, Record
from .in_hand import InHand, parts_s

NEW, AGAIN, FRAMES = "new", "again", "frames"  # kinds of work
Seconds = dict[str, float]  # by kind
USUAL = {NEW: 0.45, AGAIN: 0.1, FRAMES: 1.2}  # what each takes over what is foretold, before a run has shown anything
TRUST = {NEW: 0.02, AGAIN: 0.02, FRAMES: 1.0}  # share of all that is foretold for which each counts as usual
COUPLED = 0.4  # power to which the factor of all work raises what is usual of frames
COUPLED_TRUST = 0.09  # share of all that is foretold for which that factor counts as 1
GUESS, GUESSES = 0.9, 1  # what a frame takes over its guess by calibration, as if so many had been sampled
KEPT = 0.05  # of the time to compile a program: the driver has it already
COUNTED = 0.3  # times to compile a program: the one that counts its fragments in the end
COUNTERS = 2.5  # times to compile a program: those that count the work of a frame are programs of their own
PREPARING = ("scene", "compile", "first frame")  # phases of events.Begun; a check before the first sample is another
COMPILE, SAMPLING, WAIT = "compile", "sampling", "wait"
REFRESH_S, REFRESH = 1.0, 0.05  # a forecast stands for so long, or for this share of what it says, if that is less


@dataclass
class TimeLeft:
    """The time that a run's cells have taken and will take. `elapsed_s` of every call counts from the same moment on.

    cells: those that are to be measured, by key. programs: the digest of the GLSL of each. end_s: what follows the last
    of them. slowness: how many times as long as on a quiet machine the start of the process took.
    looks_s: reference frames of a cell.
    """

    forecast: Forecast
    cells: Mapping[str, Cell]
    programs: Mapping[str, str]
    end_s: float = 0.0
    slowness: float = 1.0
    looks_s: float = 0.0
    _spent: Seconds = field(default_factory=lambda: dict.fromkeys(USUAL, 0.0))
    _foretold: Seconds = field(default_factory=lambda: dict.fromkeys(USUAL, 0.0))  # of what is over
    _compiled: set[str] = field(default_factory=set)  # digests
    _counted: set[str] = field(default_factory=set)  # those of which a cell is done
    _hands: dict[str, InHand] = field(default_factory=dict)  # cells that are prepared, also when they are done
    _now: str | None = None  # the kind of work that goes on
    _last_s: float = 0.0  # when the last event came
    _said: tuple[float, float] | None = None  # the last forecast, and when it was made

    def __post_init__(self) -> None:
        self._stats = {key: expected_stats(cell.scene) for key, cell in self.cells.items()}
        self._known = {key: self.forecast.known(cell) for key, cell in self.cells.items()}
        self._left = dict.fromkeys(self.cells)
        self._first_s = {key: self._prepare_s(key, NEW) + sum(parts_s(self._frame(key), cell.measure)) + self.looks_s
                         for key, cell in self.cells.items()}
        self._whole_s = sum(self._first_s.values())

    # --- what the run shows ----------------------------------------------------------------------

    def began(self, key: str | None, phase: str, elapsed_s: float) -> None:
        """Take in that a phase of a cell begins; key None: of all cells of a scene."""
        self._pass(elapsed_s)
        if phase == COMPILE and key in self.cells:
            self._now = self._kind(key, self._compiled)
            self._foretold[self._now] += self._prepare_s(key, self._now)
            self._compiled.add(self.programs[key])
            self._hands[key] = InHand()
        elif phase == WAIT:  # for a quiet machine: nothing tells how long, or of any work
            self._now = None
        elif phase == SAMPLING or (phase not in PREPARING and key in self._hands and self._hands[key].samples_ms):
            self._now = FRAMES
        elif self._now is None or phase == PREPARING[0]:
            self._now = NEW

    def sampled(self, key: str, samples_ms: Sequence[float]) -> None:
        """Take in samples of a cell, in ms."""
        if key in self.cells:
            self._hands.setdefault(key, InHand()).samples_ms += samples_ms

    def samples_ms(self, key: str) -> list[float]:
        """The samples of a cell so far."""
        return self._hands[key].samples_ms if key in self._hands else []

    def done(self, key: str, row: Mapping[str, Any], elapsed_s: float) -> None:
        """Take in a cell's row."""
        self._pass(elapsed_s)
        if key not in self._left:
            return
        del self._left[key]
        self._counted.add(self.programs[key])
        self._said = None
        if hand := self._hands.get(key):
            self._foretold[FRAMES] += self.looks_s + hand.seconds(
                self._frame(key), self.cells[key].measure, done=True)[0]
        self.forecast.learn(row)

    def _pass(self, elapsed_s: float) -> None:
        """The time since the last event went to the work that goes on."""
        passed_s, self._last_s = max(0.0, elapsed_s - self._last_s), elapsed_s
        if self._now:
            self._spent[self._now] += passed_s

    # --- what is foretold ------------------------------------------------------------------------

    def left_s(self, elapsed_s: float) -> float:
        """Seconds until the run has ended. A forecast stands for a second at most, in which the time left runs down."""
        if self._said is None or not 0 <= elapsed_s - self._said[1] < min(REFRESH_S, REFRESH * self._said[0]):
            self._said = self._forecast_s(), elapsed_s
        said_s, at_s = self._said
        return max(0.0, said_s - (elapsed_s - min(at_s, self._last_s))) + self.end_s

    def _forecast_s(self) -> float:
        """Seconds from the last event until the last cell is done."""
        guess, alike = self._guess, self._alike
        over, to_come = dict(self._foretold), dict.fromkeys(USUAL, 0.0)
        compiled = set(self._compiled)
        to_come[NEW] = COUNTED * self.forecast.rates.compile_s * len(
            {self.programs[key] for key in self._left} - self._counted)
        for key in self._left:
            frame = self._frame(key, guess, alike)
            to_come[NEW] += self._count_s(key)
            if hand := self._hands.get(key):
                over_s, to_come_s = hand.seconds(frame, self.cells[key].measure)
                looked = over_s / (over_s + to_come_s) if over_s else 0.0
                over[FRAMES] += over_s + looked * self.looks_s
                to_come[FRAMES] += to_come_s + (1 - looked) * self.looks_s
                continue
            kind = self._kind(key, compiled)
            compiled.add(self.programs[key])
            to_come[kind] += self._prepare_s(key, kind)
            to_come[FRAMES] += self.looks_s + sum(parts_s(frame, self.cells[key].measure))
        return sum(seconds * self._factor(kind, over) for kind, seconds in to_come.items())

    def _factor(self, kind: str, over: Seconds) -> float:
        """What work of a kind takes over what is foretold: as the run has shown, or else as usual."""
        if not self._whole_s:
            return 1.0
        trust_s, few_s = TRUST[kind] * self._whole_s, COUPLED_TRUST * self._whole_s
        of_all = (sum(self._spent.values()) + few_s) / (sum(over.values()) + few_s)
        usual = USUAL[kind] * (of_all ** COUPLED if kind == FRAMES else self.slowness)
        return (self._spent[kind] + trust_s * usual) / (over[kind] + trust_s)

    def _kind(self, key: str, compiled: set[str]) -> str:
        return AGAIN if self.programs[key] in compiled else NEW

    def _prepare_s(self, key: str, kind: str) -> float:
        rates = self.forecast.rates
        return rates.around_s(self._stats[key]) - (0.0 if kind == NEW else (1 - KEPT) * rates.compile_s)

    def _count_s(self, key: str) -> float:
        return COUNTERS * self.forecast.rates.compile_s if self.cells[key].measure.counters else 0.0

    def _frame(self, key: str, guess: float = GUESS, alike: Mapping[str, list[Record]] | None = None) -> FrameTime:
        """The time of a cell's frame without its own samples. guess: what frames take over their guess."""
        method, stats = self.cells[key].method, self._stats[key]
        frame = self._known[key] or self.forecast.unknown(method, stats, (alike or {}).get(method, ()))
        return replace(frame, time_ms=guess * frame.time_ms) if frame.source == CALIBRATED else frame

    @property
    def _alike(self) -> dict[str, list[Record]]:
        """Records of the cells in hand that have samples, by method."""
        found: dict[str, list[Record]] = {}
        for key, hand in self._hands.items():
            if hand.samples_ms and key in self._left:
                frame = replace(hand.frame(self.forecast.guess(self._stats[key])), source=ALIKE)
                found.setdefault(self.cells[key].method, []).append(Record(self._stats[key].F, frame))
        return found

    @property
    def _guess(self) -> float:
        """What frames take over their guess by calibration: in the mean of those that were sampled, and of GUESS."""
        ratios = [median(hand.samples_ms) / self.forecast.guess(self._stats[key]).time_ms
                  for key, hand in self._hands.items() if hand.samples_ms]
        return (sum(ratios) + GUESSES * GUESS) / (len(ratios) + GUESSES)

    @property
    def share(self) -> float:
        """The share of the time forecast at the start that is over, by the cells that are done."""
        return 1 - sum(self._first_s[key] for key in self._left) / self._whole_s if self._whole_s else 1.0
