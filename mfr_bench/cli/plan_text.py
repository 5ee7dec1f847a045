"""`run --dry-run`: what would be measured, what not, and why."""

from __future__ import annotations

from typing import Any

from .output import note, say
from .session import Choices, result_folders, sources


def print_plans(plans, supervisor, choices: Choices) -> None:
    """Print the plan of each experiment; without a device as far as it goes."""
    from ..errors import DeviceError
    from ..methods import catalog
    from ..plan import overview

    try:
        ready = supervisor.ready()
    except DeviceError as error:
        ready = None
        note(f"{error}; the plan below holds only the budget against the cells")
    folders = result_folders(plans, choices.out, ready.device["slug"] if ready else "unknown-device")
    for (experiment, cells), folder in zip(plans, folders, strict=True):
        if not cells:
            continue
        rows = overview(cells, catalog(), ready.limits if ready else None)
        decided = _known(cells, folder, sources(plans, folders, choices), ready, choices) if ready else {}
        for number, row in enumerate(rows):
            if row["decision"] == "measure":
                row["decision"] = decided.get(number, "measure")
        say(_plan_text(experiment, rows, folder))


def _known(cells, folder, others, ready, choices: Choices) -> dict[int, str]:
    """What result folders say of cells, by their numbers: that they are kept, copied, or hopeless."""
    from ..methods import catalog
    from ..plan import Known, hopeless
    from ..run.jobs import jobs
    from ..run.ledger import final

    if choices.force or not any(f.cells_path.is_dir() for f in (folder, *others)):
        return {}
    found: dict[int, str] = {}
    known = []
    todo = jobs(cells, catalog(), ready.device, ready.timer)
    for number, job in enumerate(todo):
        for source in (folder, *others):
            if row := final(source, job.key, choices.keep_failed):
                found[number] = "kept: already measured" if source is folder else f"copied from {source.path}"
                known.append(Known(job.cell, row["status"], row["values"].get("time_ms")))
                break
    known = [k for k in known if k.over_limit(k.cell.measure)]
    for number, job in enumerate(todo):
        if number not in found and not choices.try_hopeless and (reason := hopeless(job.cell, known)):
            found[number] = f"timeout: {reason}"
    return found


def _plan_text(experiment, rows: list[dict[str, Any]], folder) -> str:
    lines = [f"{experiment.name}: {experiment.title}", f"  {len(rows)} cells -> {folder.path}"]
    label = max(len(r["label"]) for r in rows)
    where = [" ".join(f"{k.removeprefix('scene.')}={v}" for k, v in r["point"].items()) for r in rows]
    place = max(map(len, where))
    lines += [f"  {r['label']:{label}}  {w:{place}}  {r['memory_bytes'] / 2**20:10,.2f} MiB  {r['decision']}"
              for r, w in zip(rows, where, strict=True)]
    measured = sum(r["decision"] == "measure" for r in rows)
    return "\n".join([*lines, f"  {measured} to measure, {len(rows) - measured} not"])
