"""`run --dry-run`: what would be measured, what not, and why."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from .output import note, place, say_lines
from .session import Choices, forecast_of, result_folders, sources


def print_plans(plans, supervisor, choices: Choices) -> None:
    """Print the plan of each experiment; without a device as far as it goes."""
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
        _decide(rows, [jobs(cells, catalog(), ready.device, ready.timer, codes) for _, cells in plans], folders, beside,
                choices)
    to_come: list[Any] = []
    for (experiment, cells), folder, decided in zip(plans, folders, rows, strict=True):
        if not cells:
            continue
        measured = [cell for cell, row in zip(cells, decided, strict=True) if row["decision"] == "measure"]
        say_lines(_plan_text(experiment, decided, folder, _predicted(forecast, measured)) + "\n" * (len(plans) > 1))
        to_come += measured
    if len(plans) > 1 and forecast:
        say_lines(f"{len(to_come)} cells to measure in all: {forecast.run(to_come).text}")


def _predicted(forecast, cells: Sequence[Any]) -> list[str]:
    return [f"  predicted: {forecast.run(cells).text}"] if forecast and cells else []


def _forecast(known, ready):
    """The forecast by results of the device: of the run, of the folders next to it, and of those below results/."""
    from ..run.ledger import relatives

    return forecast_of([*known, *relatives(Path("results") / ready.device["slug"], known)], ready)


def _decide(rows: Sequence[list[dict[str, Any]]], todo, folders, beside, choices: Choices) -> None:
    """Write into the rows what becomes of the cells that neither device nor budget forbids, as the run decides it.

    rows, todo, folders: of each experiment its rows, its jobs and its folder. beside: other folders with cells.
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
    measured = sum(r["decision"] == "measure" for r in rows)
    return "\n".join([*lines, f"  {measured} to measure, {len(rows) - measured} not"])
