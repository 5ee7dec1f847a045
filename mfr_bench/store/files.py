"""Files that are replaced whole or not at all, and outlive a loss of power where they must; locks of folders."""

from __future__ import annotations

import errno
import fcntl
import glob
import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path

from ..errors import StoreError

HOST = os.uname().nodename  # part of a file's name until it is whole: a folder may be shared by machines
WAITING = 16  # files that the disk is given at once


def write_file(path: Path, content: bytes, durable: bool = False) -> None:
    """Replace `path` by `content`, whole or not at all; with `durable`, also after a loss of power.

    Raises StoreError where the disk is full or the folder cannot be written.
    """
    try:
        make_folder(path.parent)
        _replace(path, content, durable)
        if durable:
            sync_folder(path.parent)
    except OSError as error:
        raise StoreError(unwritable(path, error)) from error


def write_files(folder: Path, files: Mapping[str, bytes]) -> None:
    """Replace files of a folder, each whole or not at all, durably; what comes first is not told.

    A disk takes many waiting files at once: 200 of 6 KB take 0.1 s where one after the other takes 2.5 s. Raises
    StoreError where the disk is full or the folder cannot be written.
    """
    if not files:
        return
    from concurrent.futures import ThreadPoolExecutor  # with what it loads, as much as the rest of the store

    def replaced(name: str) -> None:
        try:
            _replace(folder / name, files[name], durable=True)
        except OSError as error:
            raise StoreError(unwritable(folder / name, error)) from error

    try:
        make_folder(folder)
        with ThreadPoolExecutor(WAITING) as pool:
            for _ in pool.map(replaced, files):
                pass
        sync_folder(folder)
    except OSError as error:
        raise StoreError(unwritable(folder, error)) from error


def _replace(path: Path, content: bytes, durable: bool) -> None:
    part = path.with_name(f".{path.name}.{HOST}.{os.getpid()}.part")
    try:
        with open(part, "wb") as file:
            file.write(content)
            file.flush()
            if durable:
                os.fsync(file.fileno())
        os.replace(part, path)
    finally:
        part.unlink(missing_ok=True)


def remove_parts(folder: Path) -> None:
    """Remove what processes of this machine that were killed while they wrote have left in the folder."""
    for path in folder.glob(f".*.{glob.escape(HOST)}.*.part"):
        if not Path("/proc", path.name.split(".")[-2]).exists():
            path.unlink(missing_ok=True)


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


@contextmanager
def locked(file: Path, does: str, instead: str) -> Iterator[str | None]:
    """Within this no other process has the lock of the file's folder, which is made where it is missing.

    The kernel ends the lock with the process. Gives None, or a line on why the file system has no locks. Raises
    StoreError where the folder cannot be made, or where another process has the lock: which one, what it `does`, and
    what to do `instead`.
    """
    folder = file.parent
    try:
        make_folder(folder)
        handle = os.open(folder, os.O_RDONLY)
    except OSError as error:
        raise StoreError(unwritable(file, error)) from error
    try:
        yield _lock(folder, handle, does, instead)
    finally:
        os.close(handle)


def _lock(folder: Path, handle: int, does: str, instead: str) -> str | None:
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        raise StoreError(f"{folder}: {_holder(handle)} {does}; {instead}") from None
    except OSError as error:
        return f"{folder}: cannot be locked ({error.strerror}): let no other process write to it"
    return None


def _holder(handle: int) -> str:
    """The process that has the lock on an open folder, as far as the kernel reports it."""
    inode = os.fstat(handle).st_ino
    with suppress(OSError):
        for line in Path("/proc/locks").read_text().splitlines():
            _, kind, _, _, pid, where, *_ = line.split()
            if kind == "FLOCK" and where.rpartition(":")[2] == str(inode) and int(pid) > 0:
                return f"process {pid}"
    return "another process"


def unwritable(path: Path, error: OSError) -> str:
    """One line: which file, why not, and what to do."""
    full = error.errno in (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)
    locked = error.errno in (errno.EACCES, errno.EPERM, errno.EROFS)
    what = "free some space or " if full else "make the folder writable or " if locked else ""
    return (f"{path}: cannot be written: {error.strerror or error}; {what}choose another folder, "
            "then run the same command again: what is written stays")
