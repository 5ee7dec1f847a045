"""Result folders: one durable file per cell and a manifest, or the packed form of both."""

from __future__ import annotations

import fcntl
import os
from collections.abc import Iterable, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

from ..errors import StoreError, UsageError, nearest
from . import columns
from .files import make_folder, unwritable, write_file
from .record import ARRAY_FILE, KEY_FILE, SCHEMA, Cell, decoded, fault, plain, read, text


def _holder(handle: int) -> str:
    """Who has the lock on an open folder, as far as the kernel tells."""
    inode = os.fstat(handle).st_ino
    with suppress(OSError):
        for line in Path("/proc/locks").read_text().splitlines():
            _, kind, _, _, pid, where, *_ = line.split()
            if kind == "FLOCK" and where.rpartition(":")[2] == str(inode) and int(pid) > 0:
                return f"process {pid}"
    return "another process"


class ResultFolder:
    """The measurements of one config on one device. Nothing is created before the first write."""

    def __init__(self, path: str | os.PathLike[str]):
        self.path = Path(path)
        self._damaged: dict[Path, str] = {}

    @property
    def cells_path(self) -> Path:
        return self.path / "cells"

    def arrays_path(self, key: str) -> Path:
        """Where a cell keeps arrays, if it does."""
        return self.cells_path / f"{key}.npz"

    @property
    def damaged(self) -> list[str]:
        """One line for each file met so far that could not be used, and what became of it."""
        return list(self._damaged.values())

    @property
    def journal_path(self) -> Path:
        """Samples of the cells that are not done."""
        return self.path / "unfinished.jsonl"

    @contextmanager
    def lock(self):
        """Within this no other process measures into the folder, which is made where it is missing.

        The kernel ends the lock with the process. Gives None, or a line on why the file system has no locks.
        Raises StoreError where another process has the lock.
        """
        try:
            make_folder(self.path)
            handle = os.open(self.path, os.O_RDONLY)
        except OSError as error:
            raise StoreError(unwritable(self.path / "manifest.json", error)) from error
        try:
            yield self._locked(handle)
        finally:
            os.close(handle)

    def _locked(self, handle: int) -> str | None:
        try:
            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            raise StoreError(f"{self.path}: {_holder(handle)} measures into this folder; wait for its end, "
                             "or choose another folder") from None
        except OSError as error:
            return f"{self.path}: cannot be locked ({error.strerror}): let no other run write to it"
        return None

    def write_cell(self, cell: Mapping[str, Any]) -> None:
        """Store a cell durably. Raises StoreError (disk), ValueError (a record that no reader would take)."""
        record = {"schema": SCHEMA} | plain(cell)
        unknown = [name for name in record.get("values", {}) if name not in columns.VALUES]
        if unknown:
            raise ValueError(f"values.{unknown[0]}: no such column{nearest(unknown[0], columns.VALUES)}")
        wrong = fault(record) or ("" if KEY_FILE.fullmatch(f"{record['key']}.json") else "key: not a cell key")
        if wrong:
            raise ValueError(wrong)
        path = self.cells_path / f"{record['key']}.json"
        write_file(path, text(record), durable=True)
        self._damaged.pop(path, None)

    def has(self, key: str) -> bool:
        """Whether a usable record of the cell exists."""
        return self.cell(key) is not None

    def cell(self, key: str) -> Cell | None:
        """The record of a cell, or None where there is none that can be used."""
        path = self.cells_path / f"{key}.json"
        try:
            cell = read(path)
        except FileNotFoundError:
            return None
        except OSError as error:
            return self.skip(path, f"cannot be read: {error.strerror}")
        except ValueError as error:
            return self._set_aside(path, f"not JSON: {error}")
        if isinstance(cell, dict) and cell.get("schema") != SCHEMA:
            return self.skip(path, f"has schema {cell.get('schema')!r}, this program reads {SCHEMA}")
        wrong = fault(cell)
        if wrong is None and cell["key"] != key:
            wrong = f"is the record of {cell['key']}"
        return self._set_aside(path, wrong) if wrong else decoded(cell)

    def cells(self) -> list[Cell]:
        """Every usable cell: those of the manifest in its order, then the others by key."""
        try:
            names = sorted(entry.name for entry in os.scandir(self.cells_path) if not entry.name.startswith("."))
        except FileNotFoundError:
            names = []
        except OSError as error:
            raise StoreError(f"{self.cells_path}: cannot be read: {error.strerror}") from error
        found = []
        for name in names:
            if KEY_FILE.fullmatch(name):
                found.append(name.removesuffix(".json"))
            elif not name.endswith(".damaged") and not ARRAY_FILE.fullmatch(name):
                self.skip(self.cells_path / name, "not named as a cell file")
        planned = {k: i for i, k in enumerate(map(str, self.manifest().get("cells", [])))}
        found.sort(key=lambda k: (planned.get(k, len(planned)), k))
        return [cell for cell in map(self.cell, found) if cell is not None]

    def write_manifest(self, manifest: Mapping[str, Any]) -> None:
        """Replace manifest.json. Raises StoreError."""
        path = self.path / "manifest.json"
        write_file(path, text({"schema": SCHEMA} | plain(manifest)), durable=True)
        self._damaged.pop(path, None)

    def manifest(self) -> dict[str, Any]:
        """What manifest.json holds; empty where there is none that can be used."""
        path = self.path / "manifest.json"
        try:
            manifest = read(path)
        except FileNotFoundError:
            return {}
        except (OSError, ValueError) as error:
            self.skip(path, f"cannot be read: {error}")
            return {}
        if not (isinstance(manifest, dict) and manifest.get("schema") == SCHEMA
                and isinstance(manifest.get("cells", []), list)):
            self.skip(path, f"not a manifest of schema {SCHEMA}")
            return {}
        return manifest

    def skip(self, path: Path, why: str) -> None:
        """Name a file that is left in place and not used."""
        self._damaged[path] = f"{path}: {why}; left in place, not used"

    def _set_aside(self, path: Path, why: str) -> None:
        aside = path.with_name(f"{path.name}.damaged")
        try:
            os.replace(path, aside)
            self._damaged[path] = f"{path}: {why}; set aside as {aside.name}"
        except OSError:
            self.skip(path, why)


def find_results(paths: Iterable[str | os.PathLike[str]]) -> list[Path]:
    """Every folder with a manifest.json at or below `paths`, sorted within each, none twice.

    Raises UsageError for each path that does not exist or has no results.
    """
    found: dict[Path, None] = {}
    mistakes = []
    for start in map(Path, paths):
        below = sorted(_manifests(start))
        found.update(dict.fromkeys(below))
        if not start.is_dir():
            mistakes.append(f"{start}: no such folder; allowed: a folder that 'mfr-bench run' wrote, or one above such")
        elif not below:
            mistakes.append(f"{start}: no results in or below it; allowed: a folder that 'mfr-bench run' wrote, "
                            "or one above such")
    if mistakes:
        raise UsageError(mistakes)
    return list(found)


def _manifests(start: Path) -> Iterable[Path]:
    for folder, below, files in os.walk(start):
        below[:] = [name for name in below if name != "cells" and not name.startswith(".")]
        if "manifest.json" in files:
            yield Path(folder)
