"""The state of a store's tasks by the cells in their folders, whatever the engine says of the jobs."""

from __future__ import annotations

import calendar
import time
from collections import Counter
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass

from ..store import KEY_FILE, STATUSES, ResultFolder
from ..store.folder import folders_with_cells
from .submission import Share, Submission

STAMP = "%Y-%m-%dT%H:%M:%SZ"  # of `measured` in a cell
DONE, RUNNING, WAITING, ENDED, UNKNOWN = "done", "running", "waiting", "ended", "unknown"


@dataclass(frozen=True)
class TaskState:
    """A task, how many of its cells stand in its folder by status, and where it is.

    done: it has every cell. running, waiting: the engine has it. ended: neither, so that it wants submitting again.
    unknown: the engine does not answer. left_s: seconds that the missing cells take at the pace of those that were
    measured; None where fewer than two tell it, or all came at once. A run measures small scenes first, so that more is
    left rather than less.
    """

    task: Share
    statuses: Mapping[str, int]
    state: str
    left_s: float | None = None

    @property
    def cells(self) -> int:
        return sum(self.statuses.values())

    @property
    def failed(self) -> int:
        return sum(count for name, count in self.statuses.items() if STATUSES[name].failed)


def task_states(submission: Submission, jobs: Mapping[str, str] | None) -> list[TaskState]:
    """The state of every task; jobs: as `queue.states` gives them."""
    return [_state(submission, task, jobs) for task in submission.tasks]


def results_of(submission: Submission, task: Share) -> list[ResultFolder]:
    """The result folders that a task has written so far."""
    root = submission.folder(task) / "results"
    single = [root] if (root / "manifest.json").exists() else []
    return [ResultFolder(path) for path in (*single, *folders_with_cells(root))]


def wanting(states: Sequence[TaskState]) -> list[Share]:
    """The tasks to submit: those that are not done and that the engine does not have."""
    return [state.task for state in states if state.state == ENDED]


def _state(submission: Submission, task: Share, jobs: Mapping[str, str] | None) -> TaskState:
    statuses: Counter[str] = Counter()
    stamps: list[str] = []
    for folder in results_of(submission, task):
        for name in filter(KEY_FILE.fullmatch, folder.names()):
            if cell := folder.cell(name.removesuffix(".json")):
                statuses[cell["status"]] += 1
                stamps += [cell["measured"]] if cell.get("measured") and STATUSES[cell["status"]].timed else []
    if statuses.total() >= task.cells:
        return TaskState(task, statuses, DONE)
    if jobs is None and task.job is not None:
        return TaskState(task, statuses, UNKNOWN)
    return TaskState(task, statuses, (jobs or {}).get(task.job or "", ENDED),
                     _left_s(stamps, task.cells - statuses.total()))


def _left_s(stamps: Sequence[str], missing: int) -> float | None:
    """The time that missing cells take at the pace between the first stamp and the last, by the node's own clock."""
    times = []
    for stamp in stamps:
        with suppress(ValueError):
            times.append(calendar.timegm(time.strptime(stamp, STAMP)))
    passed_s = max(times) - min(times) if times else 0
    return passed_s / (len(times) - 1) * missing if passed_s else None
