"""One experiment of a run: its cells, the rows that they make, and how each has ended so far."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Mapping, Sequence
from typing import Any

from ..errors import StoreError
from ..store import ResultFolder
from .jobs import Job


class Sheet:
    """The cells of an experiment by key. Entries of its config that meet in one cell share it, each with its row."""

    def __init__(self, folder: ResultFolder, jobs: Sequence[Job]):
        self.folder = folder
        self.jobs: dict[str, Job] = {}  # the first of each key
        self._places: dict[str, list[dict[str, Any]]] = {}
        for job in jobs:
            self.jobs.setdefault(job.key, job)
            self._places.setdefault(job.key, []).append({"label": job.cell.label, "point": plain(job.cell.point)})
        self.statuses: dict[str, str] = {}  # by key, of the cells that have ended
        self.kept = 0  # rows
        self.copied = 0
        self.refused: Collection[str] = ()  # keys of what device, method or memory budget forbids, once that is known
        self.noise_floor_rel: float | None = None

    @property
    def pending(self) -> list[Job]:
        """The cells that have not ended."""
        return [job for key, job in self.jobs.items() if key not in self.statuses]

    @property
    def counts(self) -> Counter[str]:
        """Rows by status."""
        found: Counter[str] = Counter()
        for key, status in self.statuses.items():
            found[status] += self.rows(key)
        return found

    @property
    def total(self) -> int:
        """Rows of all cells."""
        return sum(map(self.rows, self.jobs))

    def refuse_gone(self) -> None:
        """Raises StoreError where records of cells that have ended are not in the folder any more."""
        there = set(self.folder.names())
        if gone := [key for key in self.statuses if f"{key}.json" not in there]:
            raise StoreError(f"{self.folder.path}: of {len(self.statuses)} cells that were written, {len(gone)} are no "
                             "more there: another program has removed them; the same command measures them again")

    def rows(self, key: str) -> int:
        """Rows that a cell makes: one for each label and point of the config that it serves."""
        return len(self._places[key])

    def placed(self, key: str, row: Mapping[str, Any]) -> dict[str, Any]:
        """The row with its places in the experiment, which are no part of its key: the first, and `also` the others."""
        first, *others = self._places[key]
        bare = {name: value for name, value in row.items() if name != "also"}
        return bare | {"experiment": self.jobs[key].cell.experiment} | first | ({"also": others} if others else {})


def plain(value: Any) -> Any:
    """Tuples as the lists that JSON gives back."""
    if isinstance(value, Mapping):
        return {name: plain(item) for name, item in value.items()}
    return [plain(item) for item in value] if isinstance(value, (list, tuple)) else value
