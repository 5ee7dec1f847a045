"""The ledger of a run: what is done and where it is kept, rows that experiments may share, unfinished samples."""

from __future__ import annotations

import time
import uuid
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

from ..measure.split import Split
from ..plan import CellOutcome, Outcomes
from ..plan.budget import groups
from ..store import ResultFolder
from ..store.arrays import read_arrays, write_arrays
from ..store.behind import Behind
from ..store.folder import folders_with_cells
from ..store.journal import Journal, Partial
from ..store.record import PACKAGES
from .events import Finished, Sampled
from .jobs import Job
from .settling import Copied, Kept, LeftOut, Settled, settled
from .sheet import Sheet, plain

Row = dict[str, Any]
Report = Callable[[Row], None]


class Ledger:
    """The sheets of one run on one device. Rows are written behind the caller, and durable after `wait`.

    Until a row is written its samples stay in the journal. `elsewhere`: folders whose cells are copied instead of
    measured. report: receives each row that is written. Raises StoreError wherever a disk fails.
    """

    def __init__(self, sheets: Sequence[Sheet], device: Mapping[str, str], elsewhere: Iterable[ResultFolder] = (),
                 report: Report = lambda row: None, split: Split | None = None):
        self.sheets, self.device, self.report = sheets, device, report
        self.elsewhere, self.split = list(elsewhere), split or Split()
        self.beside_s: dict[str, float] = {}  # processor time of the process beside the device, by kind of work
        self._session = uuid.uuid4().hex[:12]
        self._journals = {sheet.folder.path: Journal(sheet.folder.journal_path) for sheet in sheets}
        self._outcomes = Outcomes()
        self._behind = Behind()

    # --- before ----------------------------------------------------------------------------------

    def settle(self, force: bool = False, keep_failed: bool = False, try_hopeless: bool = False) -> None:
        """Keep what the folders have, or with `force` nothing; copy what other folders have."""
        found = settled(self.sheets, self.elsewhere, force, keep_failed, try_hopeless)
        if force:
            for sheet in self.sheets:
                for job in sheet.pending:
                    self._journal(sheet).forget(job.key)
        for sheet, cells in zip(self.sheets, found, strict=True):
            for key, why in cells.items():
                self._settle(sheet, sheet.jobs[key], why)

    def _settle(self, sheet: Sheet, job: Job, why: Settled) -> None:
        match why:
            case Kept(row) | LeftOut(row=dict() as row):
                if (placed := sheet.placed(job.key, row)) != row:
                    sheet.folder.write_cell(placed)
                sheet.kept += sheet.rows(job.key)
                self._done(sheet, job, row)
            case Copied(row, source):
                write_arrays(sheet.folder, job.key, read_arrays(source, job.key) if job.cell.measure.keep else {})
                sheet.folder.write_cell(sheet.placed(job.key, row))
                sheet.copied += sheet.rows(job.key)
                self._done(sheet, job, row)

    def groups(self, coarse_first: bool = False) -> list[list[Job]]:
        """The jobs to measure, each key once, in the order of `plan.budget.groups`."""
        return groups_of(self.sheets, [[job.key for job in sheet.pending] for sheet in self.sheets], coarse_first)

    # --- while cells are measured ----------------------------------------------------------------

    def next_session(self) -> None:
        """Note that samples come from another process from now on."""
        self._session = uuid.uuid4().hex[:12]

    def partials(self, jobs: Iterable[Job]) -> dict[str, Partial]:
        """Samples that earlier processes took of these cells."""
        found = {job.key: self._home(job.key).partials.get(job.key) for job in jobs}
        return {key: partial for key, partial in found.items() if partial}

    def without_floor(self, keys: Iterable[str]) -> tuple[frozenset[str], ...]:
        """Those of the keys that stand in each experiment of which no cell was sampled twice yet."""
        lacking = (sheet.jobs.keys() & set(keys) for sheet in self.sheets if sheet.noise_floor_rel is None)
        return tuple(frozenset(found) for found in lacking if found)

    def sampled(self, batch: Sampled) -> None:
        with self.split.work("store"):
            self._home(batch.key).add(batch.key, self._session, batch.samples_ms, batch.passes)

    def add_split(self, seconds: Mapping[str, float], beside_s: Mapping[str, float]) -> None:
        """The worker's time by kind of work, and the processor time of the process beside it."""
        for total, more in ((self.split.seconds, seconds), (self.beside_s, beside_s)):
            for kind, spent_s in more.items():
                total[kind] = total.get(kind, 0.0) + spent_s

    def sync(self) -> None:
        """Let the samples so far outlive a loss of power, as soon as the disk has them, and catch up."""
        with self.split.work("store"):
            for journal in self._journals.values():
                self._behind.write(journal.syncing(), lambda: None)
        self.catch_up()

    def catch_up(self) -> None:
        """Report the rows that are written, and give up their samples in the journal."""
        with self.split.work("store"):
            self._behind.catch_up()

    def wait(self) -> None:
        """Wait until everything is durable."""
        with self.split.work("store"):
            self._behind.wait()

    def predicted_timeout(self, job: Job) -> str | None:
        """The reason why a cell would take longer than it may, by what smaller ones took, or None."""
        return self._outcomes.predicted_timeout(job.cell)

    def write(self, job: Job, finished: Finished) -> None:
        """Take a cell's row, and have it written into the folder of every experiment that waits for it."""
        taken = self._home(job.key).partials.get(job.key)
        values = dict(finished.values) | ({"sessions": taken.sessions} if taken and finished.details else {})
        row = {
            "experiment": job.cell.experiment, "label": job.cell.label, "point": plain(job.cell.point),
            "key": job.key, "method": job.cell.method, "params": dict(job.cell.params),
            "scene": job.cell.scene.as_dict(), "measure": job.cell.measure.as_dict(), "status": finished.status,
            "reason": finished.reason, "values": values, "glsl_hash": job.glsl_hash,
            "device": {name: self.device.get(name) for name in ("slug", "renderer", "version", "uuid", "pci")},
            "measured": time.strftime("%Y-%m-%dT%H:%M:%SZ", time.gmtime()), **finished.details,
            **({"failed_trials": list(finished.failed_trials)} if finished.failed_trials else {}),
            **{name: dict(package) for name in PACKAGES if (package := getattr(job, name))},
        }
        sheets = [sheet for sheet in self.sheets if job.key in sheet.jobs and job.key not in sheet.statuses]
        with self.split.work("store"):
            files = [(sheet.folder, *sheet.folder.file_of(sheet.placed(job.key, row))) for sheet in sheets]
        self._behind.write(partial(_write, files, finished.arrays), partial(self._written, sheets, row))
        for sheet in sheets:
            self._ended(sheet, sheet.jobs[job.key], row)
        if finished.noise_floor_rel is not None:
            for sheet in self.sheets:
                if job.key in sheet.jobs and sheet.noise_floor_rel is None:
                    sheet.noise_floor_rel = finished.noise_floor_rel

    def close(self) -> None:
        self.wait()
        for journal in self._journals.values():
            journal.close()

    def _written(self, sheets: Sequence[Sheet], row: Row) -> None:
        for sheet in sheets:
            self._journal(sheet).forget(row["key"])
        self.report(row)

    def _done(self, sheet: Sheet, job: Job, row: Row) -> None:
        self._ended(sheet, job, row)
        self._journal(sheet).forget(job.key)

    def _ended(self, sheet: Sheet, job: Job, row: Row) -> None:
        sheet.statuses[job.key] = row["status"]
        if outcome := CellOutcome.of(job.cell, row):
            self._outcomes.add(outcome)

    def _journal(self, sheet: Sheet) -> Journal:
        return self._journals[sheet.folder.path]

    def _home(self, key: str) -> Journal:
        """The journal that has the samples of a cell: of several experiments, the first one's."""
        return self._journal(next(sheet for sheet in self.sheets if key in sheet.jobs and key not in sheet.statuses))


def _write(files: Sequence[tuple[ResultFolder, str, bytes]], arrays: bytes) -> None:
    """Write the files of one cell in their folders, its arrays, if any, before the record that tells of them."""
    for folder, name, content in files:
        if arrays:
            folder.write_content(f"{name.removesuffix('.json')}.npz", arrays)
        folder.write_content(name, content)


def groups_of(sheets: Sequence[Sheet], pending: Sequence[Collection[str]], coarse_first: bool) -> list[list[Job]]:
    """The jobs of these keys of each sheet, in the order of `plan.budget.groups`."""
    jobs: dict[str, Job] = {}  # of equal keys the first sheet's
    for sheet, keys in zip(sheets, pending, strict=True):
        for key in keys:
            jobs.setdefault(key, sheet.jobs[key])
    plans = [{key: job.cell for key, job in sheet.jobs.items()} for sheet in sheets]
    return [[jobs[key] for key in keys] for keys in groups(plans, pending, coarse_first)]


def relatives(root: Path | None, own: Iterable[ResultFolder]) -> list[ResultFolder]:
    """The other result folders below a root, whose cells may be the same."""
    taken = {folder.path.resolve() for folder in own}
    found = folders_with_cells(root) if root else []
    return [ResultFolder(path) for path in found if path.resolve() not in taken]
