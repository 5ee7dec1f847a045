"""A comparison as text for a terminal, Markdown, CSV and JSON."""

from __future__ import annotations

import json
import textwrap
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from ..report.data import number, percent
from ..report.machine import Case, Outcome
from ..report.tables import Grid
from ..stats import Interval
from ..store import csv_text
from .judge import MISSING, SAME, SLOWER, UNCLEAR, VERDICTS, CellVerdict, Comparison
from .sides import Entry

COLUMNS = ("experiment", "name", "method", "params", "scene", "verdict", "reason", "before_ms", "after_ms", "ratio",
           "ratio_low", "ratio_high", "raw_ratio", "changes")
NOTE = ("after / before, with the interval that holds it for all cells at once; what all methods of a scene have in "
        "common is taken out")
ABSOLUTE_NOTE = "after / before, with the interval that holds it for all cells at once"
TOGETHER_NOTE = "the mean of the ratios of several cells: a change that they share shows where that of one does not"
NAME_WIDTH = 36
MOST_LISTED = 10


def as_json(found: Comparison) -> str:
    """Everything: one object per cell, those of one side too; what is missing; the environments' differences."""
    return json.dumps({
        "before": found.before.path, "after": found.after.path, "threshold": found.threshold,
        "noise_floor_rel": found.floor, "absolute": found.absolute, "common_ratio": found.common,
        "counts": {name: found.counts.get(name, 0) for name in VERDICTS}, "regressed": found.regressed,
        "doubtful": found.doubtful, "environment": found.environment,
        "missing_before": [f"{e.experiment}: {e.name}" for e in found.missing_before],
        "missing_after": [f"{e.experiment}: {e.name}" for e in found.missing_after],
        "untold": found.untold, "together": [each.record() for each in found.together],
        "cells": found.records()}, indent=2, ensure_ascii=False)


def as_csv(found: Comparison) -> str:
    """A row per cell of either side."""
    return csv_text(COLUMNS, (record | {"changes": "; ".join(c["what"] for c in record["changes"]) or None}
                              for record in found.records())).decode()


def as_text(found: Comparison, width: int, whole: bool = False) -> str:
    """The text of what differs, what is missing, and how the machines differ; with `whole` every cell."""
    parts = ["\n".join(textwrap.fill(line, width) for line in _about(found))]
    parts += ["\n".join([grid.title, *textwrap.wrap(f"({grid.note})", width),
                         "\n\n".join(chunk.text() for chunk in grid.chunks(width))]) for grid in _grids(found, whole)]
    for title, lines in _lists(found):
        parts.append("\n".join([title, *(part for line in lines for part in textwrap.wrap(
            line, width, initial_indent="- ", subsequent_indent="  ", break_on_hyphens=False))]))
    return "\n\n".join([*parts, textwrap.fill(_end(found), width)])


def as_markdown(found: Comparison, whole: bool = False) -> str:
    title, *about = _about(found)
    parts = [f"# {title}", *about]
    for grid in _grids(found, whole):
        parts += [f"## {grid.title}", grid.note, grid.markdown()]
    for title, lines in _lists(found):
        parts += [f"## {title}", "\n".join(f"- {line}" for line in lines)]
    return "\n\n".join([*parts, f"**{_end(found)}**"])


def as_cases(found: Comparison) -> list[Case]:
    """Each cell as a test case: slower or worse is a failure, missing an error, unclear skipped."""
    return [Case(record["experiment"], record["name"], *_outcome(record), (record["after_ms"] or 0.0) / 1e3)
            for record in found.records()] + [
                Case("together", each.name, *_outcome(each.record() | {"changes": []}), 0.0) for each in found.together]


def _outcome(record: Mapping[str, Any]) -> tuple[Outcome, str]:
    worse = [change["what"] for change in record["changes"] if change["worse"]]
    slower = record["verdict"] == SLOWER
    if slower or worse:
        by = [f"{record['ratio']:.3f} times the time [{record['ratio_low']:.3f}, {record['ratio_high']:.3f}]"]
        return "failure", "; ".join([*(by if slower else []), *worse])
    if record["verdict"] == MISSING:
        return "error", record["reason"]
    return ("skipped", record["reason"] or "") if record["verdict"] == UNCLEAR else ("passed", "")


def _about(found: Comparison) -> list[str]:
    noises = (found.before.noise, found.after.noise)
    floors = "noise floors {} and {}".format(*("unknown" if n is None else percent(n) for n in noises))
    lines = [f"{found.before.path} -> {found.after.path}",
             f"differences below {100 * found.threshold:.3g} % do not matter; {floors}"]
    if found.common:
        low, high = (percent(ratio - 1, "+") for ratio in found.common)
        span = low if low == high else f"{low} to {high}, by scene"
        taken = "counted as theirs" if found.absolute else "taken out: another load or clock does the same"
        lines.append(f"all methods together {span}: {taken}")
    return lines


def _grids(found: Comparison, whole: bool) -> list[Grid]:
    grids = []
    for experiment in dict.fromkeys(v.experiment for v in found.verdicts):
        shown = [v for v in found.verdicts if v.experiment == experiment and (whole or v.verdict not in (SAME, None))]
        shown.sort(key=lambda v: VERDICTS.index(v.verdict) if v.verdict else len(VERDICTS))
        rows = tuple(_row(v) for v in shown)
        if rows:
            grids.append(Grid(experiment, ABSOLUTE_NOTE if found.absolute else NOTE,
                              ("cell", "verdict", "before, ms", "after, ms", "ratio"), rows, left=2))
    several = tuple((each.name, each.verdict, _interval(each.ratio)) for each in found.together
                    if whole or each.verdict != SAME)
    if several:
        grids.append(Grid("Together", TOGETHER_NOTE, ("cells", "verdict", "ratio"), several, left=2))
    return grids


def _row(verdict: CellVerdict) -> tuple[str, ...]:
    name = verdict.name if len(verdict.name) <= NAME_WIDTH else f"{verdict.name[:NAME_WIDTH - 1]}…"
    return (name, verdict.verdict or "-", number(verdict.before.point.row["time_ms"]),
            number(verdict.after.point.row["time_ms"]), _interval(verdict.ratio))


def _interval(ratio: Interval) -> str:
    low, middle, high = ratio
    return "" if middle is None else f"{middle:.3f} [{low:.3f}, {high:.3f}]"


def _lists(found: Comparison) -> Iterable[tuple[str, list[str]]]:
    changes = [f"{_sign(c.worse)}{v.experiment}: {v.name}: {c.text}" for v in found.verdicts for c in v.changes
               if not c.trials]
    changes += _of_devices(found)
    why = Counter(f"{v.verdict}: {v.reason}" for v in found.verdicts if v.reason)
    unsteady = [*found.before.unsteady, *found.after.unsteady]
    for title, lines in (("Why", [f"{count} {reason}" for reason, count in why.most_common()]),
                         ("Images, memory and status", changes),
                         (f"{MISSING}: only in {found.before.path}", _named(found.missing_after)),
                         (f"{MISSING}: only in {found.after.path}", _named(found.missing_before)),
                         ("Where they were measured", found.environment), ("Unsteady runs", unsteady)):
        if lines:
            yield title, lines


def _of_devices(found: Comparison) -> list[str]:
    """A line for all cells that have another status because their device fails self-tests."""
    cells = Counter(c for v in found.verdicts for c in v.changes if c.trials)
    return [f"{_sign(c.worse)}{count} {'cell' if count == 1 else 'cells'}: {c.text}, where the device fails the "
            f"{'trial' if len(c.trials) == 1 else 'trials'} {', '.join(c.trials)}: see mfr-bench doctor"
            for c, count in cells.most_common()]


def _sign(worse: bool | None) -> str:
    return "" if worse is None else "WORSE " if worse else "better "


def _named(entries: Sequence[Entry]) -> list[str]:
    names = [f"{e.experiment}: {e.name}" for e in entries]
    return [*names[:MOST_LISTED], *([f"… and {len(names) - MOST_LISTED} more"] if names[MOST_LISTED:] else [])]


def _end(found: Comparison) -> str:
    counts = ", ".join(f"{found.counts.get(name, 0)} {name}" for name in VERDICTS)
    worse = sum(any(c.worse for c in v.changes) for v in found.verdicts)
    total = len(found.records())
    parts = [f"{total} {'cell' if total == 1 else 'cells'}: {counts}"]
    slower = [each.name for each in found.together if each.verdict == SLOWER]
    if slower:
        parts.append(f"{SLOWER} together: {', '.join(slower)}")
    if worse:
        parts.append(f"{worse} worse in image, memory or status")
    if found.moved and not found.absolute:
        parts.append("the machine as a whole moved, which may be the driver: --absolute counts it as the methods'")
    return "; ".join(parts)
