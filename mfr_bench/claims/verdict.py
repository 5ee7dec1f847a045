"""A claim, and its verdict on one device."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

from ..report.data import bare, heading
from .evidence import Evidence, Outcome
from .rules import Rule
from .runs import Run

HOLDS, FAILS, NOT_TESTABLE = "holds", "does not hold", "not testable here"
VERDICTS = (HOLDS, FAILS, NOT_TESTABLE)
ALWAYS_SHOWN = ("size", "depth_complexity", "k")  # where the deciding comparison was made


@dataclass(frozen=True)
class Reading:
    """Another way to read a sentence, in words, and the rules by which it is tested then."""

    words: str
    rules: tuple[Rule, ...]


@dataclass(frozen=True)
class Claim:
    """One sentence that a paper states, and how it is tested.

    It holds where every rule does, and fails where one does. `experiments` are the configs of which any one can show
    it. `reading` says how `rules` read what the text leaves open, `otherwise` holds its other readings: they are
    judged as well, and a verdict says if they differ. `hardware` says what a software driver lacks of that to
    which the paper attributes the finding; `gpu_timer` marks what is too short to be timed between two finishes.
    `remark` is what differs from the paper.
    """

    id: str
    source: str
    sentence: str
    paper: str
    experiments: tuple[str, ...]
    rules: tuple[Rule, ...]
    hardware: str = ""
    gpu_timer: bool = False
    remark: str = ""
    reading: str = ""
    otherwise: tuple[Reading, ...] = ()


@dataclass(frozen=True)
class Finding:
    """The outcome of one rule in the runs of a device."""

    rule: Rule
    comparisons: tuple[Evidence, ...]

    @property
    def tested(self) -> tuple[Evidence, ...]:
        return tuple(c for c in self.comparisons if c.outcome is not Outcome.LEFT_OUT)

    @property
    def absent(self) -> tuple[str, ...]:
        """Methods that the rule speaks of and that no cell here is of."""
        found = {method for c in self.comparisons for method in c.at["methods"]}
        return tuple(method for method in self.rule.each if method not in found)

    @property
    def outcome(self) -> Outcome:
        """The worst outcome, for a rule speaks of all its cells; unclear where some or all are missing."""
        outcomes = {c.outcome for c in self.tested}
        if Outcome.FAILS in outcomes:
            return Outcome.FAILS
        return Outcome.HOLDS if outcomes == {Outcome.HOLDS} and not self.absent else Outcome.UNCLEAR

    @property
    def deciding(self) -> Evidence | None:
        """The comparison that is furthest from holding, of those with the rule's outcome."""
        return min((c for c in self.tested if c.outcome is self.outcome), key=lambda c: c.margin, default=None)

    @property
    def reason(self) -> str:
        """The reason why the rule is unclear."""
        if self.outcome is not Outcome.UNCLEAR:
            return ""
        if self.deciding:
            return f"{self.deciding.what}: {self.deciding.reason}"
        if self.tested:
            return f"no cells of {', '.join(self.absent)}"
        return self.left_out or f"no cells of {self.rule.needs}"

    @property
    def left_out(self) -> str:
        reasons = dict.fromkeys(c.reason for c in self.comparisons if c.outcome is Outcome.LEFT_OUT)
        return "; ".join(list(reasons)[:1]) + (f" (and {len(reasons) - 1} like it)" if len(reasons) > 1 else "")

    @property
    def text(self) -> str:
        """The measurement in words: 'holds: kb-ps / kplus-heap 3.12 [3.01, 3.20] at 1024×1024, n 128, k 64'."""
        found = self.deciding or next(iter(self.tested), None)
        if found is None:
            return self.reason
        parts = [f"{found.what} {found.text}".rstrip() + self._place(found)]
        if len(self.tested) > 1:
            parts.append(f"{sum(c.outcome is found.outcome for c in self.tested)} of {len(self.tested)} comparisons")
        parts += [part for part in (found.reason, self.left_out and f"left out: {self.left_out}",
                                    self.absent and f"no cells of {', '.join(self.absent)}") if part]
        return f"{self.outcome.value}: " + "; ".join(parts)

    def _place(self, found: Evidence) -> str:
        names = [n for n in found.at if n != "methods" and (n in ALWAYS_SHOWN or self._varies(n))]
        shown = [heading(n, found.at[n], " ") if bare(n) != "size" else "×".join(map(str, found.at[n]))
                 for n in names if found.at[n] is not None]
        return f" at {', '.join(shown)}" if shown else ""

    def _varies(self, name: str) -> bool:
        return all(name in c.at for c in self.tested) and len({c.at[name] for c in self.tested}) > 1


@dataclass(frozen=True)
class Verdict:
    claim: Claim
    device: str
    verdict: str
    reason: str  # why it is not testable, else empty
    findings: tuple[Finding, ...]
    others: tuple[tuple[Reading, str, tuple[Finding, ...]], ...] = ()  # each other reading, its verdict and findings

    @property
    def decided_by(self) -> str:
        """The reading of the sentence, if another reading that can be tested has another verdict."""
        apart = [f"'{reading.words}': {verdict}" for reading, verdict, _ in self.others
                 if verdict not in (self.verdict, NOT_TESTABLE)]
        return f"the reading decides: '{self.claim.reading}', but by {'; by '.join(apart)}" if apart else ""

    def record(self) -> dict[str, Any]:
        """The verdict as JSON knows it."""
        claim = self.claim
        return {"device": self.device, "id": claim.id, "source": claim.source, "claim": claim.sentence,
                "paper": claim.paper, "experiments": list(claim.experiments), "verdict": self.verdict,
                "reason": self.reason or None, "remark": claim.remark or None, "reading": claim.reading or None,
                "decided_by": self.decided_by or None,
                "rules": [self._rule_record(rule) for rule in claim.rules],
                "otherwise": [{"reading": reading.words, "verdict": verdict, "measured": [f.text for f in findings]}
                              for reading, verdict, findings in self.others]}

    def _rule_record(self, rule: Rule) -> dict[str, Any]:
        """A rule with what was found of it; nothing but the rule where its experiment was not measured."""
        found = next((f for f in self.findings if f.rule is rule), None)
        if found is None:
            return {"rule": rule.text, "outcome": None, "measured": None, "comparisons": []}
        return {"rule": rule.text, "outcome": found.outcome.value, "measured": found.text,
                "comparisons": [_record(c) for c in found.comparisons]}


def _record(comparison: Evidence) -> dict[str, Any]:
    low, value, high = comparison.interval
    return {"what": comparison.what, "at": dict(comparison.at), "value": value, "low": low, "high": high,
            "exact": comparison.exact, "outcome": comparison.outcome.value, "reason": comparison.reason or None,
            "folder": comparison.folder}


def judge_all(claims: Iterable[Claim], runs: Sequence[Run]) -> list[Verdict]:
    """Every claim on every device, device by device in the order of the runs."""
    claims = list(claims)
    devices = dict.fromkeys(run.device for run in runs)
    return [judge(claim, device, [r for r in runs if r.device == device]) for device in devices for claim in claims]


def judge(claim: Claim, device: str, runs: Sequence[Run]) -> Verdict:
    """The verdict on a device from its runs, those of other experiments included."""
    mine = [run for run in runs if run.experiment in claim.experiments]
    if not any(run.points for run in mine):
        return Verdict(claim, device, NOT_TESTABLE, f"not measured: {' or '.join(claim.experiments)}", ())
    findings = _findings(claim.rules, mine)
    verdict, reason = _verdict(claim, mine, findings)
    others = []
    for reading in claim.otherwise:
        found = _findings(reading.rules, mine)
        others.append((reading, _verdict(claim, mine, found)[0], found))
    return Verdict(claim, device, verdict, reason, findings, tuple(others))


def _findings(rules: Sequence[Rule], runs: Sequence[Run]) -> tuple[Finding, ...]:
    return tuple(Finding(rule, tuple(c for run in runs for c in rule.compare(run))) for rule in rules)


def _verdict(claim: Claim, runs: Sequence[Run], findings: Sequence[Finding]) -> tuple[str, str]:
    if claim.hardware and all(run.software for run in runs):
        return NOT_TESTABLE, f"a software driver cannot show it: {claim.hardware}"
    if claim.gpu_timer and not _gpu_timed(runs):
        return NOT_TESTABLE, "timed between two finishes, whose own cost is of the size of these passes"
    if any(f.outcome is Outcome.FAILS for f in findings):
        return FAILS, ""
    unclear = [f.reason for f in findings if f.outcome is Outcome.UNCLEAR]
    return (NOT_TESTABLE, "; ".join(dict.fromkeys(unclear))) if unclear else (HOLDS, "")


def _gpu_timed(runs: Sequence[Run]) -> bool:
    timers = {point.row["timer"] for run in runs for point in run.points} - {None}
    return timers == {"gpu"}
