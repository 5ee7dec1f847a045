"""`submit`, `status`, `collect`: one run on many machines, through an engine that is there."""

from __future__ import annotations

import hashlib
import shlex
from contextlib import nullcontext
from pathlib import Path

import click

from .options import OUTSIDE, PROFILE, SET, ConfigName, InPath, OutPath
from .output import note, say

PLAN_DIGITS = 16

STORE = click.argument("store", metavar="STORE", type=InPath(file_okay=False))


@click.command()
@click.argument("configs", nargs=-1, required=True, metavar="CONFIG...", type=ConfigName())
@click.option("--cluster", "settings", required=True, metavar="F", type=InPath(dir_okay=False),
              help="cluster.yaml: engine, store, kinds of devices; see docs/machines.md.")
@PROFILE
@SET
@OUTSIDE
@click.option("--dry-run", is_flag=True, help="Print each task's command, which does the same by hand; submit nothing.")
def submit(configs: tuple[str, ...], settings: str, profile: str | None, overrides: tuple[str, ...],
           dry_run: bool) -> int:
    """Submit a run in shares to Slurm, or to processes of this machine.

    Each kind of device in cluster.yaml measures the whole run. Every task writes a folder of its own in the store,
    goes on where it was cut off, and needs no database. The same command again submits what is not done and not in
    the queue.

    \b
    Example: mfr-bench submit kplus2015-fig6 gpupro5-fig5 --cluster cluster.yaml
    """
    from ..cluster import queue, state, submission
    from ..cluster.settings import read_cluster

    cluster, store = read_cluster(settings)
    files = [str(Path(name).resolve()) if Path(name).exists() else name for name in configs]
    outside = [str(Path(folder).resolve()) for folder in click.get_current_context().meta.get("method_folders", ())]
    run = [*files, *(["--profile", profile] if profile else []), *(part for o in overrides for part in ("--set", o)),
           *(part for folder in outside for part in ("--methods", folder))]
    cells = _cells_by_share(files, profile, overrides, cluster.kinds)
    for line in _crowded(cluster):
        note(line)
    with nullcontext() if dry_run else submission.alone(store) as unlocked:
        if unlocked:
            note(unlocked)
        plan = submission.planned(cluster, store, run, cells)
        states = state.task_states(plan, queue.states(plan.engine, [t.job for t in plan.tasks if t.job]))
        due = state.wanting(states)
        if dry_run:
            for task in due:
                say(shlex.join(submission.command_of(plan, task, cluster.kinds[task.kind])))
            return 0
        plan.write()
        submission.submit(plan, cluster, due)
    say(f"{store}: {len(due)} of {len(plan.tasks)} tasks submitted; mfr-bench status {store}")
    if any(each.state == state.UNKNOWN for each in states):
        note(f"{plan.engine} does not answer: tasks whose jobs may be in the queue were not submitted again")
    return 0


def _crowded(cluster) -> list[str]:
    """A line for each kind whose tasks would draw on one device of this machine at the same time."""
    crowded = {name: kind for name, kind in cluster.kinds.items()
               if cluster.engine == "local" and kind.shares > len(kind.device)}
    return [f"{name}: {kind.shares} tasks draw on {len(kind.device)} device{'s' * (len(kind.device) > 1)} of this "
            "machine at the same time, and their times are longer for it; allowed: one share for each device, as in "
            "device: [UUID, UUID]" for name, kind in crowded.items()]


def _cells_by_share(configs, profile, overrides, kinds) -> dict[tuple[int, int, int], tuple[int, str]]:
    """The number of cells of each share, with what entries of one config have in common once, and their digest.

    Scenes that are split are named, for each kind of device.
    """
    from ..plan.shards import shards, split_lines, units_of
    from .run_command import plans_of

    plans = plans_of(configs, profile, None, overrides)
    found: dict[tuple[int, int, int], tuple[int, str]] = {}
    for name, kind in kinds.items():
        split_s = kind.split_s if kind.shares > 1 else None
        units = units_of(plans, split_s)
        for line in split_lines(units.splits):
            note(f"{name}: {line}")
        for number, share in enumerate(shards(plans, units, kind.shares), 1):
            found[number, kind.shares, kind.split_s] = _counted(share)
    return found


def _counted(plans) -> tuple[int, str]:
    found = [sorted({repr((cell.method, sorted(dict(cell.params).items()), cell.scene, cell.measure))
                     for cell in cells}) for _, cells in plans]
    return sum(map(len, found)), hashlib.sha256(repr(found).encode()).hexdigest()[:PLAN_DIGITS]


@click.command()
@STORE
def status(store: str) -> int:
    """Show the tasks of a store: cells, failures, done, running, waiting or ended.

    A task is done if all its cells are there, whatever the engine says. Exit status 1 if a task has ended without, or
    waits until somebody releases it.

    \b
    Example: mfr-bench status /shared/mfr
    """
    from ..cluster import queue, state
    from ..plan.forecast import rough_duration

    found = _submission(store)
    states = state.task_states(found, queue.states(found.engine, [t.job for t in found.tasks if t.job]))
    waits = queue.reasons(found.engine, [t.task.job for t in states if t.state == state.WAITING and t.task.job])
    longest = max((len(each.task.name) for each in states), default=0)
    for each in states:
        failed = f", {each.failed} failed" if each.failed else ""
        told = each.left_s is not None and each.state == state.RUNNING
        left = f", at this pace {rough_duration(each.left_s)} left" if told else ""
        left += f" ({waits[each.task.job]})" if each.task.job in waits else ""
        say(f"{each.task.name:{longest}}  {each.cells:5} of {each.task.cells} cells{failed}  {each.state}{left}"
            + (f"  job {each.task.job}" if each.task.job and each.state not in (state.DONE, state.ENDED) else ""))
    done = sum(each.state == state.DONE for each in states)
    say(f"{sum(each.cells for each in states)} of {sum(each.task.cells for each in states)} cells, "
        f"{done} of {len(states)} tasks done")
    for line in queue.drained_nodes() if found.engine == "slurm" else []:
        note(line)
    held = [job for job, reason in waits.items() if queue.is_held(reason)]
    if held:
        note(f"Slurm holds {_tasks(len(held))}: {waits[held[0]]}; 'scontrol release {held[0]}' lets a job go on, once "
             "what kept it is in order")
    ended = state.wanting(states)
    if ended:
        note(f"{_tasks(len(ended))} ended without all their cells, such as {ended[0].name}; the same submit command "
             f"queues them again; what they said is in {found.store / 'logs'}")
    return 1 if ended or held else 0


def _tasks(count: int) -> str:
    return f"{count} task{'s' * (count > 1)}"


@click.command()
@STORE
@click.option("--into", metavar="DIR", type=OutPath(file_okay=False),
              help="Where the merged sets go (default: STORE/results).")
def collect(store: str, into: str | None) -> None:
    """Merge what the tasks of a store have measured so far.

    They may run meanwhile. See merge for what is checked.

    \b
    Example: mfr-bench collect /shared/mfr --into results
    """
    from ..cluster import state
    from ..errors import UsageError
    from .merge_command import merge_into

    found = _submission(store)
    folders = [folder for task in found.tasks for folder in state.results_of(found, task)
               if (folder.path / "manifest.json").exists()]
    if not folders:
        raise UsageError(f"{store}: no task has written a cell yet; see mfr-bench status {store}")
    merge_into(folders, Path(into or found.store / "results"))


def _submission(store: str):
    from ..cluster.submission import read_submission
    from ..errors import UsageError

    found = read_submission(Path(store).resolve())
    if found is None:
        raise UsageError(f"{store}: nothing was submitted into it; allowed: the store of a cluster.yaml that "
                         "'mfr-bench submit' used")
    return found
