"""Files that are replaced whole or not at all, and outlive a loss of power where they must."""

from __future__ import annotations

import errno
import os
from pathlib import Path

from ..errors import StoreError


def write_file(path: Path, content: bytes, durable: bool = False) -> None:
    """Replace `path` by `content`, whole or not at all; with `durable`, also after a loss of power.

    Raises StoreError where the disk is full or the folder cannot be written.
    """
    part = path.with_name(f".{path.name}.{os.getpid()}.part")
    try:
        make_folder(path.parent)
        try:
            with open(part, "wb") as file:
                file.write(content)
                file.flush()
                if durable:
                    os.fsync(file.fileno())
            os.replace(part, path)
        finally:
            part.unlink(missing_ok=True)
        if durable:
            sync_folder(path.parent)
    except OSError as error:
        raise StoreError(unwritable(path, error)) from error


def make_folder(folder: Path) -> None:
    """A folder that outlives a loss of power: its name is synced too, not only what it holds."""
    if not folder.is_dir():
        if folder.exists():
            raise NotADirectoryError(errno.ENOTDIR, os.strerror(errno.ENOTDIR))
        make_folder(folder.parent)
        folder.mkdir(exist_ok=True)
        sync_folder(folder.parent)


def sync_folder(folder: Path) -> None:
    handle = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)


def unwritable(path: Path, error: OSError) -> str:
    """One line: which file, why not, and what to do."""
    full = error.errno in (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)
    locked = error.errno in (errno.EACCES, errno.EPERM, errno.EROFS)
    what = "free some space or " if full else "make the folder writable or " if locked else ""
    return (f"{path}: cannot be written: {error.strerror or error}; {what}choose another folder, "
            "then run the same command again: what is written stays")
