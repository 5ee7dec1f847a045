"""The arrays of an .npz that a user gives, whatever is wrong with it told in one line."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path

import numpy as np

from ..errors import UsageError
from ..store.arrays import NO_ARRAYS


class _Arrays(np.lib.npyio.NpzFile):
    """Raises ValueError for a member that is no array, of which numpy gives the bytes."""

    def __getitem__(self, name: str) -> np.ndarray:
        found = super().__getitem__(name)
        if isinstance(found, np.ndarray):
            return found
        raise ValueError(f"{name} is no array")


@contextmanager
def opened(path: Path, wanted: str) -> Iterator[Mapping[str, np.ndarray]]:
    """The arrays of a file by name, each read when it is asked for.

    Raises UsageError where the file or an array that is asked for cannot be read. wanted: what the file should be.
    """
    try:
        with path.open("rb") as file, _Arrays(file, allow_pickle=False) as found:
            yield found
    except NO_ARRAYS as error:
        raise UsageError(f"{path}: cannot be read ({' '.join(str(error).split())}); allowed: {wanted}") from None
