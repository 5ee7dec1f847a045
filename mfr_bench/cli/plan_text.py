"""`run --dry-run`: what would be measured, what not, and why."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from .output import note, place, say_lines
from .session import Choices, Part, forecast_of, result_folders, sources
from .time_budget import end_s, refuse, stop_at, time_left, within_reach

NO_TIME = "left out: the time budget ends before it, by the forecast"


def print_plans(plans, supervisor, choices: Choices, started: float) -> None:
    """Print the plan of each experiment; without a device as far as it goes.

    started: the time of the performance counter at which the command began.
    """
    from ..errors import DeviceError, UnknownDeviceError
    from ..methods import catalog
    from ..plan import overview
    from ..run.jobs import jobs

    try:
        ready = supervisor.ready()
    except UnknownDeviceError:
        raise
    except DeviceError as error:
        ready = None
        note(f"{error}; the plan below holds only the budget against the cells")
    folders = result_folders(plans, choices.out, ready.device["slug"] if ready else "unknown-device")
    beside = sources(plans, folders, choices)
    forecast = _forecast((*folders, *beside), ready) if ready else None
    limits = ready.limits if ready else None
    rows = [overview(cells, catalog(), limits) for _, cells in plans]
    if ready:
        codes: dict[Any, str] = {}
        todo = [jobs(cells, catalog(), ready.device, ready.timer, codes) for _, cells in plans]
        sheets = _decide(rows, todo, folders, beside, choices)
        if choices.budget_s is not None:
            _hold_to_time(rows, todo, _parts(plans, sheets), forecast, choices, ready, started)
    to_come: list[Any] = []
    for (experiment, cells), folder, decided in zip(plans, folders, rows, strict=True):
        if not cells:
            continue
        measured = [cell for cell, row in zip(cells, decided, strict=True) if row["decision"] == "measure"]
        predicted = _predicted(forecast, measured, choices.budget_s)
        say_lines(_plan_text(experiment, decided, folder, predicted) + "\n" * (len(plans) > 1))
        to_come += measured
    if len(plans) > 1 and forecast:
        say_lines(f"{len(to_come)} cells to measure in all: {forecast.run(to_come).within(choices.budget_s).text}")
    if choices.budget_s is not None and forecast:
        say_lines(_held_line(plans, rows, choices.budget_s))


def _parts(plans, sheets) -> list[Part]:
    """The experiments that have cells."""
    return [Part(experiment, sheet, {}) for (experiment, cells), sheet in zip(plans, sheets, strict=True) if cells]


def _hold_to_time(rows, todo, parts: Sequence[Part], forecast, choices: Choices, ready, started: float) -> None:
    """Write into the rows which cells the time budget leaves no time for, in the order in which the run takes them.

    The start of the run should take as long as that of this command has.
    """
    from ..environment import slowness
    from ..run.ledger import groups_of

    sheets, slow = [part.sheet for part in parts], slowness()
    refuse(parts, ready.limits)
    groups = groups_of(sheets, [[job.key for job in sheet.pending] for sheet in sheets], coarse_first=True)
    stop = stop_at(choices.budget_s, started, groups, parts, choices.drawn, ready.calibrated_s, slow)
    reached = within_reach(groups, parts, choices.budget_s, slow)
    ends_s = end_s(parts, {job.key for job in reached}, choices.drawn, ready.calibrated_s, slow)
    left = time_left(reached, forecast, ready.limits.features, ends_s, slow)
    fits = set(left.within(stop - time.perf_counter()))
    for own, each in zip(rows, todo, strict=True):
        for row, job in zip(own, each, strict=True):
            if row["decision"] == "measure" and job.key not in fits:
                row["decision"] = NO_TIME


def _held_line(plans, rows: Sequence[Sequence[Mapping[str, Any]]], budget_s: float) -> str:
    """What the time budget should leave time for."""
    from .progress import exact_duration

    decisions = [[row["decision"] for row in own] for own in rows]
    fits, late = (sum(own.count(what) for own in decisions) for what in ("measure", NO_TIME))
    begun = sum("measure" in own for own in decisions)
    if not late:
        return f"all of it should fit the time budget of {exact_duration(budget_s)}"
    of = f", of {begun} of {sum(bool(cells) for _, cells in plans)} configs" if len(plans) > 1 else ""
    return (f"in the time budget of {exact_duration(budget_s)} there should be time for {fits:,} of "
            f"{fits + late:,} cells{of}; the same command, repeated, measures the others")


def _predicted(forecast, cells: Sequence[Any], budget_s: float | None) -> list[str]:
    return [f"  predicted: {forecast.run(cells).within(budget_s).text}"] if forecast and cells else []


def _forecast(known, ready):
    """The forecast by results of the device: of the run, of the folders next to it, and of those below results/."""
    from ..run.ledger import relatives

    return forecast_of([*known, *relatives(Path("results") / ready.device["slug"], known)], ready)


def _decide(rows: Sequence[list[dict[str, Any]]], todo, folders, beside, choices: Choices):
    """Write into the rows what becomes of the cells that neither device nor budget forbids, as the run decides it.

    rows, todo, folders: of each experiment its rows, its jobs and its folder. beside: other folders with cells.
    Returns the sheets, as they are before the first cell is measured.
    """
    from ..run.settling import settled
    from ..run.sheet import Sheet

    sheets = [Sheet(folder, each) for folder, each in zip(folders, todo, strict=True)]
    found = settled(sheets, beside, choices.force, choices.keep_failed, choices.try_hopeless)
    first: dict[str, Any] = {}  # the cell that is measured, by key
    for own, decided, each in zip(rows, found, todo, strict=True):
        for row, job in zip(own, each, strict=True):
            if row["decision"] == "measure":
                row["decision"] = _decision(job, decided.get(job.key), first)
    for sheet, decided in zip(sheets, found, strict=True):
        sheet.statuses |= dict.fromkeys(decided, "kept")
    return sheets


def _decision(job, why, first: dict[str, Any]) -> str:
    from ..run.settling import Copied, Kept, LeftOut

    match why:
        case Kept():
            return "kept: already measured"
        case Copied(source=source):
            return f"copied from {source.path}"
        case LeftOut(reason=reason):
            return f"timeout: {reason}"
    other = first.setdefault(job.key, job.cell)
    if other is job.cell:
        return "measure"
    return f"shared with {other.label if other.experiment == job.cell.experiment else other.experiment}"


def _plan_text(experiment, rows: list[dict[str, Any]], folder, predicted: list[str]) -> str:
    title = f": {experiment.title}" if experiment.title != experiment.name else ""
    lines = [f"{experiment.name}{title}", f"  {len(rows)} cells -> {folder.path}", *predicted]
    label = max(len(r["label"]) for r in rows)
    where = [place(r["point"]) for r in rows]
    longest = max(map(len, where))
    lines += [f"  {r['label']:{label}}  {w:{longest}}  {r['memory_bytes'] / 2**20:10,.2f} MiB  {r['decision']}"
              for r, w in zip(rows, where, strict=True)]
    measured, late = (sum(r["decision"] == what for r in rows) for what in ("measure", NO_TIME))
    later = f", {late} for lack of time" if late else ""
    return "\n".join([*lines, f"  {measured} to measure, {len(rows) - measured} not{later}"])
