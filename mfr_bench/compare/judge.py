"""The verdict on each cell that two sets of results share."""

from __future__ import annotations

import math
from bisect import bisect_right
from collections import Counter, defaultdict
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from statistics import NormalDist
from typing import Any

from ..report.data import Point, percent
from ..stats import Interval
from ..store import failed_trials
from ..store.status import EXACT_ERROR
from .few import Frames, log_ratio
from .noise import Noise, Shift, estimate
from .references import References
from .sides import Entry, Side, changed_environment, refuse_other_devices

FASTER, SLOWER, SAME, UNCLEAR, MISSING = "FASTER", "SLOWER", "SAME", "UNCLEAR", "MISSING"
VERDICTS = (SLOWER, FASTER, UNCLEAR, SAME, MISSING)
TOLD = (SLOWER, FASTER, SAME)
ERROR_RATE = 0.02  # of a whole comparison: the chance of any false alarm, were the noise as it is estimated
SAME_RATE = 0.05  # of each cell that is called the same: the chance that it is not
SUPPORT = 2.0  # deviations by which another cell of the method must have moved the same way
ALIKE = 3.0  # times as far, on a logarithmic scale: the most that it may have moved
TOGETHER = 2.0  # and by which, where the cells of the method decide it together
ALONE = 2.0  # times the noise between runs counts for a cell whose method has no other
AGAINST = 4.0  # and for one that no other cell of its method supports
MOST_BURST = 8.0  # times as long: the longest that two cores, shared with other work, made a cell that did not change
HIDDEN_BURST = 4.0  # times as long: what a burst may do to a cell while hardly any other shows it
FURTHER = 2.5  # times as far as any cell of another method: what it may do beyond that
Judged = tuple[str, str, Interval, float | None]  # verdict, reason, ratio with its interval, ratio as measured
RMSE_GROWTH = 1.1  # a larger error: methods with races have another one in every run


@dataclass(frozen=True)
class Change:
    """Something counted that is not as it was. `worse`: None where it is neither better nor worse.

    trials: the self-tests that the device fails on one side, where that is why the status is another one.
    """

    text: str
    worse: bool | None
    trials: tuple[str, ...] = ()


@dataclass(frozen=True)
class CellVerdict:
    """A cell on both sides. `ratio`: after / before with what all methods have in common taken out, and the interval
    in which it lies for all cells at once; `raw`: the ratio as measured."""

    name: str
    experiment: str
    before: Entry
    after: Entry
    verdict: str | None  # None where neither side has a time
    reason: str = ""
    ratio: Interval = (None, None, None)
    raw: float | None = None
    changes: tuple[Change, ...] = ()

    @property
    def regressed(self) -> bool:
        return self.verdict == SLOWER or any(change.worse for change in self.changes)

    def record(self) -> dict[str, Any]:
        """The verdict as JSON knows it."""
        low, ratio, high = self.ratio
        return _about(self.after) | {
            "verdict": self.verdict, "reason": self.reason or None,
            "before_ms": self.before.point.row["time_ms"], "after_ms": self.after.point.row["time_ms"],
            "ratio": ratio, "ratio_low": low, "ratio_high": high, "raw_ratio": self.raw,
            "changes": [{"what": change.text, "worse": change.worse} for change in self.changes]}


def _about(entry: Entry) -> dict[str, Any]:
    cell = entry.point.cell
    return {"experiment": entry.experiment, "name": entry.name, "method": cell["method"], "params": cell["params"],
            "scene": cell["scene"]}


@dataclass(frozen=True)
class Together:
    """Several cells judged as one, by the mean of their ratios."""

    name: str
    verdict: str
    reason: str
    ratio: Interval

    def record(self) -> dict[str, Any]:
        """The verdict as JSON knows it."""
        low, ratio, high = self.ratio
        return {"name": self.name, "verdict": self.verdict, "reason": self.reason or None, "ratio": ratio,
                "ratio_low": low, "ratio_high": high}


@dataclass(frozen=True)
class Comparison:
    """All that is said of two sets of results. `common`: ratio of all methods together, least and most of any scene.

    together: verdicts on several cells as one, where both sides took turns.
    """

    before: Side
    after: Side
    threshold: float
    floor: float
    absolute: bool
    verdicts: tuple[CellVerdict, ...]
    missing_before: tuple[Entry, ...]
    missing_after: tuple[Entry, ...]
    common: tuple[float, float] | None
    together: tuple[Together, ...] = ()

    @property
    def counts(self) -> Mapping[str, int]:
        """Cells by verdict; those of one side alone are MISSING."""
        missing = {MISSING: len(self.missing_before) + len(self.missing_after)}
        return Counter(v.verdict for v in self.verdicts if v.verdict) + Counter(missing)

    @property
    def environment(self) -> list[str]:
        return changed_environment(self.before, self.after)

    @property
    def moved(self) -> bool:
        """Whether the machine as a whole was faster or slower by more than the threshold and the noise floors."""
        limit = max(self.threshold, self.floor)
        return self.common is not None and any(abs(ratio - 1) > limit for ratio in self.common)

    @property
    def regressed(self) -> bool:
        return any(v.regressed for v in self.verdicts) or any(t.verdict == SLOWER for t in self.together)

    def records(self) -> list[dict[str, Any]]:
        """Every cell of either side as JSON knows it; a MISSING one has the time of the side that has it."""
        return [*(v.record() for v in self.verdicts), *(self._missing(e, self.before) for e in self.missing_after),
                *(self._missing(e, self.after) for e in self.missing_before)]

    def _missing(self, entry: Entry, side: Side) -> dict[str, Any]:
        time_ms = entry.point.row["time_ms"]
        return _about(entry) | {
            "verdict": MISSING, "reason": f"only in {side.path}", "before_ms": time_ms if side is self.before else None,
            "after_ms": time_ms if side is self.after else None, "ratio": None, "ratio_low": None, "ratio_high": None,
            "raw_ratio": None, "changes": []}

    @property
    def untold(self) -> bool:
        """Whether the comparison cannot vouch for the new side: cells are missing, or no cell is decided."""
        decided = any(v.verdict in TOLD or any(c.worse is not None for c in v.changes) for v in self.verdicts)
        return bool(self.counts.get(MISSING) or not decided)

    @property
    def doubtful(self) -> bool:
        """Whether something is undecided: a cell that is unclear or missing, a machine that moved."""
        return bool(self.untold or self.counts.get(UNCLEAR) or (self.moved and not self.absolute))


def compare(before: Side, after: Side, threshold: float = 0.02, across_devices: bool = False,
            absolute: bool = False) -> Comparison:
    """Cell by cell. Raises UsageError where the devices differ and that was not asked for.

    `threshold`: smallest relative difference that matters. `absolute`: what all methods of a scene have in common
    counts as theirs; else it is taken out, for a load or a clock does the same.
    """
    if not across_devices:
        refuse_other_devices(before, after)
    floor = max((noise for noise in (before.noise, after.noise) if noise is not None), default=threshold)
    timed = _Timed(_shared(before, after), floor, threshold, absolute, alike=before.devices == after.devices)
    return compared(before, after, threshold, floor, absolute, lambda _, entry: timed.judge(entry), timed.common)


def compared(before: Side, after: Side, threshold: float, floor: float, absolute: bool,
             judged: Callable[[Entry, Entry], Judged], common: tuple[float, float] | None = None) -> Comparison:
    """The comparison in which `judged` gives what is said of the times of a cell that has one on both sides."""
    return Comparison(before, after, threshold, floor, absolute,
                      tuple(_verdict(b, a, judged) for b, a in _shared(before, after)),
                      tuple(e for key, e in after.entries.items() if key not in before.entries),
                      tuple(e for key, e in before.entries.items() if key not in after.entries), common)


def _shared(before: Side, after: Side) -> list[tuple[Entry, Entry]]:
    return [(entry, after.entries[key]) for key, entry in before.entries.items() if key in after.entries]


class _Timed:
    """The verdicts on times, of all cells that have one on both sides."""

    def __init__(self, pairs: Sequence[tuple[Entry, Entry]], floor: float, threshold: float, absolute: bool,
                 alike: bool):
        self._same, self._absolute = math.log1p(threshold), absolute
        frames = Frames(_samples(entry) for pair in pairs for entry in pair)
        references = References(pairs if alike else ())
        shifts = {id(a): shift for number, (b, a) in enumerate(pairs)
                  if (shift := _shift(b, a, frames, references, number if alike else None))}
        self._index = {key: number for number, key in enumerate(shifts)}
        self._shifts = list(shifts.values())
        self._noise: Noise = estimate(self._shifts, floor, alike)
        self._limit = math.log1p(max(threshold, self._noise.floor))
        self._critical = NormalDist().inv_cdf(1 - ERROR_RATE / 2 / max(1, len(self._shifts)))
        self._of_method: dict[Any, list[int]] = defaultdict(list)
        for number, shift in enumerate(self._shifts):
            if shift.steady is not False:
                self._of_method[shift.method].append(number)
        self._outermost = sorted(range(len(self._shifts)), key=lambda n: -abs(self._moved(n)))
        self._methods: dict[tuple[Any, float], _Moves] = {}  # by method and sign

    @property
    def common(self) -> tuple[float, float] | None:
        found = [math.exp(c) for c in self._noise.common]
        return (min(found), max(found)) if any(self._noise.common) else None

    def _moved(self, number: int) -> float:
        """The change of a cell, apart from the change of all."""
        return self._shifts[number].log_ratio - (0.0 if self._absolute else self._noise.common[number])

    def _distance(self, number: int) -> float:
        """The number of deviations by which a cell moved, as the outer cells count them."""
        return self._moved(number) / self._noise.deviations[number] / self._noise.stretch

    def _beyond_noise(self, number: int) -> bool:
        """Whether a cell moved further than two runs of one thing do, by itself or together with others of its method.

        A method that changed moves in more than one of its cells; a burst of load hits one. What moved while the
        device was slower is a burst's doing.
        """
        if abs(self._moved(number)) > self._burst_reach(number):
            return True
        if self._shifts[number].steady is False:
            return False
        sign = math.copysign(1.0, self._distance(number))
        mine, method = abs(self._distance(number)), self._method(self._shifts[number].method, sign)
        support = method.support(abs(self._moved(number)))
        if mine > self._critical and min(support, mine) > SUPPORT:
            return True
        return method.distance > self._critical and mine > SUPPORT and support > TOGETHER

    def _method(self, method: Any, sign: float) -> _Moves:
        """How far the cells of a method moved in one direction."""
        if (method, sign) not in self._methods:
            cells = sorted((sign * self._moved(i), sign * self._distance(i)) for i in self._of_method[method])
            self._methods[method, sign] = _Moves(cells, self._critical)
        return self._methods[method, sign]

    def _burst_reach(self, number: int) -> float:
        """The logarithmic distance that a burst of load longer than its sampling may move a cell without support.

        That is several times as far as cells are apart, or the length of the tails of that; or what a burst did to the
        slowest frames, or to the slowest turns where the device is known to have been as fast as ever, with what the
        reference frame explains where it is known to have been slower. Nothing of it is
        put down to what few samples leave open, whose size is a guess: where the guess is too large, too little would
        be left for bursts. What the cell's own samples leave open counts once besides.
        """
        shift, noise = self._shifts[number], self._noise
        times = AGAINST if self._of_method[shift.method][1:] else ALONE
        apart = self._critical * max(times, noise.stretch) * noise.spread
        return math.hypot(self._critical * shift.error, min(self._most_burst(shift.method), max(apart, shift.burst)))

    def _most_burst(self, method: Any) -> float:
        """The logarithm of the most that a burst makes of a cell: a strong one shows in cells of other methods too."""
        others = next((n for n in self._outermost if self._shifts[n].method != method), None)
        shown = 0.0 if others is None else FURTHER * abs(self._moved(others))
        return min(math.log(MOST_BURST), max(math.log(HIDDEN_BURST), shown))

    def judge(self, after: Entry) -> Judged:
        """Verdict, reason, ratio with its interval, ratio as measured."""
        number = self._index.get(id(after))
        if number is None:
            return UNCLEAR, "a side has no sample of a time above 0", (None, None, None), None
        moved, deviation = self._moved(number), self._noise.deviations[number]
        reach = min(self._critical * self._noise.stretch * deviation, self._burst_reach(number))
        ratio = math.exp(moved - reach), math.exp(moved), math.exp(moved + reach)
        verdict, reason = self._decided(number, moved, deviation, reach)
        return verdict, reason, ratio, math.exp(self._shifts[number].log_ratio)

    def _decided(self, number: int, moved: float, deviation: float, reach: float) -> tuple[str, str]:
        if abs(moved) > self._limit and self._beyond_noise(number):
            return (SLOWER if moved > 0 else FASTER), ""
        if abs(moved) + NormalDist().inv_cdf(1 - SAME_RATE) * deviation < self._same:
            return SAME, ""
        if self._shifts[number].steady is False:
            return UNCLEAR, "the reference frame was slower while it was sampled: measure both again"
        if abs(moved) <= reach:
            return UNCLEAR, "no more than what two runs of one thing differ by here"
        if abs(moved) <= self._limit:
            return UNCLEAR, f"no more than the noise floor of {percent(self._noise.floor)}"
        return UNCLEAR, "no other cell of the method moved with it: measure both again"


class _Moves:
    """How far the cells of a method moved in one direction, given as changes and distances, the least change first."""

    def __init__(self, cells: Sequence[tuple[float, float]], critical: float):
        capped = [max(-critical, min(critical, distance)) for _, distance in cells]
        self.distance = math.fsum(capped) / math.sqrt(len(capped)) if capped else 0.0
        self._moved = [moved for moved, _ in cells]
        self._seconds: list[float] = []  # second largest distance of each cell and those that moved less
        two = [-math.inf, -math.inf]
        for _, distance in cells:
            two = sorted([*two, distance])[1:]
            self._seconds.append(two[0])

    def support(self, moved: float) -> float:
        """The distance of another cell than the one that moved so far, or of this one where the other's is larger.

        One that moved much further supports nothing: its own change is no reason for a burst of the other to be more.
        """
        alike = bisect_right(self._moved, ALIKE * moved)
        return self._seconds[alike - 1] if alike else -math.inf


def _samples(entry: Entry) -> list[float]:
    """Frame times in ms of a cell whose time counts."""
    return entry.point.cell.get("samples_ms") or [] if entry.point.row["time_ms"] is not None else []


def _shift(before: Entry, after: Entry, frames: Frames, references: References, number: int | None) -> Shift | None:
    """The change of a cell that has samples on both sides, of one timer.

    frames: of all cells. number: of the cell among those of `references`; None where these tell nothing.
    """
    over, under = _samples(after), _samples(before)
    if not over or not under or before.point.row["timer"] != after.point.row["timer"]:
        return None
    found = log_ratio(over, under, frames)
    time_ms = min(before.point.row["time_ms"], after.point.row["time_ms"])
    steady = None if number is None else references.steady[number]
    burst = frames.burst(time_ms)
    if steady is not None and (unseen := references.burst(time_ms)) is not None:
        burst = min(burst, unseen)
    if steady is False:
        burst = min(max(burst, math.log(HIDDEN_BURST)), burst + references.explained(number))
    return Shift(after.scene, after.method, *found, burst, steady) if found else None


def _verdict(before: Entry, after: Entry, judged: Callable[[Entry, Entry], Judged]) -> CellVerdict:
    b, a = before.point, after.point
    changes = tuple(_changes(before, after))
    about = (after.name, after.experiment, before, after)
    if (b.status, a.status) != ("ok", "ok"):
        return CellVerdict(*about, *_without_times(b, a), changes=changes)
    if b.row["timer"] != a.row["timer"]:
        return CellVerdict(*about, UNCLEAR, f"timed by {b.row['timer']}, then by {a.row['timer']}", changes=changes)
    return CellVerdict(*about, *judged(before, after), changes)


def _without_times(before: Point, after: Point) -> tuple[str | None, str]:
    """Verdict and reason of a cell that has no time on both sides: a fault is a change, a lost measurement is not."""
    lost = "ok" in (before.status, after.status) and not (before.ending.failed or after.ending.failed)
    return (UNCLEAR, f"measured on one side alone: {before.status}, then {after.status}") if lost else (None, "")


def _changes(before: Entry, after: Entry) -> list[Change]:
    """The counted values that are not as they were: status, image, memory."""
    b, a = before.point, after.point
    found = []
    if b.status != a.status:
        failed, refused = (b.ending.failed, a.ending.failed), failed_trials(a.cell)
        worse = True if failed == (False, True) else False if failed[0] and not refused else None
        reason = f" ({a.cell['reason']})" if a.cell.get("reason") and failed[1] else ""
        found.append(Change(f"{b.sign} -> {a.sign}{reason}", worse, tuple(refused or failed_trials(b.cell))))
    found += _error_changes(b.row, a.row)
    if None not in (m := (b.row["memory_bytes"], a.row["memory_bytes"])) and m[0] != m[1]:
        found.append(Change(f"memory {m[0]:,} -> {m[1]:,} bytes", m[1] > m[0]))
    return found


def _error_changes(before: Mapping[str, Any], after: Mapping[str, Any]) -> list[Change]:
    largest = before["max_abs_error"], after["max_abs_error"]
    if None not in largest and (largest[0] > EXACT_ERROR) != (largest[1] > EXACT_ERROR):
        return [Change(f"max_abs_error {largest[0]:.3g} -> {largest[1]:.3g}", largest[1] > largest[0])]
    rmse = before["rmse"], after["rmse"]
    if None in rmse or max(rmse) <= EXACT_ERROR or max(rmse) <= RMSE_GROWTH * min(rmse):
        return []
    return [Change(f"rmse {rmse[0]:.3g} -> {rmse[1]:.3g}", rmse[1] > rmse[0])]
