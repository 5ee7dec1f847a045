"""The packed form of a result folder: DIR/cells.zip has every file of DIR/cells/, byte for byte, under its name.

A file in DIR/cells/ counts before the one of its name in the pack, so that a run measures into a packed folder, and a
merge copies into it, without unpacking. Either form is written whole before the other is removed: a process that dies
between the two leaves both, which say the same.
"""

from __future__ import annotations

import io
import os
import struct
import zipfile
import zlib
from collections.abc import Mapping
from pathlib import Path

from ..errors import StoreError
from .files import sync_folder, unwritable, write_file

# The errors that reading a bad archive raises.
BROKEN = (OSError, ValueError, EOFError, KeyError, RuntimeError, zipfile.BadZipFile, zlib.error)
# What stands before each file of an archive: a signature, and the lengths of the name and of the extras after it.
LOCAL_HEADER, LOCAL_SIGNATURE = struct.Struct("<4s22xHH"), b"PK\3\4"
SAME_DATE = (1980, 1, 1, 0, 0, 0)  # of every file in a pack: the same cells make the same bytes


class Pack:
    """The files in a pack by name; none where there is no pack. Raises ValueError where it cannot be read."""

    def __init__(self, path: Path):
        self.path = path
        self._archive: zipfile.ZipFile | None = None
        self._content = b""
        try:
            self._content = path.read_bytes()
            self._archive = zipfile.ZipFile(io.BytesIO(self._content))
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
        info = self._archive.NameToInfo[name]
        try:
            plain = info.compress_type == zipfile.ZIP_DEFLATED and not info.flag_bits
            return self._inflated(info) if plain else self._archive.read(name)
        except BROKEN as error:
            raise ValueError(f"damaged in {self.path.name}: {error}") from error

    def _inflated(self, info: zipfile.ZipInfo) -> bytes:
        """A file that `zipped` may have written: `ZipFile.read` takes four times as long. Raises what BROKEN has."""
        signature, name_length, extra_length = LOCAL_HEADER.unpack_from(self._content, info.header_offset)
        start = info.header_offset + LOCAL_HEADER.size
        name = self._content[start:start + name_length]
        if signature != LOCAL_SIGNATURE or name != info.orig_filename.encode():
            raise zipfile.BadZipFile(f"no file {info.filename} where the directory has it")
        start += name_length + extra_length
        inflating = zlib.decompressobj(-zlib.MAX_WBITS)
        found = inflating.decompress(self._content[start:start + info.compress_size], info.file_size + 1)
        if len(found) != info.file_size or zlib.crc32(found) != info.CRC:
            raise zipfile.BadZipFile(f"bad CRC-32 for file {info.filename}")
        return found


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
