"""Files that a scene is read from: what tells one from a later one of the same name."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping, Sequence
from functools import lru_cache
from pathlib import Path
from typing import Any

from ..errors import UsageError
from .meshes.companions import companions


def stamp(path: Path, wanted: str) -> tuple[int, int]:
    """Time and size of a file, which a changed one does not share. Raises UsageError where there is none.

    wanted: what the file should be, in the words of the error.
    """
    try:
        found = path.stat()
    except OSError as error:
        raise UsageError(f"{path}: {error.strerror}; allowed: {wanted}") from None
    return found.st_mtime_ns, found.st_size


@lru_cache(maxsize=64)
def _digest(path: str, stamped: tuple[int, int]) -> str:
    return hashlib.sha256(Path(path).read_bytes()).hexdigest()


def digest(paths: Sequence[Path], wanted: str) -> str:
    """Hash of the contents of all files and of those that they name, 16 hexadecimal digits."""
    parts = [_digest(str(path), stamped) for path, stamped in stamps(paths, wanted)]
    return hashlib.sha256(" ".join(parts).encode()).hexdigest()[:16]


def stamps(paths: Sequence[Path], wanted: str) -> list[tuple[Path, tuple[int, int]]]:
    """The stamp of each file, and of each that it names, such as an OBJ's materials."""
    found = []
    for path in paths:
        stamped = stamp(path, wanted)
        found += [(path, stamped), *((named, stamp(named, wanted)) for named in companions(path, stamped))]
    return found


def digest_of(scene: Mapping[str, Any]) -> str | None:
    """Hash of the contents of the files of a scene as a config has it, by whole paths; None where it has none."""
    named = [scene.get("file"), *(part["file"] for part in scene.get("files") or ())]
    paths = [Path(name) for name in named if name]
    return digest(paths, "a file that can be read") if paths else None
