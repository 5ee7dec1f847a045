"""Files that a scene is read from: what tells one from a later one of the same name."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from functools import lru_cache
from pathlib import Path

from ..errors import UsageError


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
    """Hash of the contents of all files, 16 hexadecimal digits."""
    parts = [_digest(str(path), stamp(path, wanted)) for path in paths]
    return hashlib.sha256(" ".join(parts).encode()).hexdigest()[:16]
