"""Verdicts as text for a terminal, Markdown, CSV and JSON. Each shows the rule with what was measured."""

from __future__ import annotations

import json
import textwrap
from collections import Counter
from collections.abc import Iterable, Sequence

from ..markdown import markdown_table
from ..store import csv_text
from .verdict import VERDICTS, Verdict

COLUMNS = ("device", "id", "verdict", "reason", "decided_by", "source", "claim", "paper", "measured", "rule", "remark",
           "experiments")
LABEL = 9  # columns of the labels of the text form


def as_json(verdicts: Sequence[Verdict]) -> str:
    """A list with an object per claim and device; every comparison of every rule is in it."""
    return json.dumps([v.record() for v in verdicts], indent=2, ensure_ascii=False)


def as_csv(verdicts: Sequence[Verdict]) -> str:
    """A row per claim and device."""
    return csv_text(COLUMNS, map(_row, verdicts)).decode()


def _row(verdict: Verdict) -> dict[str, object]:
    record = verdict.record()
    return record | {"measured": "\n".join(f.text for f in verdict.findings) or None,
                     "rule": "\n".join(rule.text for rule in verdict.claim.rules),
                     "experiments": " ".join(verdict.claim.experiments)}


def as_text(verdicts: Sequence[Verdict], width: int) -> str:
    """A paragraph per claim, device by device, and how many hold."""
    parts = []
    for device, of_device in _by_device(verdicts):
        parts += [device, *(_paragraph(v, width) for v in of_device), textwrap.fill(_counts(device, of_device), width)]
    return "\n\n".join(parts)


def _paragraph(verdict: Verdict, width: int) -> str:
    return "\n".join([textwrap.fill(f"{verdict.claim.id}: {verdict.verdict}", width),
                      *(_labelled(label, text, width) for label, text in _lines(verdict))])


def _labelled(label: str, text: str, width: int) -> str:
    return textwrap.fill(text, width, initial_indent=f"  {label:{LABEL - 2}}", subsequent_indent=" " * LABEL,
                         break_on_hyphens=False)


def _lines(verdict: Verdict) -> Iterable[tuple[str, str]]:
    """The lines of a verdict, each with its label; a measurement follows its rule."""
    claim = verdict.claim
    yield "claim", claim.sentence
    yield "source", claim.source
    yield "paper", claim.paper
    if verdict.reason:
        yield "why", verdict.reason
    if claim.reading:
        yield "read", claim.reading
    if verdict.decided_by:
        yield "but", verdict.decided_by
    for rule, finding in zip(claim.rules, verdict.findings or [None] * len(claim.rules), strict=True):
        yield "rule", rule.text
        if finding:
            yield "here", finding.text
    if claim.remark:
        yield "note", claim.remark


def _by_device(verdicts: Iterable[Verdict]) -> list[tuple[str, list[Verdict]]]:
    found: dict[str, list[Verdict]] = {}
    for verdict in verdicts:
        found.setdefault(verdict.device, []).append(verdict)
    return list(found.items())


def _counts(device: str, verdicts: Iterable[Verdict]) -> str:
    counts = Counter(v.verdict for v in verdicts)
    return f"{device}, {counts.total()} claims: " + ", ".join(f"{name} {counts[name]}" for name in VERDICTS)


def as_markdown(verdicts: Sequence[Verdict]) -> str:
    """A table of the verdicts for each device, then every claim with its rules and what was measured."""
    parts = []
    for device, of_device in _by_device(verdicts):
        table = markdown_table(("claim", "source", "verdict", "what it says"),
                               ((v.claim.id, v.claim.source, v.verdict, v.claim.sentence) for v in of_device))
        parts += [f"## Claims on {device}", _counts(device, of_device), "\n".join(table), *map(_section, of_device)]
    return "\n\n".join(parts)


def _section(verdict: Verdict) -> str:
    return "\n".join([f"### {verdict.claim.id}", "", f"**{verdict.verdict}**", "",
                      *(f"- {label}: {text}" for label, text in _lines(verdict))])


def as_matrix(verdicts: Sequence[Verdict]) -> str:
    """A Markdown table, a row per claim and a column per device, with on how many devices each verdict stands."""
    devices = list(dict.fromkeys(v.device for v in verdicts))
    found: dict[str, dict[str, str]] = {}
    for verdict in verdicts:
        found.setdefault(verdict.claim.id, {})[verdict.device] = verdict.verdict
    head = ["claim", *VERDICTS, *devices]
    rows = [[claim, *(str(list(on.values()).count(name)) for name in VERDICTS), *(on.get(d, "") for d in devices)]
            for claim, on in found.items()]
    return "\n".join(markdown_table(head, rows))
