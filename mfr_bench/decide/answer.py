"""The answer from the rows of a race: the method, how sure that is, who comes close, who was excluded and why."""

from __future__ import annotations

import math
import shlex
import textwrap
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from ..measure.elimination import CHANCE, LATE, Elimination
from ..report import data
from ..report.advice import chosen, written
from ..report.data import LOSES_TIES, Point, Result
from ..stats import Interval, whole_percents
from ..store import failed_trials
from ..store.status import EXACT_ERROR
from .candidates import NOT_FINISHED, NOT_TRIED, Excluded
from .question import Question

CLOSE = 1.05  # times the winner's time, up to which others are named
LIKELY = 0.01  # chance to be the fastest that its frames give a method, from which on it is named beside the answer
TIMED, UNTRIED, INEXACT, FAILED, EXCLUDED = range(5)  # methods that were not chosen, the nearest to the answer first
MOST_SHOWN = 8  # lines of a list in the text form


@dataclass(frozen=True)
class Out:
    """A method that was not chosen, as a command takes it, and why. ratio: of its time to that of the answer."""

    group: int
    method: str
    reason: str
    ratio: float | None = None


@dataclass(frozen=True)
class Answer:
    """The outcome of the race. `config`: the file of its config, for the command that measures the winner in full.

    cut: what the time budget left out, in words.
    """

    question: Question
    result: Result
    excluded: tuple[Excluded, ...]
    config: str
    cut: tuple[str, ...] = ()

    @cached_property
    def finalists(self) -> list[Point]:
        """The cells that keep the bounds and were not eliminated, the likeliest to be the fastest first.

        Frames of one round tell more than medians do, since load hits them alike; medians decide between equal chances.
        """
        return sorted(self._in_the_end, key=lambda p: (-self.chances.get(p.cell["key"], 0.0), p.row["time_ms"]))

    @cached_property
    def _in_the_end(self) -> list[Point]:
        return [p for p in self._racing if not _left_early(p)]

    @cached_property
    def _racing(self) -> list[Point]:
        column = "max_error_all"
        return [p for p in self.result.points
                if not data.is_floor(p) and p.status == "ok" and p.row["time_ms"] is not None
                and p.row[column] is not None and p.row[column] <= self.question.max_error
                and (self.question.memory_mb is None or p.measure("memory_mib")[1] <= self.question.memory_mb)]

    @property
    def best(self) -> Point | None:
        """The likeliest to be the fastest, or None where nothing keeps the bounds."""
        return self.finalists[0] if self.finalists else None

    @cached_property
    def chances(self) -> dict[str, float]:
        """The chance of each finalist to be the fastest of all.

        Where methods were dropped for their times, these have the chance that dropping takes: together it is 1.
        """
        race = Elimination([p.cell["key"] for p in self._in_the_end])
        samples = {p.cell["key"]: p.cell["samples_ms"] for p in self._in_the_end}
        for times in zip(*samples.values(), strict=False):
            race.rounds.append(dict(zip(samples, times, strict=True)))
        found = race.chances() if race.rounds else {}
        return {key: self._of_finalists * chance for key, chance in found.items()}

    @property
    def _of_finalists(self) -> float:
        """The chance that a finalist is the fastest."""
        return 1 - CHANCE if any(_stopped(p).startswith("eliminated") for p in self.result.points) else 1.0

    @property
    def confidence(self) -> float:
        """The chance that `best` is the fastest."""
        return self._chance(self.best) if self.best else 0.0

    @cached_property
    def close(self) -> list[Point]:
        """The other finalists that may be as fast as `best`, the likeliest to be the fastest first.

        These are the ones whose frames give them a chance of LIKELY and more to be the fastest, those whose interval of
        the ratio of their times to its holds 1, and those that take no more than 5 % longer by that ratio.
        """
        if not self.finalists:
            return []
        return [p for p in self.finalists[1:] if self._may_be_as_fast(p)]

    def _may_be_as_fast(self, point: Point) -> bool:
        low, ratio, _ = point.over(self.best)
        likely = self._chance(point) - self._unseen >= LIKELY
        return likely or (low is not None and low <= 1) or (ratio is not None and ratio <= CLOSE)

    @property
    def _unseen(self) -> float:
        """The part of the chance of each finalist that no frame has given it: together they weigh as one round."""
        rounds = min(len(p.cell["samples_ms"]) for p in self.finalists)
        return self._of_finalists / (rounds + 1) / len(self.finalists)

    def _chance(self, point: Point) -> float:
        return self.chances.get(point.cell["key"], 0.0)

    @cached_property
    def _percents(self) -> list[int]:
        """The chances of `best`, of each of `close` and of all others together, in percents that add up to 100."""
        named = [self._chance(p) for p in (self.best, *self.close)]
        return whole_percents([*named, max(0.0, 1 - sum(named))])

    @cached_property
    def out(self) -> list[Out]:
        """Every method that did not win nor come close, with the reason: the nearest to the answer first.

        That is, those that were timed, by their time; those that the time budget left untried; those whose error is too
        large; those that the device or the memory forbids or that failed; and those that are excluded by what they
        declare.
        """
        named = {p.cell["key"] for p in (*self.finalists[:1], *self.close)}
        others = [self._placed(p) for p in self.result.points if p.cell["key"] not in named and not data.is_floor(p)]
        others += [Out(UNTRIED if each.reason in (NOT_TRIED, NOT_FINISHED) else EXCLUDED, each.method, each.reason)
                   for each in self.excluded]
        return sorted(others, key=lambda each: (each.group, math.inf if each.ratio is None else each.ratio))

    def _placed(self, point: Point) -> Out:
        """The entry of `out` for a point. Every ratio is to the time of the answer, whoever led when the point left."""
        name, error = written(point), point.row["max_error_all"]
        if point.status != "ok":
            reason = _reason(point)
            return Out(UNTRIED if reason == NOT_TRIED else FAILED, name, reason)
        if error is not None and error > self.question.max_error:
            return Out(INEXACT, name, f"an error above {self._bound}{f': {LOSES_TIES}' if point.loses_ties else ''}")
        ratio = point.over(self.best)[1] if self.best else None
        return Out(TIMED, name, "slower" if ratio is None else self._about(ratio), ratio)

    @property
    def _bound(self) -> str:
        """The bound on the error, as the command has it."""
        if self.question.exact:
            return f"{EXACT_ERROR:g}, the most of an exact image"
        return f"--max-error, {self.question.max_error:.4g}"

    def _about(self, ratio: float) -> str:
        least = 2 ** math.floor(math.log2(max(1.0, ratio)))
        return f"{'up' if least == 1 else least} to {2 * least} times the time of the answer"

    @property
    def command(self) -> str:
        """The command that measures the winner in full."""
        name = self.best.method if self.best else ""
        return shlex.join(["mfr-bench", "run", self.config, "--only", name, "--set", "measure.eliminate=false"])

    def record(self) -> dict[str, Any]:
        """The answer as JSON."""
        best = self.best
        if best is None:
            return {"method": None, "params": None, "time_ms": None, "memory_bytes": None, "max_error": None,
                    "confidence": 0.0, "close": [], **self._left}
        return {"method": best.method, "params": chosen(best), "time_ms": best.row["time_ms"],
                "time_ms_low": best.row["time_ms_low"], "time_ms_high": best.row["time_ms_high"],
                "memory_bytes": best.row["memory_bytes"], "max_error": best.row["max_error_all"],
                "confidence": round(self.confidence, 4), "device": best.row["device"],
                "close": [self._rival(p) for p in self.close],
                **self._left, "command": self.command}

    def _rival(self, point: Point) -> dict[str, Any]:
        low, ratio, high = point.over(self.best)
        return {"method": point.method, "params": chosen(point), "time_ms": point.row["time_ms"], "ratio": ratio,
                "ratio_low": low, "ratio_high": high, "chance": round(self._chance(point), 4)}

    @property
    def marked(self) -> dict[str, Any]:
        """The part of a manifest by which figures mark the answer; empty where nothing keeps the bounds."""
        return {"key": self.best.cell["key"], "confidence": self._percents[0] / 100} if self.best else {}

    @property
    def _left(self) -> dict[str, Any]:
        return {"unsteady": self.result.unsteady or None, "cut": list(self.cut),
                "excluded": [{"method": each.method, "reason": each.reason, "ratio": each.ratio} for each in self.out]}

    def text(self, width: int) -> str:
        """The answer for people, at most `width` columns wide but for the command, which is one line."""
        lines = textwrap.wrap(f"Question: {self.question}.", width, break_on_hyphens=False)
        best = self.best
        if best is None:
            lines += textwrap.wrap(self._none, width, break_on_hyphens=False)
        else:
            lines += ["", *textwrap.wrap(f"Answer: {written(best)}", width, break_on_hyphens=False),
                      *self._figures(width)]
        for cut in self.cut:
            lines += textwrap.wrap(f"  cut for the time budget: {cut}", width, subsequent_indent="    ",
                                   break_on_hyphens=False)
        return "\n".join([*lines, "", *self._others(width)])

    def _figures(self, width: int) -> list[str]:
        best, row = self.best, self.best.row
        time = f"{data.number(row['time_ms'])} ms"
        if row["time_ms_low"] is not None:
            time += f" ({data.number(row['time_ms_low'])} to {data.number(row['time_ms_high'])})"
        memory = data.number(best.measure("memory_mib")[1])
        said = [f"  time {time}, memory {memory} MiB, largest error {row['max_error_all']:.3g}, on {row['device']}",
                f"  fastest{self._among} with a chance of {self._percents[0]} %"]
        said += [f"  {self._near}"]
        said += [f"  unsteady: {self.result.unsteady}"] if self.result.unsteady else []
        lines = [line for text in said for line in textwrap.wrap(text, width, subsequent_indent="    ",
                                                                 break_on_hyphens=False)]
        return [*lines, f"  in full: {self.command}"]  # in one line, to be copied

    @property
    def _near(self) -> str:
        """The methods of `close`, each with its ratio to the answer and its chance, and what is left of all chances."""
        _, *percents, others = self._percents
        named = "; ".join(f"{written(p)} ({_spread(p.over(self.best))} times, chance {_told(percent)})"
                          for p, percent in [*zip(self.close, percents, strict=True)][:MOST_SHOWN])
        if more := percents[MOST_SHOWN:]:
            named += f" and {len(more)} more, chance {_told(sum(more))} together"
        left = f"; the chance of all others together is {others} %" if others else ""
        return f"may be as fast: {named}{left}" if self.close else f"no other that was timed was as fast{left}"

    @property
    def _among(self) -> str:
        """The words for what the chance leaves out, where the time left some candidates untried."""
        return " of those that were tried" if self.untried else ""

    @property
    def untried(self) -> int:
        """The candidates that the time budget left without a sample."""
        return sum(each.group == UNTRIED for each in self.out)

    @property
    def failed_trials(self) -> list[str]:
        """The self-tests that the device fails, for which candidates have no time."""
        return list(dict.fromkeys(name for p in self.result.points for name in failed_trials(p.cell)))

    @property
    def _none(self) -> str:
        """The sentence for no answer."""
        if self.failed_trials:
            return ("No answer: the device fails self-tests without which any image may be wrong: "
                    f"{', '.join(self.failed_trials)}; see mfr-bench doctor.")
        if self.untried:
            return (f"No answer: {_candidates(self.untried)} not measured within the time budget, and nothing else "
                    "keeps these bounds. A larger --time-budget, or a machine that does nothing else, may tell.")
        return "Nothing keeps these bounds."

    def _others(self, width: int) -> list[str]:
        grouped: dict[str, list[str]] = {}
        for each in self.out:
            ratio = "" if each.ratio is None else f" ({data.number(each.ratio)})"
            grouped.setdefault(each.reason, []).append(f"{each.method}{ratio}")
        lines = ["Not chosen, the nearest to the answer first:"]
        for reason, methods in grouped.items():
            lines += textwrap.wrap(f"  {reason}: {_some(methods, ', ')}", width, subsequent_indent="    ",
                                   break_on_hyphens=False)
        return lines if self.out else []


def _some(names: Sequence[str], between: str) -> str:
    """The first of many names, and how many more there are."""
    more = f" and {len(names) - MOST_SHOWN} more" if len(names) > MOST_SHOWN else ""
    return f"{between.join(names[:MOST_SHOWN])}{more}"


def _spread(ratio: Interval) -> str:
    """`1.02 [0.97, 1.1]`; without its interval where too few frames were drawn for one."""
    low, middle, high = ratio
    ends = "" if low is None or high is None else f" [{data.number(low)}, {data.number(high)}]"
    return f"{data.number(middle)}{ends}"


def _candidates(count: int) -> str:
    return "a candidate was" if count == 1 else f"{count} candidates were"


def _told(percent: int) -> str:
    """A chance that a frame or the lack of frames gives is never none."""
    return f"{percent} %" if percent else "below 1 %"


def _left_early(point: Point) -> bool:
    return _stopped(point).startswith(("eliminated", "error above"))


def _stopped(point: Point) -> str:
    """Why no more frames of a point were drawn."""
    return str(point.row.get("stop_reason") or "")


def _reason(point: Point) -> str:
    """Why a point has no right image."""
    reason = point.row.get("reason")
    return NOT_TRIED if reason == LATE else f"{point.sign}: {reason or ''}".rstrip(": ")


def answer_of(question: Question, result: Result, excluded: Sequence[Excluded], config: str,
              cut: Sequence[str] = ()) -> Answer:
    """The answer of a finished race."""
    return Answer(question, result, tuple(excluded), config, tuple(cut))
