"""The process that makes the fragments of a scene from outside: it imports the scene's module and writes an .npz."""

from __future__ import annotations

import json
import os
import sys
import traceback
from pathlib import Path

import numpy as np

from ..methods.loading import module_of

FAILED = 4  # exit status


def main() -> None:
    """Arguments: place and name of the scene's module, what its function is given as JSON, the file to write."""
    place, name, given, out = sys.argv[1:]
    try:
        arguments = json.loads(given)
        arrays = module_of(name, place).fragments(tuple(arguments.pop("size")), **arguments)
        with open(out, "wb") as file:
            np.savez_compressed(file, viewport=np.array(json.loads(given)["size"], np.int32), **arrays)
    except (Exception, SystemExit) as error:  # noqa: BLE001 - whatever foreign code raises is one line
        frames = [frame for frame in traceback.extract_tb(error.__traceback__) if Path(frame.filename).stem == name]
        where = f"{frames[-1].filename}:{frames[-1].lineno}: " if frames else ""
        sys.stderr.write(f"\n{where}{' '.join(f'{type(error).__name__}: {error}'.split())}\n")
        sys.stderr.flush()
        os._exit(FAILED)
    os._exit(0)  # without the exit handlers of foreign code
