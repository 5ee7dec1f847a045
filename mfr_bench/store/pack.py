"""The packed form of a result folder: DIR/cells.zip has every file of DIR/cells/, byte for byte, under its name.

A file in DIR/cells/ counts before the one of its name in the pack, so that a run measures into a packed folder, and a
merge copies into it, without unpacking. Either form is written whole before the other is removed: a process that dies
between the two leaves both, which say the same.
"""

from __future__ import annotations

import io
import os
import zipfile
import zlib
from collections.abc import Mapping
from pathlib import Path

from ..errors import StoreError
from .files import sync_folder, unwritable, write_file

# The errors that reading a bad archive raises.
BROKEN = (OSError, ValueError, EOFError, KeyError, RuntimeError, zipfile.BadZipFile, zlib.error)
SAME_DATE = (1980, 1, 1, 0, 0, 0)  # of every file in a pack: the same cells make the same bytes


class Pack:
    """The files in a pack by name; none where there is no pack. Raises ValueError where it cannot be read."""

    def __init__(self, path: Path):
        self.path = path
        self._archive: zipfile.ZipFile | None = None
        try:
            self._archive = zipfile.ZipFile(io.BytesIO(path.read_bytes()))
        except FileNotFoundError:
            pass
        except BROKEN as error:
            raise ValueError(f"cannot be read: {error}") from error

    @property
    def names(self) -> list[str]:
        return self._archive.namelist() if self._archive else []

    def read(self, name: str) -> bytes:
        """One file. Raises FileNotFoundError where the pack lacks it, ValueError where it is damaged."""
        if self._archive is None or name not in self._archive.NameToInfo:
            raise FileNotFoundError(name)
        try:
            return self._archive.read(name)
        except BROKEN as error:
            raise ValueError(f"damaged in {self.path.name}: {error}") from error


def zipped(files: Mapping[str, bytes]) -> bytes:
    """A zip archive of these files by name; the same files make the same bytes."""
    content = io.BytesIO()
    with zipfile.ZipFile(content, "w", zipfile.ZIP_DEFLATED) as archive:
        for name in sorted(files):
            member = zipfile.ZipInfo(name, SAME_DATE)
            member.compress_type, member.external_attr = zipfile.ZIP_DEFLATED, 0o644 << 16
            archive.writestr(member, files[name])
    return content.getvalue()


def write_pack(path: Path, files: Mapping[str, bytes]) -> None:
    """Replace the pack durably, whole or not at all. Raises StoreError."""
    write_file(path, zipped(files), durable=True)


def remove(paths: list[Path]) -> None:
    """Delete files whose content stands elsewhere, and their folder where nothing is left in it. Raises StoreError."""
    for path in paths:
        try:
            path.unlink(missing_ok=True)
        except OSError as error:
            raise StoreError(unwritable(path, error)) from error
    for folder in {path.parent for path in paths}:
        if folder.is_dir() and not os.listdir(folder):
            folder.rmdir()
        sync_folder(folder if folder.is_dir() else folder.parent)
