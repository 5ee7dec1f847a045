"""The tasks of a store, and what submits them: each kind of device measures the whole run, in shares."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from contextlib import AbstractContextManager, contextmanager
from dataclasses import asdict, dataclass, replace
from multiprocessing import get_context
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import Field, ValidationError

from ..errors import MfrError, UsageError
from ..store import write_file
from ..store.files import locked
from ..store.record import text
from .settings import Cluster, Kind, Settings
from .task import Task

FILE = "submission.json"
SCHEMA = 1
KIND = r"^[\w-]+$"  # the name of a kind of device: also that of a folder
SIGNAL_S = 60  # before its time limit a task is asked to end, so that it is queued again


@dataclass(frozen=True)
class Share:
    """One task: the share `number` of `count` of the run on a kind of device, its planned cells, the engine's job.

    plan: digest of what its cells are.
    """

    kind: Annotated[str, Field(pattern=KIND)]
    number: Annotated[int, Field(ge=1)]
    count: Annotated[int, Field(ge=1)]
    cells: Annotated[int, Field(ge=1)]
    plan: str
    job: str | None = None

    @property
    def identity(self) -> tuple[str, int, int, str]:
        """Equal for tasks that measure the same on the same kind of device."""
        return self.kind, self.number, self.count, self.plan

    @property
    def name(self) -> str:
        return f"{self.kind}-{self.number}"


class Record(Settings):
    """The content of submission.json."""

    layout: Literal[SCHEMA] = Field(alias="schema")
    engine: Literal["slurm", "local"]
    run: list[str]
    tasks: list[Share]


@dataclass(frozen=True)
class Submission:
    """The run that was submitted into a store, as `mfr-bench run` takes it, and its tasks."""

    store: Path
    engine: str
    run: tuple[str, ...]
    tasks: tuple[Share, ...]

    def folder(self, share: Share) -> Path:
        """The folder that a task alone writes."""
        return self.store / "tasks" / share.name

    def write(self) -> None:
        """Keep it in the store. Raises StoreError."""
        record = {"schema": SCHEMA, "engine": self.engine, "run": list(self.run),
                  "tasks": [asdict(task) for task in self.tasks]}
        write_file(self.store / FILE, text(record), durable=True)


def read_submission(store: Path) -> Submission | None:
    """The submission that a store has; None if it has none. Raises UsageError where it cannot be read."""
    path = store / FILE
    try:
        record = Record.model_validate_json(path.read_bytes())
        return Submission(store, record.engine, tuple(record.run), tuple(record.tasks))
    except FileNotFoundError:
        return None
    except ValidationError as error:
        where = ".".join(map(str, error.errors()[0]["loc"])) or "the file"
        wrong = f"{where}: {error.errors()[0]['msg']}"
    except OSError as error:
        wrong = error.strerror
    raise UsageError(f"{path}: cannot be read: {wrong}; allowed: what 'mfr-bench submit' of this version wrote")


def alone(store: Path) -> AbstractContextManager[str | None]:
    """Within it no other process submits into the store, which is made; see `locked`. Raises StoreError."""
    return locked(store / FILE, "submits into it", "wait for its end, then run the same command again")


def planned(cluster: Cluster, store: Path, run: Sequence[str],
            cells: Mapping[tuple[int, int, int], tuple[int, str]]) -> Submission:
    """The tasks of a run; cells: how many each share (number, count, `Kind.split_s`) has, and their digest.

    Shares without a cell are no task. Raises UsageError where the store holds another run, or tasks that this one has
    not: their cells would count for others.
    """
    before = read_submission(store)
    if before and (before.run != tuple(run) or before.engine != cluster.engine):
        raise UsageError(f"{store}: holds the run '{' '.join(before.run)}' of {before.engine}; allowed: the same "
                         "again, or another store")
    jobs = {task.identity: task.job for task in before.tasks} if before else {}
    tasks = [Share(name, number, kind.shares, *cells[number, kind.shares, kind.split_s])
             for name, kind in cluster.kinds.items() for number in range(1, kind.shares + 1)
             if cells[number, kind.shares, kind.split_s][0]]
    if others := [f"{kind}-{number}" for kind, number, *_ in jobs.keys() - {task.identity for task in tasks}]:
        raise UsageError(f"{store}: holds tasks that are no part of this run, such as {min(others)}: the config, the "
                         "number of shares or a kind of device is another; allowed: the same again, or another store")
    return Submission(store, cluster.engine, tuple(run),
                      tuple(replace(task, job=jobs.get(task.identity)) for task in tasks))


def submit(submission: Submission, cluster: Cluster, due: Sequence[Share]) -> Submission:
    """Hand the due tasks to the engine, those of a kind together; the submission with their jobs, written as it grows.

    Raises MfrError where the engine refuses or is not there.
    """
    for name, kind in cluster.kinds.items():
        mine = [task for task in due if task.kind == name]
        if mine:
            hand_over = _from_its_own_session if cluster.engine == "local" else _handed_over
            jobs = hand_over(submission, cluster, kind, mine)
            given = {task.name: job for task, job in zip(mine, jobs, strict=True)}
            submission = replace(submission, tasks=tuple(
                replace(task, job=given.get(task.name, task.job)) for task in submission.tasks))
            submission.write()
    return submission


def _from_its_own_session(*given) -> list[str]:
    """What `_handed_over` returns, from a process in a session of its own: no terminal that closes ends its tasks."""
    with ProcessPoolExecutor(1, get_context("fork"), initializer=os.setsid) as pool:
        return pool.submit(_handed_over, *given).result()


def _handed_over(submission: Submission, cluster: Cluster, kind: Kind, tasks: Sequence[Share]) -> list[str]:
    try:
        import submitit
    except ImportError:
        raise MfrError("submit needs the package submitit; install mfr-bench[cluster]") from None
    try:
        executor = submitit.AutoExecutor(folder=submission.store / "logs" / "%j", cluster=cluster.engine)
        executor.update_parameters(**_parameters(cluster, kind))
        with _own_output(), executor.batch():
            jobs = [executor.submit(Task(command_of(submission, task, kind))) for task in tasks]
        return [job.job_id for job in jobs]
    except (RuntimeError, OSError, submitit.core.utils.FailedJobError) as error:
        lines = [line for line in str(error).splitlines() if line.strip()]
        raise MfrError(f"{cluster.engine} takes no task: {lines[-1] if lines else type(error).__name__}") from error


@contextmanager
def _own_output() -> Iterator[None]:
    """Within it what this process starts does not inherit its output, which a reader would wait for the end of."""
    sys.stdout.flush()
    kept = [os.dup(descriptor) for descriptor in (1, 2)]
    nowhere = os.open(os.devnull, os.O_WRONLY)
    try:
        for descriptor in (1, 2):
            os.dup2(nowhere, descriptor)
        yield
    finally:
        for descriptor, own in zip((1, 2), kept, strict=True):
            os.dup2(own, descriptor)
            os.close(own)
        os.close(nowhere)


def _parameters(cluster: Cluster, kind: Kind) -> dict[str, Any]:
    asked: dict[str, Any] = {"name": "mfr-bench", "timeout_min": kind.minutes}
    if cluster.engine == "local":
        return asked
    slurm = {"partition": kind.partition, "gres": kind.gres, "constraint": kind.constraint, "account": kind.account,
             "qos": kind.qos, "additional_parameters": {"requeue": True, **kind.options}, "setup": list(cluster.setup),
             "signal_delay_s": min(SIGNAL_S, 30 * kind.minutes)}
    memory = {} if kind.memory_gb is None else {"mem_gb": kind.memory_gb}
    return asked | {"cpus_per_task": kind.cpus} | memory | {
        f"slurm_{name}": value for name, value in slurm.items() if value not in (None, [])}


def command_of(submission: Submission, task: Share, kind: Kind) -> list[str]:
    """The command that measures a task's share; the same by hand, on a machine without an engine."""
    share = [] if task.count == 1 else ["--shard", f"{task.number}/{task.count}", "--split", f"{kind.split_s}s"]
    device = kind.device[(task.number - 1) % len(kind.device)]
    return [sys.executable, "-m", "mfr_bench", "run", *submission.run, *share, "--device", device, "--quiet",
            "--out", str(submission.folder(task) / "results")]
