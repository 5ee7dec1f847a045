"""The state of a store's tasks by the cells in their folders, whatever the engine says of the jobs."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from ..store import KEY_FILE, STATUSES, ResultFolder
from ..store.folder import folders_with_cells
from .submission import Share, Submission

DONE, RUNNING, WAITING, ENDED, UNKNOWN = "done", "running", "waiting", "ended", "unknown"


@dataclass(frozen=True)
class TaskState:
    """A task, how many of its cells stand in its folder by status, and where it is.

    done: it has every cell. running, waiting: the engine has it. ended: neither, so that it wants submitting again.
    unknown: the engine does not answer.
    """

    task: Share
    statuses: Mapping[str, int]
    state: str

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
    for folder in results_of(submission, task):
        for name in filter(KEY_FILE.fullmatch, folder.names()):
            if cell := folder.cell(name.removesuffix(".json")):
                statuses[cell["status"]] += 1
    if statuses.total() >= task.cells:
        return TaskState(task, statuses, DONE)
    if jobs is None and task.job is not None:
        return TaskState(task, statuses, UNKNOWN)
    return TaskState(task, statuses, (jobs or {}).get(task.job or "", ENDED))
