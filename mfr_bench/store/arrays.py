"""Arrays that a cell keeps beside its numbers: DIR/cells/<key>.npz, written whole, for figures that show pixels.

    image      uint8 (H, W, 4)   premultiplied RGBA, row 0 at the bottom
    error      float16 (H, W)    largest channel error against the promised image, channels in [0, 1]
    loss       float16 (H, W)    the same against the image of all fragments
    fragments  uint16 (H, W)     fragments generated
    discarded  uint16 (H, W)     fragments refused before they were stored
"""

from __future__ import annotations

import io
import zipfile
from collections.abc import Mapping
from typing import TYPE_CHECKING

from ..config.model import KEPT
from . import ResultFolder, write_file

if TYPE_CHECKING:
    import numpy as np

DIMENSIONS = dict.fromkeys(KEPT, 2) | {"image": 3}
TYPES = {"image": "uint8", "error": "float16", "loss": "float16", "fragments": "uint16", "discarded": "uint16"}


def write_arrays(folder: ResultFolder, key: str, arrays: Mapping[str, np.ndarray]) -> None:
    """Keep a cell's arrays, in the types above; nothing where there are none. Raises StoreError."""
    import numpy as np

    if not arrays:
        return
    content = io.BytesIO()
    np.savez_compressed(content, **{name: np.asarray(array).astype(TYPES[name]) for name, array in arrays.items()})
    write_file(folder.arrays_path(key), content.getvalue(), durable=True)


def read_arrays(folder: ResultFolder, key: str) -> dict[str, np.ndarray]:
    """The arrays of a cell by name; none where it kept none. A file that cannot be used is named in `damaged`."""
    import numpy as np

    path = folder.arrays_path(key)
    try:
        with np.load(path, allow_pickle=False) as found:
            arrays = {name: found[name] for name in KEPT if name in found.files}
    except FileNotFoundError:
        return {}
    except (OSError, ValueError, EOFError, KeyError, zipfile.BadZipFile, zipfile.zlib.error) as error:
        folder.skip(path, f"cannot be read: {error}")
        return {}
    wrong = [name for name, array in arrays.items()
             if array.ndim != DIMENSIONS[name] or array.dtype != np.dtype(TYPES[name]) or not array.size]
    if wrong:
        folder.skip(path, f"{wrong[0]}: not {TYPES[wrong[0]]} of {DIMENSIONS[wrong[0]]} dimensions")
    return {name: array for name, array in arrays.items() if name not in wrong}
