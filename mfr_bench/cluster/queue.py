"""Asks an engine for its jobs, with a limit on the time. Its answer decides nothing: cells do."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from pathlib import Path

from ..environment import ask

WAITING = {"PENDING", "CONFIGURING", "REQUEUED", "REQUEUE_HOLD", "SUSPENDED"}
RUNNING = {"RUNNING", "COMPLETING", "STAGE_OUT"}
NODE = re.compile(r"[\w.\[\],-]+")


def states(engine: str, jobs: Iterable[str]) -> Mapping[str, str] | None:
    """'waiting' or 'running' for each job that the engine still has; None where it does not answer.

    Slurm is asked through squeue, which needs no accounting database, and whoever submitted them.
    """
    wanted = set(jobs)
    if engine == "local":
        return {job: "running" for job in wanted if _alive(job)}
    said = _asked(wanted, "%T")
    return said if said is None else {job: "waiting" if state in WAITING else "running"
                                      for job, state in said.items() if state in WAITING | RUNNING}


def reasons(engine: str, jobs: Iterable[str]) -> Mapping[str, str]:
    """Why Slurm lets these jobs wait, in its own words, as far as it says so."""
    said = _asked(set(jobs), "%r") if engine == "slurm" else {}
    return {job: reason for job, reason in (said or {}).items() if reason not in ("", "None")}


def is_held(reason: str) -> bool:
    """True where a job waits until somebody releases it: a user held it, or Slurm after its node could not start it."""
    return "held" in reason.lower()


def _asked(wanted: set[str], what: str) -> dict[str, str] | None:
    """What squeue says of each of these jobs that it still has; None where it does not answer."""
    if not wanted:
        return {}
    arrays = sorted({job.partition("_")[0] for job in wanted})
    numbers = ",".join([*arrays, *arrays[:1]])  # of one alone that Slurm has forgotten squeue makes an error
    said = ask(["squeue", "--noheader", "--array", "--states=all", f"--jobs={numbers}", f"--format=%i|{what}"])
    found = (line.partition("|") for line in (said or "").splitlines())
    return None if said is None else {job: value.strip() for job, _, value in found if job in wanted}


def drained_nodes() -> list[str]:
    """A line for each group of nodes that Slurm has taken out, with its reason."""
    said = ask(["sinfo", "--noheader", "--list-reasons", "--format=%N|%T|%E"]) or ""
    lines = [line.split("|", 2) for line in said.splitlines() if line.count("|") >= 2]
    return [f"node {nodes} is {state}: {reason}" for nodes, state, reason in lines if NODE.fullmatch(nodes)]


def _alive(job: str) -> bool:
    """True where a process of submitit's local engine, whose id is the job's, is there.

    The id may be that of another program by now. The command of a zombie is empty.
    """
    try:
        return b"submitit" in Path(f"/proc/{int(job)}/cmdline").read_bytes()
    except (OSError, ValueError):
        return False
