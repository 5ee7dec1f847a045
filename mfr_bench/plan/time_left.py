"""Time left of a run while it goes on: the forecast of the cells to come, learned anew from what the run shows. Pure.

Every cell of which a frame was drawn becomes a record of the forecast, so that a method's larger scenes are foretold by
its smaller ones while these are still being measured. Frames that the calibration alone foretells are corrected by how
far it was off for the frames that were drawn. The time limit bounds frames however slow they are, so both are put into
the sampling rules, not behind them. What is left of the error is a factor for each kind of work, taken from the run so
far: programs, and frames. What both took together is told apart by the frames that are known. Until a kind of work has
shown its factor, that of programs is as much larger as the start of the process took longer than on a quiet machine,
and that of frames follows what all work has shown. What follows the last cell is no part of that: it is given.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from statistics import median
from typing import Any

from ..scene import Scene
from .cells import Cell
from .expected import expected_stats
from .forecast import ALIKE, CALIBRATED, FIRST_FRAMES, USUAL_CV, Forecast, FrameTime, Record, text_of
from .in_hand import InHand, parts_s

PROGRAMS, CHECKS, FRAMES = "programs", "checks", "frames"  # kinds of work
Seconds = dict[str, float]  # by kind
Code = Mapping[int, int]  # characters of programs, by their digests
# Chosen by recorded runs, see docs/measurement.md: of 164, replayed by scripts/time_left.py, 154 are foretold within a
# factor of 1.5 after a fifth of them. With half or twice of one of these numbers 145 to 155 are; with half or twice of
# what is usual of frames, the one that matters, 106 and 92.
USUAL = {PROGRAMS: 0.3, CHECKS: 0.05, FRAMES: 1.15}  # what each takes over what is foretold, before a run has shown it
TRUST = {PROGRAMS: 0.04, CHECKS: 0.04, FRAMES: 0.4}  # share of all that is foretold for which each counts as usual
COUPLED = 0.4  # power to which the factor of all work raises what is usual of frames
COUPLED_TRUST = 0.09  # share of all that is foretold for which that factor counts as 1
GUESS, GUESSES = 0.8, 1  # what a frame takes over its guess by calibration, as if so many had been drawn
USUAL_CODE = 12000  # characters of the programs that a cell compiles
COUNTERS = 2.5  # times as much code counts the work of a frame
CELL_S = 0.01  # to begin and end a cell, beside its frames

PREPARING = ("scene", "compile", "first frame")  # phases of events.Begun before the first sample
COMPILE, SAMPLING, CHECK, WAIT = "compile", "sampling", "check", "wait"
REFRESH_S, REFRESH = 1.0, 0.05  # a forecast stands for so long, or for this share of what it says, if that is less
CELL_REFRESH_S = 1e-3  # and for so long for each cell that is left: ten times what these take to be foretold


@dataclass
class TimeLeft:
    """The time that a run's cells have taken and will take. `elapsed_s` of every call counts from the same moment on.

    cells: those that are to be measured, by key. programs, counting: the code of each, of its frames and of what counts
    its fragments in the end. end_s: what follows the last of them. slowness: how many times as long as on a quiet
    machine the start of the process took. looks_s: reference frames of a cell.
    """

    forecast: Forecast
    cells: Mapping[str, Cell]
    programs: Mapping[str, Code]
    counting: Mapping[str, Code]
    end_s: float = 0.0
    slowness: float = 1.0
    looks_s: float = 0.0
    _spent: Seconds = field(default_factory=lambda: dict.fromkeys(USUAL, 0.0))
    _compiled: dict[int, int] = field(default_factory=dict)  # code of the cells that are or were prepared
    _counted: dict[int, int] = field(default_factory=dict)  # code that counts, of the cells that are done
    _hands: dict[str, InHand] = field(default_factory=dict)  # cells that are prepared, until they are done
    _over: Seconds = field(default_factory=lambda: dict.fromkeys(USUAL, 0.0))  # foretold of the cells that are done
    _first_ms: float = 0.0  # a frame of each of these
    _scatters: list[float] = field(default_factory=list)  # their deviations
    _guesses: list[float] = field(default_factory=list)  # and what their frames take over their guess
    _now: str | None = None  # the kind of work that goes on
    _last_s: float = 0.0  # when the last event came
    _said: tuple[float, float] | None = None  # the last forecast, and when it was made
    _stale: bool = False  # whether a cell is done since then

    def __post_init__(self) -> None:
        self._stats = {key: expected_stats(cell.scene) for key, cell in self.cells.items()}
        self._known = {key: self.forecast.known(cell) for key, cell in self.cells.items()}
        self._left = dict.fromkeys(self.cells)
        self._of_scene: dict[Scene, list[str]] = {}
        for key, cell in self.cells.items():
            self._of_scene.setdefault(cell.scene, []).append(key)
        self._first_s = {key: self._frames_s(key, self._frame(key)) + self._code_s(self.programs[key])
                         for key in self.cells}
        self._whole_s = sum(self._first_s.values())

    # --- what the run shows ----------------------------------------------------------------------

    def began(self, key: str | None, phase: str, elapsed_s: float) -> None:
        """Take in that a phase of a cell begins; key None: of all cells of a scene."""
        self._pass(elapsed_s)
        if phase == COMPILE and key in self.cells:
            self._compiled |= self.programs[key]
            self._hands[key] = InHand()
        if phase in (CHECK, WAIT):  # nothing tells how long a quiet machine is waited for
            self._now = CHECKS if phase == CHECK else None
        elif phase in PREPARING and not self.samples_ms(key):
            self._now = PROGRAMS
        elif self._now or phase == SAMPLING:
            self._now = FRAMES

    def sampled(self, key: str, samples_ms: Sequence[float]) -> None:
        """Take in samples of a cell, in ms."""
        if key in self.cells:
            self._hands.setdefault(key, InHand()).samples_ms += samples_ms

    def samples_ms(self, key: str | None) -> list[float]:
        """The samples of a cell so far."""
        return self._hands[key].samples_ms if key in self._hands else []

    def done(self, key: str, row: Mapping[str, Any], elapsed_s: float) -> None:
        """Take in a cell's row."""
        self._pass(elapsed_s)
        if key not in self._left:
            return
        del self._left[key]
        self._counted |= self._counting(key)
        self._correct(self.cells[key].scene, row["values"].get("fragments"))
        self._keep(key, self._hands.pop(key, InHand()))
        self._stale = True
        self.forecast.learn(row)

    def _correct(self, scene: Scene, fragments: int | None) -> None:
        """Take the fragments that the device made of a scene in place of those that were expected."""
        for key in self._of_scene[scene]:
            if fragments and fragments != self._stats[key].F:
                self._stats[key] = replace(self._stats[key], F=fragments)

    def _keep(self, key: str, hand: InHand) -> None:
        """Keep what the samples of a cell that is done tell."""
        self._over[CHECKS] += self.forecast.rates.check_s(self._stats[key])
        if hand.samples_ms:
            frame_ms, guess = median(hand.samples_ms), self.forecast.guess(self._stats[key])
            over_s, _ = hand.seconds(guess, self.cells[key].measure, done=True)
            self._over[FRAMES] += over_s + self.looks_s + CELL_S
            self._first_ms += frame_ms
            self._scatters += [hand.scatter] if hand.scatter is not None else []
            self._guesses.append(frame_ms / guess.time_ms)

    def _pass(self, elapsed_s: float) -> None:
        """The time since the last event went to the work that goes on."""
        passed_s, self._last_s = max(0.0, elapsed_s - self._last_s), elapsed_s
        if self._now:
            self._spent[self._now] += passed_s

    # --- what is foretold ------------------------------------------------------------------------

    def left_s(self, elapsed_s: float) -> float:
        """Seconds until the run has ended. While a forecast stands, for seconds, the time left runs down."""
        if self._said is None or not 0 <= elapsed_s - self._said[1] < self._stands_s:
            self._said, self._stale = (self._forecast_s(), elapsed_s), False
        said_s, at_s = self._said
        return max(0.0, said_s - (elapsed_s - min(at_s, self._last_s)) + self.end_s)

    def within(self, seconds: float) -> list[str]:
        """The keys of the first cells, one after another, that should be done in so many seconds of a run that begins.
        """
        done: list[str] = []
        compiled: dict[int, int] = {}
        counted: dict[int, int] = {}
        spent_s = 0.0
        for key, frame in self._frames_now().items():
            code_s = self._code_s(self.programs[key], compiled) + self._code_s(self._counting(key), counted)
            spent_s += self.slowness * (USUAL[PROGRAMS] * code_s
                                        + USUAL[CHECKS] * self.forecast.rates.check_s(self._stats[key]))
            spent_s += USUAL[FRAMES] * self._frames_s(key, frame)
            if spent_s > seconds:
                break
            done.append(key)
            compiled |= self.programs[key]
            counted |= self._counting(key)
        return done

    @property
    def _stands_s(self) -> float:
        """Seconds for which the last forecast stands; after a row no longer than making the next one is worth."""
        usual_s = 0.0 if self._stale else min(REFRESH_S, REFRESH * self._said[0])
        return max(usual_s, CELL_REFRESH_S * len(self._left))

    def _forecast_s(self) -> float:
        """Seconds from the last event until the last cell is done."""
        if not self._left:
            return 0.0
        frames = self._frames_now()
        over, to_come = self._frames(frames)
        over[PROGRAMS], to_come[PROGRAMS] = self._code()
        first_s, counted_s = self._first_frames_s(frames), self._code_s(self._counted)
        programs = self._factor(PROGRAMS, self._spent[PROGRAMS] - first_s, over[PROGRAMS], self.slowness)
        checks = self._factor(CHECKS, self._spent[CHECKS], over[CHECKS], self.slowness)
        few_s = COUPLED_TRUST * self._whole_s
        of_all = (sum(self._spent.values()) + few_s) / (first_s + counted_s + sum(over.values()) + few_s)
        drawing = self._factor(FRAMES, self._spent[FRAMES] - programs * counted_s, over[FRAMES], of_all ** COUPLED)
        return programs * to_come[PROGRAMS] + checks * to_come[CHECKS] + drawing * to_come[FRAMES]

    def _factor(self, kind: str, spent_s: float, over_s: float, usually: float) -> float:
        """What work of a kind takes over what is foretold: as the run has shown, or else as usual.

        usually: times as long as it takes on other machines.
        """
        trust_s = TRUST[kind] * self._whole_s
        return (max(0.0, spent_s) + trust_s * USUAL[kind] * usually) / (over_s + trust_s)

    def _code(self) -> tuple[float, float]:
        """Seconds to compile programs, those that are compiled and those that are to be, before any factor."""
        to_come: dict[int, int] = {}
        counting: dict[int, int] = {}
        for key in self._left:
            to_come |= self.programs[key]
            counting |= self._counting(key)
        return self._code_s(self._compiled), self._code_s(to_come, self._compiled) + self._code_s(
            counting, self._counted)

    def _code_s(self, code: Code, known: Iterable[int] = ()) -> float:
        """Seconds to compile what is not known yet."""
        return self.forecast.rates.compile_s / USUAL_CODE * sum(code[program] for program in code.keys() - set(known))

    def _counting(self, key: str) -> Code:
        """The code that counts in the end: what is kept of the fragments, and where it is asked for all work."""
        work = {-1 - program: round(COUNTERS * size) for program, size in self.programs[key].items()}
        return {**self.counting[key], **(work if self.cells[key].measure.counters else {})}

    def _frames(self, frames: Mapping[str, FrameTime]) -> tuple[Seconds, Seconds]:
        """Seconds of frames and checks that are over, and that are to come, before any factor."""
        over, to_come = dict(self._over), dict.fromkeys(USUAL, 0.0)
        for key, frame in frames.items():
            if hand := self._hands.get(key):
                mine_s, left_s = hand.seconds(frame, self.cells[key].measure)
                looked = mine_s / (mine_s + left_s) if mine_s else 0.0
                mine_s, left_s = mine_s + looked * self.looks_s, left_s + (1 - looked) * self.looks_s + CELL_S
            else:
                mine_s, left_s = 0.0, self._frames_s(key, frame)
            over[FRAMES] += mine_s
            to_come[FRAMES] += left_s
            to_come[CHECKS] += self.forecast.rates.check_s(self._stats[key])
        return over, to_come

    def _frames_s(self, key: str, frame: FrameTime) -> float:
        """Seconds of all frames of a cell that is not prepared."""
        return self.looks_s + CELL_S + sum(parts_s(frame, self.cells[key].measure)) + FIRST_FRAMES * frame.time_ms / 1e3

    def _first_frames_s(self, frames: Mapping[str, FrameTime]) -> float:
        """Seconds of the frames that were drawn to prepare cells."""
        now_ms = sum(hand.frame(frames[key]).time_ms for key, hand in self._hands.items())
        return FIRST_FRAMES * (self._first_ms + now_ms) / 1e3

    def _frames_now(self) -> dict[str, FrameTime]:
        """The time of a frame of each cell that is left without its own samples, by all that is known now."""
        scatter, guess, alike = self._scatter, self._guess, self._alike
        return {key: self._frame(key, scatter, guess, alike.get(self.cells[key].method, ())) for key in self._left}

    def _frame(self, key: str, scatter: float = USUAL_CV, guess: float = GUESS,
               alike: Iterable[Record] = ()) -> FrameTime:
        """The time of a cell's frame without its own samples.

        scatter: its deviation. guess: what frames take over their guess. alike: records of cells in hand.
        """
        if frame := self._known[key]:
            return frame
        frame = self.forecast.unknown(self.cells[key], self._stats[key], alike)
        return replace(frame, cv=scatter, time_ms=frame.time_ms * (guess if frame.source == CALIBRATED else 1.0))

    @property
    def _scatter(self) -> float:
        """The deviation of frames in the middle of all cells: one that stalled frames hit tells little of others."""
        known = [cv for hand in self._hands.values() if (cv := hand.scatter) is not None]
        return median([*self._scatters, *known, USUAL_CV])

    @property
    def _alike(self) -> dict[str, list[Record]]:
        """Records of the cells in hand that have samples, by method."""
        found: dict[str, list[Record]] = {}
        for key, hand in self._hands.items():
            if hand.samples_ms:
                cell, frame = self.cells[key], FrameTime(median(hand.samples_ms), USUAL_CV, ALIKE)
                found.setdefault(cell.method, []).append(Record(self._stats[key].F, frame, text_of(dict(cell.params))))
        return found

    @property
    def _guess(self) -> float:
        """What frames take over their guess by calibration: in the mean of those that were sampled, and of GUESS."""
        ratios = self._guesses + [median(hand.samples_ms) / self.forecast.guess(self._stats[key]).time_ms
                                  for key, hand in self._hands.items() if hand.samples_ms]
        return (sum(ratios) + GUESSES * GUESS) / (len(ratios) + GUESSES)

    @property
    def share(self) -> float:
        """The share of the time forecast at the start that is over, by the cells that are done."""
        return 1 - sum(self._first_s[key] for key in self._left) / self._whole_s if self._whole_s else 1.0
