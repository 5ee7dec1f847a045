"""Result folders: one durable file per cell and a manifest, or the packed form of both."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from ..errors import StoreError, UsageError, nearest
from . import columns
from .files import locked, remove_parts, write_file, write_files
from .manifest import sound
from .pack import Pack, remove, write_pack
from .record import (
    KEY_FILE,
    SCHEMA,
    Cell,
    Shared,
    decoded,
    fault,
    is_cell_file,
    other_schema,
    parsed,
    plain,
    read,
    schema_of,
    text,
)


class ResultFolder:
    """The measurements of one config on one device. Nothing is created before the first write."""

    def __init__(self, path: str | os.PathLike[str]):
        self.path = Path(path)
        self._cells = os.path.join(self.path, "cells", "")
        self._damaged: dict[Path, str] = {}
        self._pack: tuple[tuple[int, ...], Pack | None] = (), None  # with what tells it from a later one

    def __getstate__(self) -> dict[str, Any]:
        return self.__dict__ | {"_pack": ((), None)}  # another process reads it by itself

    @property
    def cells_path(self) -> Path:
        return self.path / "cells"

    @property
    def pack_path(self) -> Path:
        """The packed form of the cells, see `pack`."""
        return self.path / "cells.zip"

    def arrays_path(self, key: str) -> Path:
        """The path of a cell's arrays, if it has any and they are not packed."""
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
    def lock(self) -> Iterator[str | None]:
        """Within this no other process measures into the folder, which is made where it is missing; see `locked`.

        Raises StoreError also where a newer program wrote into the folder.
        """
        file, does = self.path / "manifest.json", "measures into this folder"
        with locked(file, does, "wait for its end, or choose another folder") as unlocked:
            self.refuse_newer()
            for folder in (self.path, self.cells_path):
                remove_parts(folder)
            yield unlocked

    # --- cells -----------------------------------------------------------------------------------

    def write_cell(self, cell: Mapping[str, Any]) -> None:
        """Store a cell durably. Raises StoreError where the disk fails, and what `file_of` raises."""
        self.write_content(*self.file_of(cell))

    def file_of(self, cell: Mapping[str, Any]) -> tuple[str, bytes]:
        """The name of a cell's file and its content, for `write_content`.

        Raises StoreError for a record of a newer program in its place, ValueError for one that no reader would take.
        """
        record = {"schema": SCHEMA} | plain(cell)
        unknown = [name for name in record.get("values", {}) if name not in columns.VALUES]
        if unknown:
            raise ValueError(f"values.{unknown[0]}: no such column{nearest(unknown[0], columns.VALUES)}")
        wrong = fault(record) or ("" if KEY_FILE.fullmatch(f"{record['key']}.json") else "key: not a cell key")
        if wrong:
            raise ValueError(wrong)
        path = self.cells_path / f"{record['key']}.json"
        self._refuse_newer(path)
        return path.name, text(record)

    def write_content(self, name: str, content: bytes) -> None:
        """Store a file of the cells as it is, durably."""
        write_file(self.cells_path / name, content, durable=True)
        self._damaged.pop(self.cells_path / name, None)

    def has(self, key: str) -> bool:
        """Whether a usable record of the cell exists."""
        return self.cell(key) is not None

    def cell(self, key: str) -> Cell | None:
        """The record of a cell, or None where there is none that can be used."""
        return self._cell(key, self.content, None)

    def _cell(self, key: str, content: Callable[[str], bytes], shared: Shared | None) -> Cell | None:
        path = self.cells_path / f"{key}.json"
        try:
            cell = parsed(content(path.name), shared)
        except FileNotFoundError:
            return None
        except OSError as error:
            return self.skip(path, f"cannot be read: {error.strerror}")
        except ValueError as error:
            return self._set_aside(path, f"not JSON: {error}")
        if other := other_schema(cell):
            return self.skip(path, other)
        wrong = fault(cell, key)
        return self._set_aside(path, wrong) if wrong else decoded(cell)

    def cells(self) -> list[Cell]:
        """Every usable cell: those of the manifest in its order, then the others by key.

        What several have in common, such as a scene, may be one object: nobody changes it.
        """
        found = sorted((name.removesuffix(".json") for name in self.names() if KEY_FILE.fullmatch(name)),
                       key=self._place())
        content, shared = self.reader(), Shared()
        return [cell for key in found if (cell := self._cell(key, content, shared)) is not None]

    def in_order(self, records: Iterable[Cell]) -> list[Cell]:
        """Sound records of this folder as `cells` gives them."""
        place = self._place()
        return [decoded(record) for record in sorted(records, key=lambda record: place(record["key"]))]

    def _place(self) -> Callable[[str], tuple[int, str]]:
        """The place of a key: in the manifest's order, then those that it has not."""
        planned = {key: i for i, key in enumerate(map(str, self.manifest().get("cells", [])))}
        return lambda key: (planned.get(key, len(planned)), key)

    def content(self, name: str) -> bytes:
        """A file of the cells, loose or packed. Raises FileNotFoundError, OSError, ValueError (damaged in the pack)."""
        try:
            with open(f"{self._cells}{name}", "rb") as file:
                return file.read()
        except (FileNotFoundError, NotADirectoryError):
            pack = self._packed()
            if pack is None:
                raise FileNotFoundError(name) from None
            return pack.read(name)

    def reader(self) -> Callable[[str], bytes]:
        """`content` for many files: which of them are loose is found out once, now."""
        loose, pack = set(self.loose()), self._packed()
        return lambda name: self.content(name) if pack is None or name in loose else pack.read(name)

    def write_contents(self, files: Mapping[str, bytes]) -> None:
        """Store many as `write_content` does: records that were checked elsewhere, and their arrays."""
        write_files(self.cells_path, files)

    def write_replicate(self, key: str, content: bytes) -> None:
        """Keep the record that one of several devices gave of a cell, under a name that its content determines."""
        path = self._replicates / f"{key}.{hashlib.sha256(content).hexdigest()[:16]}.json"
        if not path.exists():
            write_file(path, content, durable=True)

    def replicates(self) -> dict[str, list[bytes]]:
        """The records of each cell that several devices gave, where a merge kept them, by key."""
        found: dict[str, list[bytes]] = {}
        for path in sorted(self._replicates.glob("*.*.json")):
            found.setdefault(path.name.partition(".")[0], []).append(path.read_bytes())
        return found

    @property
    def _replicates(self) -> Path:
        return self.path / "replicates"

    def names(self) -> list[str]:
        """Names of the files of cells and arrays, loose or packed, sorted; what else stands there is named."""
        pack = self._packed()
        loose = self.loose()
        for name in loose:
            if not (is_cell_file(name) or name.endswith(".damaged")):
                self.skip(self.cells_path / name, "not named as a cell file")
        return sorted(filter(is_cell_file, {*loose, *(pack.names if pack else ())}))

    def loose(self) -> list[str]:
        """Names of all files in cells/, sorted. Raises StoreError where it cannot be read."""
        try:
            return sorted(entry.name for entry in os.scandir(self.cells_path) if not entry.name.startswith("."))
        except FileNotFoundError:
            return []
        except OSError as error:
            raise StoreError(f"{self.cells_path}: cannot be read: {error.strerror}") from error

    def fingerprint(self) -> str:
        """A hash of the manifest and of everything in cells/ and in the pack: what derives from them can state it."""
        found = hashlib.sha256()
        loose = [self.cells_path / name for name in self.loose()]
        for path in (self.path / "manifest.json", self.pack_path, *loose):
            content = path.read_bytes() if path.is_file() else b""
            found.update(f"{path.name} {len(content)}\n".encode() + content)
        return found.hexdigest()

    def _packed(self) -> Pack | None:
        """The pack, read once; None where there is none that can be used, which is named."""
        try:
            status = os.stat(self.pack_path)
        except OSError:
            return None
        mark = status.st_ino, status.st_mtime_ns, status.st_size
        if self._pack[0] != mark:
            try:
                self._pack = mark, Pack(self.pack_path)
            except ValueError as error:
                self._pack = mark, self.skip(self.pack_path, str(error))
        return self._pack[1]

    def pack(self) -> int:
        """Put every file of usable cells into the pack, and remove them from cells/; how many cells it has.

        Raises StoreError where the disk fails or the pack that is there cannot be read.
        """
        if self._packed() is None and self.pack_path.exists():
            raise StoreError(f"{self.pack_path}: cannot be read; allowed: a pack that 'mfr-bench pack' wrote; "
                             "move it elsewhere, then run the same command again")
        files = self._read_packed()
        loose = self.loose()
        for name in filter(KEY_FILE.fullmatch, loose):
            key = name.removesuffix(".json")
            if self.has(key):
                files |= {n: self.content(n) for n in (name, f"{key}.npz") if n in loose}
        if files:
            write_pack(self.pack_path, files)
            remove([self.cells_path / name for name in loose if name in files])
        return sum(name.endswith(".json") for name in files)

    def unpack(self) -> int:
        """Write the files of the pack into cells/, but for those that are there, and remove it; how many cells it had.

        Raises StoreError where the disk fails or a file of the pack is damaged; the pack then stays.
        """
        if self._packed() is None and self.pack_path.exists():
            raise StoreError(f"{self.pack_path}: cannot be read; nothing was unpacked")
        files, loose = self._read_packed(), set(self.loose())
        self.write_contents({name: content for name, content in files.items() if name not in loose})
        if files:
            remove([self.pack_path])
        return sum(name.endswith(".json") for name in files)

    def _read_packed(self) -> dict[str, bytes]:
        """Every file of the pack by name. Raises StoreError where one is damaged."""
        pack = self._packed()
        files = {}
        for name in filter(is_cell_file, pack.names if pack else ()):
            try:
                files[name] = pack.read(name)
            except ValueError as error:
                raise StoreError(f"{self.pack_path}: {name}: {error}; nothing was changed") from error
        return files

    # --- manifest --------------------------------------------------------------------------------

    def write_manifest(self, manifest: Mapping[str, Any]) -> None:
        """Replace manifest.json. Raises StoreError, also where a newer program wrote the one that is there."""
        path = self.path / "manifest.json"
        self._refuse_newer(path)
        write_file(path, text({"schema": SCHEMA} | plain(manifest)), durable=True)
        self._damaged.pop(path, None)

    def manifest(self) -> dict[str, Any]:
        """The content of manifest.json; empty if there is none that can be used."""
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
        kept, wrong = sound(manifest)
        for where in wrong:
            self.skip(path, f"{where}: not of its type")
        return kept

    def refuse_newer(self) -> None:
        """Raise StoreError where a newer program wrote the manifest or a cell, before anything is measured."""
        self._refuse_newer(self.path / "manifest.json")
        for name in self.names():
            if KEY_FILE.fullmatch(name):
                self._refuse_newer(self.cells_path / name)

    def _refuse_newer(self, path: Path) -> None:
        try:
            content = path.read_bytes() if path.parent == self.path else self.content(path.name)
        except (OSError, ValueError):
            return
        schema = schema_of(content)
        if schema is not None and schema > SCHEMA:
            raise StoreError(f"{path}: has schema {schema}, and this program writes {SCHEMA}: a newer mfr-bench wrote "
                             "it; use that one, or choose another folder (--out)")

    def skip(self, path: Path, why: str) -> None:
        """Name a file that is left in place and not used."""
        self._damaged[path] = f"{path}: {why}; left in place, not used"

    def _set_aside(self, path: Path, why: str) -> None:
        if not path.exists():  # it is in the pack
            return self.skip(path, why)
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


def folders_with_cells(root: Path) -> list[Path]:
    """The folders right below `root` that have cells in any form, sorted."""
    return sorted({path.parent for name in ("cells", "cells.zip") for path in root.glob(f"*/{name}")})


def _manifests(start: Path) -> Iterable[Path]:
    for folder, below, files in os.walk(start):
        below[:] = [name for name in below if name != "cells" and not name.startswith(".")]
        if "manifest.json" in files:
            yield Path(folder)
