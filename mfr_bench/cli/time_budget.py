"""The time budget of a run: when measuring has to stop, what should fit before that, what it left out in the end."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from collections.abc import Set as AbstractSet
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ..run.jobs import Job

MANY = 6  # experiments, from which on processes that draw their figures are worth their start
MOST_LABELS = 6  # that are named one by one


def end_s(parts: Sequence, keys: AbstractSet[str], drawn: bool, calibrated_s: float, slowness: float) -> float:
    """Seconds that should follow the last of the cells of these keys, with those that have ended before.

    parts: experiments with their sheets. drawn: whether figures are. calibrated_s: of the first calibration. slowness:
    how many times as long the machine takes as a quiet one.
    """
    from ..environment import usable_cores
    from ..plan.ending import ending_s, reports_s

    cells = [len(part.sheet.statuses.keys() | (keys & part.sheet.jobs.keys())) for part in parts]
    told = [part for part, count in zip(parts, cells, strict=True) if count]
    figures = sum(len(part.experiment.figures) for part in told) if drawn else 0
    processes = (usable_cores() or 1) if len(parts) >= MANY else 1
    reports = reports_s(len(told), figures, sum(cells), processes, empty=len(parts) - len(told))
    return ending_s(reports, calibrated_s if keys else 0.0, slowness)


def stop_at(budget_s: float, begun: float, groups: Sequence[Sequence], parts: Sequence, drawn: bool,
            calibrated_s: float, slowness: float) -> float:
    """The time at which measuring has to stop, on the clock on which the command has `begun`.

    What follows is foretold for the cells that have ended and those that can be measured, in the groups' order.
    """
    from ..plan.budget import TimeBudget

    keys = {job.key for job in within_reach(groups, parts, budget_s, slowness)}
    return TimeBudget(budget_s, begun).deadline(end_s(parts, keys, drawn, calibrated_s, slowness))


def within_reach(groups: Sequence[Sequence[Job]], parts: Sequence, budget_s: float | None,
                 slowness: float) -> list[Job]:
    """The first of the cells to come, as many as can be measured within the budget at most; without one all of them.

    What the sheets of the parts know to be refused takes no time, and is none of them.
    """
    from ..plan.ending import measurable

    refused = {key for part in parts for key in part.sheet.refused}
    to_come = [job for group in groups for job in group if job.key not in refused]
    return to_come if budget_s is None else to_come[:measurable(len(to_come), budget_s, slowness)]


def refuse(parts: Sequence, limits) -> None:
    """Let the sheets know which cells the device, the method or the memory budget forbids."""
    from ..methods import catalog
    from ..plan import forbidden

    for part in parts:
        part.sheet.refused = forbidden({job.key: job.cell for job in part.sheet.pending}, catalog(), limits)


def time_left(reached: Sequence[Job], forecast, features, ends_s: float, slowness: float):
    """The time that a run of these cells will take, as a `TimeLeft`: for the run itself and for its dry run.

    features: of the device. ends_s: what follows the last of the cells.
    """
    from ..glsl.digest import code_of_programs
    from ..methods import catalog
    from ..methods.spec import Fitted
    from ..plan import expected_stats
    from ..plan.time_left import TimeLeft

    cells = {job.key: job.cell for job in reached}
    code = {key: code_of_programs(Fitted(catalog()[cell.method].variant(cell.params), expected_stats(cell.scene),
                                         features)) for key, cell in cells.items()}
    return TimeLeft(forecast, cells, {key: drawn for key, (drawn, _) in code.items()},
                    {key: counted for key, (_, counted) in code.items()}, ends_s, slowness, forecast.rates.looks_s)


def left_out(sheet) -> dict[str, int]:
    """Cells that the time budget left no time for, by label: those that may be measured."""
    labels = [job.cell.label for job in _left(sheet)]
    return {label: labels.count(label) for label in dict.fromkeys(labels)}


def _left(sheet) -> list[Job]:
    return [job for job in sheet.pending if job.key not in sheet.refused]


def refused_later(sheet) -> int:
    """Cells without a row that device, method or memory budget forbids: no time was left to write that down."""
    return len(sheet.pending) - len(_left(sheet))


def left_out_line(sheet) -> str:
    """What the time budget left out of an experiment, and how to measure it; empty where that is nothing."""
    if not (left := left_out(sheet)):
        return ""
    named = ", ".join(f"{label} {count}" for label, count in left.items()) if len(left) <= MOST_LABELS else (
        f"of {len(left)} methods")
    count = sum(left.values())
    return f"left out for the time budget: {count} {'cell' if count == 1 else 'cells'} ({named}); {_more([sheet])}"


def left_out_in_all(sheets: Mapping[str, object]) -> str:
    """The same of several experiments in one line, which names those of which nothing was measured."""
    planned = sum(len(sheet.jobs) - len(sheet.refused) for sheet in sheets.values())
    counts = [len(_left(sheet)) for sheet in sheets.values()]
    if not any(counts):
        return ""
    touched = f"{sum(map(bool, counts))} of {len(sheets)} configs"
    parts = [f"left out for the time budget: {sum(counts):,} of {planned:,} cells, of {touched}"]
    if untouched := [name for name, sheet in sheets.items() if not sheet.statuses]:
        parts.append(f"nothing is measured of {', '.join(untouched)}")
    return "; ".join([*parts, _more(list(sheets.values()))])


def _more(sheets: Sequence) -> str:
    """Tells how the rest comes: a command that measured nothing new would measure nothing the next time either."""
    if any(sheet.counts.total() > sheet.kept + sheet.copied for sheet in sheets):
        return "the same command measures them"
    return "none was finished in this time: with a larger --time-budget the same command measures them"
