"""One function for every mesh format: reads a file, and checks that it has what a scene needs."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ...errors import UsageError, nearest
from . import gltf, ply, wavefront
from .faces import Faces

READERS = {".obj": wavefront.read, ".stl": wavefront.read, ".ply": ply.read, ".gltf": gltf.read, ".glb": gltf.read}
FILE_BYTES_PER_FACE = 4  # least that any format takes for a face: bounds the faces before a file is read
MEMORY_BYTES_PER_FACE = 400  # at most, while a file is read


def read_mesh(path: Path, memory_mb: float = 4096.0) -> Faces:
    """The triangles of a mesh file in its order. Raises UsageError: one line that names the file, what and where."""
    reader = READERS.get(path.suffix.lower())
    if reader is None:
        raise UsageError(f"{path}: files {path.suffix or 'without an ending'} are not read; allowed: "
                         f"{', '.join(READERS)}{nearest(path.suffix, READERS)}; convert it")
    _hold_size(path, memory_mb)
    try:
        found = reader(path)
    except UsageError:
        raise
    except Exception as error:  # noqa: BLE001 - the readers' libraries raise anything over a damaged file
        raise UsageError(f"{path}: cannot be read as {path.suffix.upper().lstrip('.')}: {_said(error, path)}; "
                         "open it in a mesh editor and save it again") from None
    return _held(found, path)


def _hold_size(path: Path, memory_mb: float) -> None:
    """Raise UsageError for a file that is not there, or whose faces cannot fit the memory."""
    try:
        size = path.stat().st_size
    except OSError as error:
        raise UsageError(f"{path}: {error.strerror}; allowed: a mesh file ({', '.join(READERS)})") from None
    needed_mb = size / FILE_BYTES_PER_FACE * MEMORY_BYTES_PER_FACE / 50 / 2**20  # a face of text takes about 200 bytes
    if needed_mb > memory_mb:
        raise UsageError(f"{path}: {size / 2**20:.0f} MiB need about {needed_mb:.0f} MiB of memory to read, above the "
                         f"limit of {memory_mb:.0f} MiB; allowed: a smaller mesh; simplify it in a mesh editor")


def _held(found: Faces, path: Path) -> Faces:
    if not len(found):
        raise UsageError(f"{path}: it has no faces; allowed: a mesh with at least one triangle")
    wrong = ~np.isfinite(found.position).all(axis=(1, 2))
    if wrong.any():
        raise UsageError(f"{path}: face {int(np.argmax(wrong)) + 1} of {len(found)} has a corner that is no number; "
                         "allowed: finite coordinates; remove it in a mesh editor")
    return found


def _said(error: Exception, path: Path) -> str:
    """The library's reason on one line, without the path that stands before it."""
    text = " ".join(str(error).replace(str(path), path.name).split()).rstrip(".;")
    if isinstance(error, ValueError) or text.startswith("a face"):
        return text or "it is damaged"
    if isinstance(error, IndexError):
        return f"it refers to something that it does not have ({text})"
    return f"it is damaged ({type(error).__name__}: {text})"
