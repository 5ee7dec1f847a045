"""Forecasts the time of a run: from what was measured on the device, else from its calibration. Pure.

A cell's time is that of its frames, which the sampling rules bound, and of what surrounds them: shaders to compile,
images to compare. docs/measurement.md says what each is taken from.
"""

from __future__ import annotations

import json
import math
from bisect import bisect_left, insort
from collections import Counter, defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from statistics import fmean
from typing import Any

from ..config.settings import Measure
from ..methods.spec import SceneStats
from ..scene import Scene
from .cells import Cell
from .expected import expected_stats

MEASURED, ALIKE, CALIBRATED = "measured here", "from the same method elsewhere", "by calibration alone"
OWN = (MEASURED, IN_HAND := "by its samples so far")  # sources that know how much the cell's frames scatter

PASS_FRAMES = 7  # whose passes are timed, where a time is told with an interval
PASS_SHARE = 0.1  # of the time limit, at most, that they take
FIRST_FRAMES = 1.4  # until a cell is prepared, beside what is compiled
OTHER_FRAMES = 1  # whose fragments are counted
KEPT_FRAMES = 1  # the last, whose image is kept, where one is
WARMUP_MS, WARMUP_POWER = 15, 0.45  # frames of 1 ms that warm up, and how fewer longer ones take
WARMUP_SHARE = 0.1  # of the time limit, at most
LEAST_WARMUP, MOST_WARMUP = 2, 32  # frames
SETTLED_MS = 10.0  # of a frame, from which on it hardly shows that other methods drew before, and none has to settle
SETTLING = 2  # of short frames, that do not count since other methods drew before
UNSTEADY = 0.1  # share of the cells that take as many samples as they may
MEDIAN_WIDTH = 1.96 * 1.2533  # half-width of the median's interval, in deviations of a mean of n normal samples
USUAL_CV = 0.05  # of frame times, where none were measured
WORK_PIXELS = 512 * 512  # of the calibration's image
OTHER_WORK = 5000  # of a frame beside its fragments, in fragments
USUAL_POWER, POWERS = 1.0, 20  # of the work, to which frames of a method take time, as if so many had shown it
MOST_POWER = 2.0  # by sorting of the fragments of a pixel
GROWN = 0.25  # logarithm of the ratio of works, from which on two scenes show the power
FIRST_ROUNDS = 16  # of its smallest work; each is twice the one before
FRAGMENT_ROUNDS = 200  # what a fragment costs a multi-fragment method, in rounds of the calibration's arithmetic
PIXEL_ROUNDS = 60  # and a pixel, in clears and the resolve
OTHER_PARAMS = 1.5  # logarithm of a ratio of works, that other parameters count as
FIXED_ROUNDS = 1e6  # and a frame of about five passes, however little they draw
MOST_FIXED = 0.7  # share of a frame that this may be
REFERENCE_ROUNDS = 1.2e6  # and the reference frame
REFERENCES = 10  # of a cell: two after each of four turns, and two before the first

Identity = tuple[str, str, str]  # of what was measured: the method, and the texts of its parameters and of the scene


@dataclass(frozen=True)
class Rates:
    """Seconds, and nanoseconds of GPU work. Defaults: two cores, Mesa's shader cache cold."""

    start_s: float = 1.5  # to open the device and calibrate it, twice
    compile_s: float = 0.2  # a cell's programs
    pixel_s: float = 1e-5  # FLIP of an image, per pixel
    store_s: float = 0.02  # a cell's row
    report_s: float = 0.03  # tables and figures, per cell
    round_ns: float = 0.5  # one round of the calibration's arithmetic in one pixel

    def check_s(self, stats: SceneStats) -> float:
        """The time of a cell's oracle and error measures."""
        return self.pixel_s * stats.P

    def around_s(self, stats: SceneStats) -> float:
        """The time that surrounds a cell's frames while it is measured."""
        return self.compile_s + self.check_s(stats) + self.store_s

    @property
    def looks_s(self) -> float:
        """The time of a cell's reference frames."""
        return REFERENCES * REFERENCE_ROUNDS * self.round_ns / 1e9

    @property
    def fragment_ms(self) -> float:
        return FRAGMENT_ROUNDS * self.round_ns / 1e6

    @property
    def fixed_ms(self) -> float:
        return FIXED_ROUNDS * self.round_ns / 1e6

    @property
    def pixel_ms(self) -> float:
        return PIXEL_ROUNDS * self.round_ns / 1e6


@dataclass(frozen=True)
class FrameTime:
    """Time of a frame, the coefficient of variation of such times, and where both are from."""

    time_ms: float
    cv: float
    source: str


@dataclass(frozen=True)
class Record:
    """A measured cell, as a forecast uses it."""

    fragments: int
    frame: FrameTime
    params: str = ""  # as text


class ByFragments:
    """Records of one method by their number of fragments; of equal numbers the first. A look takes few steps."""

    def __init__(self) -> None:
        self._fragments: list[int] = []  # ascending
        self._first: dict[int, tuple[int, Record]] = {}  # with its place among all

    def add(self, record: Record) -> None:
        """Take in a record."""
        if record.fragments not in self._first:
            insort(self._fragments, record.fragments)
            self._first[record.fragments] = len(self._first), record

    def nearest(self, fragments: int) -> Record:
        """The record whose number of fragments has the ratio to this one that is nearest to 1; of two the first."""
        at = bisect_left(self._fragments, fragments)
        around = (self._first[number] for number in self._fragments[max(0, at - 1):at + 1])
        return min(around, key=lambda placed: (_distance(placed[1].fragments, fragments), placed[0]))[1]


@dataclass(frozen=True)
class Prediction:
    """Seconds in all, of which frames and comparisons of images, and how many cells' frame times come from where."""

    total_s: float
    frames_s: float
    checks_s: float
    sources: Mapping[str, int]

    @property
    def text(self) -> str:
        basis = ", ".join(f"{count} {source}" for source, count in self.sources.items())
        checks = f" ({rough_duration(self.checks_s)} of it to check images)" if self.checks_s > self.total_s / 5 else ""
        return f"about {rough_duration(self.total_s)}{checks}; frame times: {basis or 'none'}"

    def within(self, budget_s: float | None) -> Prediction:
        """The same of a run that a time budget ends; None is no budget."""
        share = 1.0 if budget_s is None else budget_s / max(self.total_s, budget_s)
        return replace(self, total_s=share * self.total_s, frames_s=share * self.frames_s,
                       checks_s=share * self.checks_s)


def rough_duration(seconds: float) -> str:
    """'40 s', '3 min', '2.5 h': two digits are more than a forecast is worth."""
    if seconds < 90:
        return f"{max(1, round(seconds, -1 if seconds >= 20 else 0)):.0f} s"
    return f"{seconds / 60:.0f} min" if seconds < 5400 else f"{seconds / 3600:.1f} h"


class Forecast:
    """Predicts cells of one device from `records` (cell records of it, of any experiment) and rates."""

    def __init__(self, records: Iterable[Mapping[str, Any]], rates: Rates):
        self.rates = rates
        self._exact: dict[Identity, FrameTime] = {}
        self._scenes: dict[Scene, str] = {}  # texts, each made once
        self._of_method: dict[str, ByFragments] = defaultdict(ByFragments)
        self._of_variant: dict[tuple[str, str], ByFragments] = defaultdict(ByFragments)
        self._last: dict[tuple[str, str], Record] = {}  # of a method with parameters
        self._powers: list[float] = [USUAL_POWER] * POWERS
        for row in records:
            self.learn(row)

    def learn(self, row: Mapping[str, Any]) -> None:
        """Take in the record of a cell; one that has no time predicts nothing."""
        if frame := _measured(row):
            variant = method, params = row["method"], text_of(dict(row["params"]))
            self._exact[method, params, text_of(row["scene"])] = frame
            record = Record(row["values"].get("fragments") or 0, replace(frame, source=ALIKE), params)
            self._of_method[method].add(record)
            self._of_variant[variant].add(record)
            self._learn_power(self._last.get(variant), record)
            self._last[variant] = record

    def _learn_power(self, before: Record | None, record: Record) -> None:
        """Take in how the time of a method's frame grew from one scene to another."""
        grown = math.log(_work(record.fragments) / _work(before.fragments)) if before else 0.0
        if abs(grown) >= GROWN:
            now_ms, before_ms = (r.frame.time_ms - self._fixed_ms(r.frame) for r in (record, before))
            power = math.log(now_ms / before_ms) / grown
            self._powers.append(min(MOST_POWER, max(0.0, power)))

    @property
    def power(self) -> float:
        """The power of the work to which a method's frames take time, in the mean of the methods that have shown it."""
        return fmean(self._powers)

    def frame(self, cell: Cell, stats: SceneStats) -> FrameTime:
        """The time that a frame of the cell should take."""
        return self.known(cell) or self.unknown(cell, stats)

    def known(self, cell: Cell) -> FrameTime | None:
        """The time that a frame of the very cell took."""
        if not self._exact:
            return None
        if cell.scene not in self._scenes:
            self._scenes[cell.scene] = text_of(cell.scene.as_dict())
        return self._exact.get((cell.method, text_of(dict(cell.params)), self._scenes[cell.scene]))

    def unknown(self, cell: Cell, stats: SceneStats, more: Iterable[Record] = ()) -> FrameTime:
        """The time of a frame that was not measured: of the method, with `more` records of it, or by calibration."""
        params = text_of(dict(cell.params))
        own = self._of_variant.get((cell.method, params)), self._of_method.get(cell.method)
        near = [records.nearest(stats.F) for records in own if records]
        return self._alike([*near, *more], stats, params) or self.guess(stats)

    def _alike(self, records: Iterable[Record], stats: SceneStats, params: str) -> FrameTime | None:
        """The frame of the nearest number of fragments, scaled by the work that this number makes.

        One with other parameters counts as further away.
        """
        near = min(records, key=lambda record: _distance(record.fragments, stats.F)
                   + OTHER_PARAMS * (record.params != params), default=None)
        if near is None:
            return None
        fixed_ms = self._fixed_ms(near.frame)
        scale = (_work(stats.F) / _work(near.fragments)) ** self.power
        return replace(near.frame, time_ms=fixed_ms + (near.frame.time_ms - fixed_ms) * scale)

    def _fixed_ms(self, frame: FrameTime) -> float:
        """What a frame takes however few fragments there are: its passes begin and end."""
        return min(self.rates.fixed_ms, MOST_FIXED * frame.time_ms)

    def guess(self, stats: SceneStats) -> FrameTime:
        """The time of a frame by calibration alone."""
        time_ms = self.rates.fixed_ms + self.rates.fragment_ms * stats.F + self.rates.pixel_ms * stats.P
        return FrameTime(time_ms, USUAL_CV, CALIBRATED)

    def run(self, cells: Sequence[Cell]) -> Prediction:
        """One run that measures these cells."""
        spent_s, checks_s, total_s = 0.0, 0.0, self.rates.start_s if cells else 0.0
        sources: Counter[str] = Counter()
        for cell in cells:
            stats = expected_stats(cell.scene)
            frame = self.frame(cell, stats)
            drawing_s, whole_s = self._cell_s(cell, stats, frame)
            spent_s, total_s = spent_s + drawing_s, total_s + whole_s + self.rates.report_s
            sources[frame.source] += 1
            checks_s += self.rates.check_s(stats)
        return Prediction(total_s, spent_s, checks_s, sources)

    def _cell_s(self, cell: Cell, stats: SceneStats, frame: FrameTime) -> tuple[float, float]:
        """Seconds of a cell's frames, and of all that it takes until the next one begins."""
        spent_s = frames_s(frame, cell.measure) + self.rates.looks_s
        return spent_s, spent_s + self.rates.around_s(stats)


def _work(fragments: int) -> float:
    """What the time of a method's frame is in proportion to: clears and draws cost more for few fragments."""
    return fragments + OTHER_WORK


def frames_s(frame: FrameTime, measure: Measure) -> float:
    """Seconds that the sampling rules let the frames of a cell take: warm-up, samples, passes, checks."""
    return sum(parts_s(frame, measure)) + FIRST_FRAMES * frame.time_ms / 1e3


def parts_s(frame: FrameTime, measure: Measure) -> tuple[float, float]:
    """Seconds that a cell's warm-up and samples take, and its other frames: those of passes and of checks.

    Where the frame's scatter is not the cell's own, they are the mean of many cells, a few of which are unsteady.
    """
    frame_s = frame.time_ms / 1e3
    warm_s = warmup_s(frame_s, measure)
    sampled_s, longest_s = (min(warm_s + samples * frame_s, most_s(frame_s, measure))
                            for samples in (samples_wanted(frame, measure), measure.max_samples))
    if frame.source not in OWN:
        sampled_s += UNSTEADY * (longest_s - sampled_s)
    passes_s = min(pass_frames(measure) * frame_s, PASS_SHARE * measure.time_limit_s + frame_s)
    return sampled_s, passes_s + other_frames(measure) * frame_s


def pass_frames(measure: Measure) -> int:
    """Frames of a cell whose passes are timed: one beside a single sample."""
    return 1 if measure.single else PASS_FRAMES


def other_frames(measure: Measure) -> int:
    """Frames of a cell that are not timed, beside its first ones and those that warm it up.

    Fragments are counted in one, the image of another is kept, and each of several images that are compared is one's.
    """
    compared = measure.repeat_images if measure.repeat_images > 1 else 0
    return OTHER_FRAMES + compared + KEPT_FRAMES * measure.keeps_image


def warmup_s(frame_s: float, measure: Measure) -> float:
    """Seconds of frames that warm a cell up and settle: short ones are seldom alike at once.

    A single frame warms up for a single sample.
    """
    if measure.single:
        return frame_s
    frame_ms = max(0.01, 1e3 * frame_s)
    warming = min(MOST_WARMUP, max(LEAST_WARMUP, WARMUP_MS / frame_ms**WARMUP_POWER))
    frames = warming + SETTLING * (frame_ms < SETTLED_MS)
    return min(frames * frame_s, WARMUP_SHARE * measure.time_limit_s + frame_s)


def most_s(frame_s: float, measure: Measure) -> float:
    """Seconds that warm-up and samples take at most, of frames that take `frame_s` seconds."""
    return max(measure.time_limit_s, 2 * frame_s) + frame_s / 2


def samples_wanted(frame: FrameTime, measure: Measure) -> float:
    """Samples after which a sampler stops where the time limit does not end it."""
    needed = (MEDIAN_WIDTH * frame.cv / measure.target_rel_ci) ** 2
    return min(measure.max_samples, max(measure.min_samples, needed))


def _distance(fragments: int, of: int) -> float:
    return abs(math.log(_work(of) / _work(fragments)))


def text_of(value: Any) -> str:
    """Parameters or a scene as text."""
    return json.dumps(value, sort_keys=True)


def _measured(row: Mapping[str, Any]) -> FrameTime | None:
    """The frame of a measured cell, its deviation from that of its samples."""
    time_ms, samples = row["values"].get("time_ms"), row.get("samples_ms") or []
    if not time_ms:
        return None
    low, high = row["values"].get("time_ms_low"), row["values"].get("time_ms_high")
    width = (high - low) / 2 / time_ms if None not in (low, high) else None
    cv = USUAL_CV if width is None else width * math.sqrt(len(samples)) / MEDIAN_WIDTH
    return FrameTime(time_ms, cv, MEASURED)


def rates_of(runs: Iterable[tuple[Mapping[str, Any], Sequence[Mapping[str, Any]]]],
             calibration: Mapping[str, Any]) -> Rates:
    """Rates by what earlier runs say of their time, else by default. `runs`: manifests with their cell records."""
    spent: Counter[str] = Counter()
    cells = pixels = 0
    starts: set[object] = set()  # a run of several configs writes its time into every manifest
    for manifest, rows in runs:
        split = manifest.get("split_s")
        if not isinstance(split, dict) or not split.get("compile"):
            continue
        measured = [row for row in rows if row["values"].get("time_ms") is not None]
        cells += len(measured)
        pixels += sum(math.prod(row["scene"]["size"]) for row in measured)
        if manifest.get("started") not in starts:
            starts.add(manifest.get("started"))
            spent.update({kind: seconds for kind, seconds in split.items() if isinstance(seconds, (int, float))})
    rates = calibrated(calibration)
    if not cells:
        return rates
    return replace(rates, start_s=spent["start-up"] / len(starts), compile_s=spent["compile"] / cells,
                   pixel_s=sum(spent[kind] for kind in ("check", "flip", "oracle", "scene")) / pixels,
                   store_s=spent["store"] / cells, report_s=spent["report"] / cells)


def calibrated(calibration: Mapping[str, Any]) -> Rates:
    """Rates with the device's arithmetic: from the largest work of known size that was timed."""
    times = calibration.get(f"{calibration.get('timer')}_ms") or ()
    if not times:
        return Rates()
    rounds = FIRST_ROUNDS * 2 ** (len(times) - 1)
    return Rates(round_ns=times[-1] * 1e6 / rounds / WORK_PIXELS)
