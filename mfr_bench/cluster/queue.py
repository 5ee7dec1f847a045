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
    if engine == "local" or not wanted:
        return {job: "running" for job in wanted if _alive(job)}
    arrays = sorted({job.partition("_")[0] for job in wanted})
    asked = ",".join([*arrays, *arrays[:1]])  # of one number alone that Slurm has forgotten squeue makes an error
    said = ask(["squeue", "--noheader", "--array", "--states=all", f"--jobs={asked}", "--format=%i|%T"])
    if said is None:
        return None
    found: dict[str, str] = {}
    for line in said.splitlines():
        job, _, state = line.partition("|")
        if job in wanted and state in WAITING | RUNNING:
            found[job] = "waiting" if state in WAITING else "running"
    return found


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
