"""Arrays that a cell stores with its numbers: DIR/cells/<key>.npz, written whole, for figures that show pixels.

`columns.ARRAYS` lists them with their types.
"""

from __future__ import annotations

import io
import tokenize
from collections.abc import Mapping
from typing import TYPE_CHECKING

from .columns import ARRAYS
from .files import write_file
from .folder import ResultFolder
from .pack import BROKEN

if TYPE_CHECKING:
    import numpy as np

# The errors that numpy raises over an .npz that is none, is damaged, or announces more than it has.
NO_ARRAYS = (*BROKEN, MemoryError, SyntaxError, tokenize.TokenError)


def write_arrays(folder: ResultFolder, key: str, arrays: Mapping[str, np.ndarray]) -> None:
    """Keep a cell's arrays; nothing where there are none. Raises StoreError."""
    if arrays:
        write_file(folder.arrays_path(key), packed(arrays), durable=True)


def packed(arrays: Mapping[str, np.ndarray]) -> bytes:
    """The contents of a cell's .npz: its arrays, compressed, in the types of `columns.ARRAYS`; empty without any."""
    import numpy as np

    if not arrays:
        return b""
    content = io.BytesIO()
    typed = {name: np.asarray(array).astype(ARRAYS[name].type) for name, array in arrays.items()}
    np.savez_compressed(content, **typed)
    return content.getvalue()


def read_arrays(folder: ResultFolder, key: str) -> dict[str, np.ndarray]:
    """The arrays of a cell by name; none where it kept none. A file that cannot be used is named in `damaged`."""
    import numpy as np

    path = folder.arrays_path(key)
    try:
        with np.load(io.BytesIO(folder.content(path.name)), allow_pickle=False) as found:
            arrays = {name: found[name] for name in ARRAYS if name in found.files}
    except FileNotFoundError:
        return {}
    except NO_ARRAYS as error:
        folder.skip(path, f"cannot be read: {error}")
        return {}
    wrong = [name for name, array in arrays.items() if not isinstance(array, np.ndarray) or not array.size
             or array.ndim != ARRAYS[name].dimensions or array.dtype != np.dtype(ARRAYS[name].type)]
    if wrong:
        folder.skip(path, f"{wrong[0]}: not {ARRAYS[wrong[0]].type} of {ARRAYS[wrong[0]].dimensions} dimensions")
    return {name: array for name, array in arrays.items() if name not in wrong}
