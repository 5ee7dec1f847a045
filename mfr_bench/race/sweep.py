"""A campaign: every configuration of every method on every machine, in a table that a later run goes on with."""

from __future__ import annotations

import csv
import json
from collections.abc import Iterable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, fields, replace
from pathlib import Path

from ..environment import usable_cores
from ..errors import MfrError, StoreError
from ..methods.spec import Method, Variant
from ..store import csv_text, write_file
from .build import build
from .campaign import Found, run, settings, written
from .check import BrokenAloneError, Checker, How
from .options import configurations
from .scenes import row_of

TABLE = "races.csv"
LANES = 4  # of a warp in lockstep: fewer than the fragments of a scene, so that warps meet as well


@dataclass(frozen=True)
class Job:
    """One configuration on one machine, and how many schedules of how many scenes it is run with."""

    variant: Variant
    machine: str
    how: How
    counts: tuple[int, ...]
    scenes: int


@dataclass(frozen=True)
class Line:
    """The outcome of a job, a line of the table. `code`: hash of the code that ran."""

    method: str
    params: str  # JSON, of those that are not at their defaults
    machine: str
    fragments: str
    scenes: int
    seed: int
    schedules: int
    promise: str
    violations: int
    wrong_share: float | None  # of schedules; None where a wrong image breaks a promise
    cpu_s: float
    replay: str
    error: str
    code: str

    @property
    def broken(self) -> bool:
        """Whether a promise broke, or the job could not be run."""
        return bool(self.violations or self.error)

    @property
    def schedules_per_s(self) -> float:
        """Schedules for each second of CPU time."""
        return self.schedules / self.cpu_s if self.cpu_s else 0.0

    @property
    def identity(self) -> tuple[object, ...]:
        """The identity that a later run shares, whatever its code and number of schedules: the table has it once."""
        return self.method, self.params, self.machine, self.fragments, self.scenes, self.seed


def machines(how: How) -> Mapping[str, How]:
    """The machines of a campaign: strong memory with helpers, weak memory, and warps in lockstep."""
    return {"strong": replace(how, helpers=True), "weak": replace(how, weak=True),
            "lockstep": replace(how, warp=LANES)}


def jobs(methods: Iterable[Method], counts: Sequence[int], how: How, scenes: int, together: int) -> list[Job]:
    """Every configuration of the methods, with up to `together` options at other values, on every machine."""
    return [Job(variant, name, machine, tuple(counts), scenes) for method in methods
            for variant in configurations(method, row_of(counts), together)
            for name, machine in machines(how).items()]


def sweep(wanted: Sequence[Job], folder: Path, at_once: int | None = None) -> Iterator[Line]:
    """The line of each job, in order, as they come; those that the folder's table has are not run again.

    at_once: jobs that run side by side, one for each core unless said otherwise. The table is written anew with each
    line. Raises StoreError where it cannot be read or written.
    """
    known = {line.identity: line for line in read(folder)}
    table = dict(known)
    with ThreadPoolExecutor(at_once or usable_cores()) as pool:
        running = [pool.submit(_line, job, known) for job in wanted]
        try:
            for each in running:
                line = each.result()
                if known.get(line.identity) is not line:
                    table[line.identity] = line
                    write_file(folder / TABLE, csv_text([f.name for f in fields(Line)], map(vars, table.values())))
                yield line
        finally:
            pool.shutdown(wait=False, cancel_futures=True)


def _line(job: Job, known: Mapping[tuple[object, ...], Line]) -> Line:
    """The line of a job, from the table if that has as many schedules as are wanted."""
    try:
        code = build(Checker(job.variant, row_of(job.counts)).frame).key
        before = known.get(_told(job, code=code).identity)
        if before and before.code == code and not before.error and before.schedules >= job.how.schedules:
            return before
        return _told(job, code, run(job.variant, job.counts, job.how, job.scenes))
    except MfrError as error:
        return replace(_told(job, error=str(error)), violations=int(isinstance(error, BrokenAloneError)))


def _told(job: Job, code: str = "", found: Found | None = None, error: str = "") -> Line:
    nothing, broken = found is not None and found.checker.promises_nothing, found is not None and found.broken
    return Line(
        job.variant.method.id, json.dumps(settings(job.variant)), job.machine, ",".join(map(str, job.counts)),
        job.scenes, job.how.seed, found.schedules if found else 0, found.checker.promised.kind.name if found else "",
        int(broken and not nothing), round(found.failed / found.schedules, 6) if found and nothing else None,
        round(found.seconds, 4) if found else 0.0,
        written(found.checker.scene.seed, found.failure.deviations) if found and found.failure and not nothing else "",
        error, code)


def read(folder: Path) -> list[Line]:
    """The lines of a folder's table; none where there is no table. Raises StoreError for one that cannot be read."""
    path = folder / TABLE
    if not path.exists():
        return []
    try:
        with open(path, newline="", encoding="utf-8") as file:
            return [_read(row) for row in csv.DictReader(file)]
    except (OSError, ValueError, KeyError) as error:
        raise StoreError(f"{path} is no table of races ({error!r}); move it away, or give another folder") from error


def _read(row: Mapping[str, str]) -> Line:
    kinds = {"int": int, "float": float, "str": str, "float | None": lambda text: float(text) if text else None}
    return Line(**{f.name: kinds[str(f.type)](row[f.name]) for f in fields(Line)})
