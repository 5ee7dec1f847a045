"""Results as Parquet files, for analysis elsewhere: cells, passes and samples, with units and meanings in the files.

Written and read by fastparquet, 16 MB with what it needs; pyarrow, 170 MB, has the same types and reads these files.
Each file has a key `mfr-bench` in its metadata, a JSON object: `schema`, `units`, `meanings`, `types` by column, and in
that of the cells `manifests` by experiment. Structures (`params`, `scene`, …) are texts, in JSON.
"""

from __future__ import annotations

import json
import os
import warnings
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from .errors import MfrError, StoreError, UsageError
from .store.files import make_folder, unwritable

if TYPE_CHECKING:
    import pandas as pd

SCHEMA = 1
KEY = "mfr-bench"
FRAMES = ("cells", "passes", "samples")
FIRST = f"{FRAMES[0]}.parquet"  # by which a folder of such files is known
JSON_TYPE = "object"  # of columns that hold structures


def write_parquet(frames: Mapping[str, pd.DataFrame], manifests: Mapping[str, Any], target: Path) -> list[Path]:
    """Write TARGET/cells.parquet, passes.parquet and samples.parquet, each whole. Raises MfrError, StoreError."""
    library = _library()
    written = []
    for name in FRAMES:
        path = target / f"{name}.parquet"
        about = _about(frames[name]) | ({"manifests": manifests} if name == FRAMES[0] else {})
        part = path.with_name(f".{path.name}.{os.getpid()}.part")
        try:
            make_folder(target)
            library.write(str(part), _flat(frames[name]), compression="ZSTD", write_index=False,
                          custom_metadata={KEY: json.dumps(about, ensure_ascii=False)})
            part.replace(path)
        except OSError as error:
            raise StoreError(unwritable(path, error)) from error
        finally:
            part.unlink(missing_ok=True)
        written.append(path)
    return written


def read_parquet(folder: Path) -> tuple[dict[str, pd.DataFrame], dict[str, Any]]:
    """The frames that `write_parquet` wrote, with their types, units and meanings, and the manifests.

    Raises UsageError where a file is missing or of another program, MfrError without the library.
    """
    library = _library()
    frames, manifests = {}, {}
    for name in FRAMES:
        path = folder / f"{name}.parquet"
        try:
            file = library.ParquetFile(str(path))
            about = json.loads(file.key_value_metadata.get(KEY) or "null")
        except (OSError, ValueError, library.ParquetException) as error:
            raise UsageError(f"{path}: cannot be read: {error}") from None
        if not isinstance(about, dict) or about.get("schema") != SCHEMA:
            raise UsageError(f"{path}: is none of mfr-bench; allowed: what 'mfr-bench table --parquet' wrote")
        frames[name] = _typed(file.to_pandas(), about)
        manifests |= about.get("manifests") or {}
    return frames, manifests


def _library():
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", DeprecationWarning)  # it asks for an old option of pandas
            import fastparquet
    except ImportError:
        raise MfrError("Parquet needs the package fastparquet; install mfr-bench[parquet]") from None
    return fastparquet


def _about(frame: pd.DataFrame) -> dict[str, Any]:
    return {"schema": SCHEMA, **{name: frame.attrs.get(name, {}) for name in ("units", "meanings")},
            "types": {name: str(frame[name].dtype) for name in frame}}


def _flat(frame: pd.DataFrame) -> pd.DataFrame:
    """The frame with structures as JSON, and nothing beside its columns."""
    flat = frame.reset_index(drop=True)
    flat.attrs = {}
    for name in (n for n in flat if str(flat[n].dtype) == JSON_TYPE):
        flat[name] = [None if _missing(value) else json.dumps(value, ensure_ascii=False) for value in flat[name]]
        flat[name] = flat[name].astype("string")
    return flat


def _missing(value: Any) -> bool:
    import pandas as pd

    return not isinstance(value, (list, tuple, dict)) and pd.isna(value)


def _typed(frame: pd.DataFrame, about: Mapping[str, Any]) -> pd.DataFrame:
    types = about.get("types") or {}
    for name in (n for n in frame if types.get(n) == JSON_TYPE):
        frame[name] = [None if _missing(text) else json.loads(text) for text in frame[name]]
        frame[name] = frame[name].astype("object")
    frame = frame.astype({name: kind for name, kind in types.items() if name in frame and kind != JSON_TYPE})
    frame.attrs = {name: about.get(name) or {} for name in ("units", "meanings")}
    return frame
