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
from ..report.data import Point, Result
from ..store import failed_trials
from .candidates import NOT_FINISHED, NOT_TRIED, Excluded
from .question import Question

CLOSE = 1.05  # times the winner's time, up to which others are named
TIMED, UNTRIED, FAILED, EXCLUDED = range(4)  # methods that were not chosen, the nearest to the answer first
MOST_SHOWN = 8  # lines of a list in the text form


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
        """The chance of each finalist to be the fastest of all: what dropping the fastest may take is in it."""
        race = Elimination([p.cell["key"] for p in self._in_the_end])
        samples = {p.cell["key"]: p.cell["samples_ms"] for p in self._in_the_end}
        for times in zip(*samples.values(), strict=False):
            race.rounds.append(dict(zip(samples, times, strict=True)))
        found = race.chances() if race.rounds else {}
        return {key: (1 - CHANCE) * chance for key, chance in found.items()}

    @property
    def confidence(self) -> float:
        """The chance that `best` is the fastest."""
        return self.chances.get(self.best.cell["key"], 0.0) if self.best else 0.0

    @property
    def close(self) -> list[tuple[Point, float]]:
        """The other finalists that take no more than 5 % longer than `best`, with the ratio of their times to its."""
        others = [(p, p.over(self.best)[1]) for p in self.finalists[1:]] if self.best else []
        return [(p, ratio) for p, ratio in others if ratio is not None and ratio <= CLOSE]

    @property
    def out(self) -> list[tuple[str, str]]:
        """Every method that did not win nor come close, with the reason: the nearest to the answer first.

        That is, those that were timed, by their time; those that the time budget left untried; those that the device
        or the memory forbids or that failed; and those that are excluded by what they declare.
        """
        named = {p.cell["key"] for p in (*self.finalists[:1], *(p for p, _ in self.close))}
        others = [self._placed(p) for p in self.result.points if p.cell["key"] not in named and not data.is_floor(p)]
        others += [(UNTRIED if each.reason in (NOT_TRIED, NOT_FINISHED) else EXCLUDED, 0.0, each.method, each.reason)
                   for each in self.excluded]
        return [(method, reason) for *_, method, reason in sorted(others, key=lambda entry: entry[:2])]

    def _placed(self, point: Point) -> tuple[int, float, str, str]:
        """Which of the groups of `out` a point is in, its time there, its label and the reason.

        Of a finalist the reason has the ratio of its time to that of the answer, in powers of two.
        """
        reason = _reason(point)
        if point.status != "ok":
            return UNTRIED if reason == NOT_TRIED else FAILED, 0.0, point.label, reason
        ratio = point.over(self.best)[1] if self.best else None
        if any(point is each for each in self.finalists):
            reason = f"slower when the time was up{'' if ratio is None else f': {self._about(ratio)}'}"
        return TIMED, math.inf if ratio is None else ratio, point.label, reason

    def _about(self, ratio: float) -> str:
        least = 2 ** math.floor(math.log2(max(1.0, ratio)))
        return f"{CLOSE if least == 1 else least} to {2 * least} times the time of {self.best.label}"

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
                "close": [{"method": p.method, "params": chosen(p), "time_ms": p.row["time_ms"], "ratio": ratio}
                          for p, ratio in self.close],
                **self._left, "command": self.command}

    @property
    def marked(self) -> dict[str, Any]:
        """The part of a manifest by which figures mark the answer; empty where nothing keeps the bounds."""
        return {"key": self.best.cell["key"], "confidence": round(self.confidence, 4)} if self.best else {}

    @property
    def _left(self) -> dict[str, Any]:
        return {"cut": list(self.cut), "excluded": [{"method": m, "reason": r} for m, r in self.out]}

    def text(self, width: int) -> str:
        """The answer for people, at most `width` columns wide."""
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
                f"  fastest{self._among} with a chance of {data.percent(self.confidence)}"]
        near = "; ".join(f"{written(p)} ({ratio:.3f} times, chance {data.percent(self.chances[p.cell['key']])})"
                         for p, ratio in self.close)
        said += [f"  no more than 5 % slower: {near}" if near else "  all others are more than 5 % slower",
                 f"  in full: {self.command}"]
        return [line for text in said for line in textwrap.wrap(text, width, subsequent_indent="    ",
                                                                break_on_hyphens=False)]

    @property
    def _among(self) -> str:
        """The words for what the chance leaves out, where the time left some candidates untried."""
        return " of those that were tried" if self.untried else ""

    @property
    def untried(self) -> int:
        """The candidates that the time budget left without a sample."""
        return sum(reason in (NOT_TRIED, NOT_FINISHED) for _, reason in self.out)

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
        for method, reason in self.out:
            grouped.setdefault(reason, []).append(method)
        lines = ["Not chosen:"]
        for reason, methods in grouped.items():
            names = ", ".join(methods[:MOST_SHOWN]) + (f" and {len(methods) - MOST_SHOWN} more"
                                                       if len(methods) > MOST_SHOWN else "")
            lines += textwrap.wrap(f"  {names}: {reason}", width, subsequent_indent="    ", break_on_hyphens=False)
        return lines if self.out else []


def _candidates(count: int) -> str:
    return "a candidate was" if count == 1 else f"{count} candidates were"


def _left_early(point: Point) -> bool:
    return str(point.row.get("stop_reason") or "").startswith(("eliminated", "error above"))


def _reason(point: Point) -> str:
    if point.row.get("reason") == LATE:
        return NOT_TRIED
    if point.status != "ok":
        return f"{point.sign}: {point.row.get('reason') or ''}".rstrip(": ")
    return str(point.row.get("stop_reason") or "")


def answer_of(question: Question, result: Result, excluded: Sequence[Excluded], config: str,
              cut: Sequence[str] = ()) -> Answer:
    """The answer of a finished race."""
    return Answer(question, result, tuple(excluded), config, tuple(cut))
