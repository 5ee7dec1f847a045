"""`run --dry-run`: what would be measured, what not, and why."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from .output import note, place, say
from .session import Choices, result_folders, sources


def print_plans(plans, supervisor, choices: Choices) -> None:
    """Print the plan of each experiment; without a device as far as it goes."""
    from ..errors import DeviceError
    from ..methods import catalog
    from ..plan import overview
    from ..run.jobs import jobs

    try:
        ready = supervisor.ready()
    except DeviceError as error:
        ready = None
        note(f"{error}; the plan below holds only the budget against the cells")
    folders = result_folders(plans, choices.out, ready.device["slug"] if ready else "unknown-device")
    beside = sources(plans, folders, choices)
    shared: dict[str, str] = {}
    codes: dict[Any, str] = {}
    forecast = _forecast((*folders, *beside), ready) if ready else None
    to_come: list[Any] = []
    for (experiment, cells), folder in zip(plans, folders, strict=True):
        if not cells:
            continue
        rows = overview(cells, catalog(), ready.limits if ready else None)
        if ready:
            todo = jobs(cells, catalog(), ready.device, ready.timer, codes)
            _decide(rows, todo, (folder, *beside), choices, shared)
        measured = [cell for cell, row in zip(cells, rows, strict=True) if row["decision"] == "measure"]
        say(_plan_text(experiment, rows, folder, _predicted(forecast, measured)) + "\n" * (len(plans) > 1))
        to_come += measured
    if len(plans) > 1 and forecast:
        say(f"{len(to_come)} cells to measure in all: {forecast.run(to_come).text}")


def _predicted(forecast, cells: Sequence[Any]) -> list[str]:
    return [f"  predicted: {forecast.run(cells).text}"] if forecast and cells else []


def _forecast(known, ready):
    """What results of the device foretell: those of the run, those beside it, and those below results/."""
    from ..plan.forecast import Forecast, rates_of
    from ..run.ledger import relatives

    runs = [(folder.manifest(), folder.cells())
            for folder in [*known, *relatives(Path("results") / ready.device["slug"], known)]]
    mine = [(manifest, [row for row in rows if _of_the_device(row, ready.device)]) for manifest, rows in runs]
    return Forecast((row for _, rows in mine for row in rows), rates_of(mine, ready.calibration))


def _of_the_device(row: Mapping[str, Any], device: Mapping[str, str]) -> bool:
    made_by = row.get("device") or {}
    return all(made_by.get(name) == device[name] for name in ("renderer", "version"))


def _decide(rows: list[dict[str, Any]], todo, folders, choices: Choices, shared: dict[str, str]) -> None:
    """What becomes of the cells that neither device nor budget forbids, by what result folders have.

    folders: the experiment's own, then those beside it. shared: the experiment that measures a cell first, by key.
    """
    from ..plan import Outcome, predicted_timeout

    rows_by_number = {} if choices.force else _kept(todo, folders, choices.keep_failed)
    told = (Outcome.of(todo[number].cell, row) for number, (_, row) in rows_by_number.items())
    known = [outcome for outcome in told if outcome]
    for number, (row, job) in enumerate(zip(rows, todo, strict=True)):
        if row["decision"] != "measure":
            continue
        if number in rows_by_number:
            source = rows_by_number[number][0]
            row["decision"] = "kept: already measured" if source is folders[0] else f"copied from {source.path}"
        elif not choices.try_hopeless and (reason := predicted_timeout(job.cell, known)):
            row["decision"] = f"timeout: {reason}"
        elif shared.setdefault(job.key, job.cell.experiment) != job.cell.experiment:
            row["decision"] = f"shared with {shared[job.key]}"


def _kept(todo, folders, keep_failed: bool) -> dict[int, tuple[Any, dict[str, Any]]]:
    """The folder that has a cell, and its row, by the cell's number."""
    from ..run.ledger import final

    present = [folder for folder in folders if folder.has_cells]
    found = {}
    for number, job in enumerate(todo):
        rows = ((folder, final(folder, job.key, keep_failed)) for folder in present)
        if first := next(((folder, row) for folder, row in rows if row), None):
            found[number] = first
    return found


def _plan_text(experiment, rows: list[dict[str, Any]], folder, predicted: list[str]) -> str:
    lines = [f"{experiment.name}: {experiment.title}", f"  {len(rows)} cells -> {folder.path}", *predicted]
    label = max(len(r["label"]) for r in rows)
    where = [place(r["point"]) for r in rows]
    longest = max(map(len, where))
    lines += [f"  {r['label']:{label}}  {w:{longest}}  {r['memory_bytes'] / 2**20:10,.2f} MiB  {r['decision']}"
              for r, w in zip(rows, where, strict=True)]
    measured = sum(r["decision"] == "measure" for r in rows)
    return "\n".join([*lines, f"  {measured} to measure, {len(rows) - measured} not"])
