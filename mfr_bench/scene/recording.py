"""Recorded fragments: an .npz with pixel, depth and colour of each in the order of submission, and its checks."""

from __future__ import annotations

import io
import zipfile
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import numpy as np

from ..effects import MSAA
from ..errors import UsageError
from . import files, npz
from .flat import submission
from .parameters import Scene
from .pieces import MaskedPieces, Pieces
from .spec.values import MAX_SIDE

WANTED = "an .npz of recorded fragments (docs/recording.md)"
AGAIN = f"{WANTED}; record it again"
NO_MASKS = "no array coverage, which msaa above 1 needs; allowed: msaa 1, or a recording with coverage masks"
MEMORY_PER_BYTE = 8  # bytes of memory that a scene and its oracle take for each byte of the arrays
MEMORY_MB = 4096.0  # most memory for recorded fragments


@dataclass(frozen=True)
class Recording:
    """Fragments in the order of submission.

    viewport: width and height in pixels. pixel: int32 (F, 2), x y from the lower left. depth: float32 (F,), window
    space, 0 nearest. rgba: uint8 (F, 4), straight alpha. object: int32 (F,) or None. front: bool (F,) or None.
    coverage: uint8 (F,) or None, a bit for each sample of the pixel that a fragment covers.
    """

    viewport: tuple[int, int]
    pixel: np.ndarray
    depth: np.ndarray
    rgba: np.ndarray
    object: np.ndarray | None = None
    front: np.ndarray | None = None
    coverage: np.ndarray | None = None

    def __len__(self) -> int:
        return len(self.depth)

    @property
    def counts(self) -> np.ndarray:
        """int64 (W·H,): the fragments of each pixel, row by row from the bottom."""
        width, height = self.viewport
        return np.bincount(self.pixel[:, 1].astype(np.int64) * width + self.pixel[:, 0], minlength=width * height)

    def packed(self) -> bytes:
        """The recording as an .npz."""
        optional = {name: values for name in OPTIONAL if (values := getattr(self, name)) is not None}
        data = io.BytesIO()
        np.savez_compressed(data, viewport=np.array(self.viewport, np.int32), pixel=self.pixel, depth=self.depth,
                            rgba=self.rgba, **optional)
        return data.getvalue()


@dataclass(frozen=True)
class Stored:
    """An array of a recording: its types, the best first, its width, and what its values have to be."""

    types: tuple[str, ...]
    width: int | None = None
    rule: Callable[[np.ndarray, tuple[int, int]], np.ndarray] | None = None  # which fragments are wrong
    allowed: str = ""

    def fault(self, values: np.ndarray, count: int, viewport: tuple[int, int]) -> str | None:
        """The fault of the array, in words that follow its name; None if it has none."""
        shape = (count, self.width) if self.width else (count,)
        if values.dtype.name not in self.types or values.shape != shape:
            return f"is {values.dtype} {values.shape}; allowed: {self.types[0]} {shape}"
        wrong = self.rule(values, viewport) if self.rule else np.zeros(count, bool)
        if not wrong.any():
            return None
        at = int(np.argmax(wrong))
        return f"of fragment {at} is {values[at].tolist()}; allowed: {self.allowed}"


def _outside(pixel: np.ndarray, viewport: tuple[int, int]) -> np.ndarray:
    return ((pixel < 0) | (pixel >= np.array(viewport))).any(axis=1)


def _no_depth(depth: np.ndarray, _viewport: tuple[int, int]) -> np.ndarray:
    return ~((depth >= 0) & (depth <= 1))


def _told_apart(depth: np.ndarray) -> np.ndarray:
    """Depths as every device tells them apart: it may take those below the least normal float32 for 0, and -0 for 0."""
    return np.where(depth < np.finfo(np.float32).tiny, np.float32(0), depth)


WHOLE = ("int32", "int64", "int16", "uint8", "uint16", "uint32")
NEEDED: Mapping[str, Stored] = {
    "pixel": Stored(WHOLE, 2, _outside, "x y from the lower left, within the viewport"),
    "depth": Stored(("float32",), None, _no_depth, "a number from 0 to 1"),
    "rgba": Stored(("uint8",), 4),
}
OPTIONAL: Mapping[str, Stored] = {
    "object": Stored(WHOLE), "front": Stored(("bool",)),
    "coverage": Stored(("uint8",), None, lambda masks, _viewport: masks == 0, "a bit for each sample, one at least"),
}


def fragments(config: Scene, _frame: int = 0) -> Pieces:
    """The recorded fragments of a config as quads of one pixel. Raises UsageError for a file that does not do."""
    made = recording_of(config.file_path)
    order = _order(config, made.depth)
    pixel = made.pixel[order]
    object_, front = (None if values is None else values[order] for values in (made.object, made.front))
    quads = made.viewport, np.hstack([pixel, pixel + 1]), made.depth[order], made.rgba[order], 1.0, config.seed
    if config.msaa == 1:
        return Pieces(*quads, object=object_, front=front)
    return MaskedPieces(*quads, object=object_, front=front, coverage=_masks(config, made)[order])


def _masks(config: Scene, made: Recording) -> np.ndarray:
    """uint8 (F,): the coverage masks. Raises UsageError where they have samples that a pixel has not."""
    if made.coverage is None:
        raise UsageError(f"{config.file_path}: {NO_MASKS}")
    beyond = made.coverage >> config.msaa > 0 if config.msaa < MSAA[-1] else np.zeros(len(made), dtype=bool)
    if beyond.any():
        at = int(np.argmax(beyond))
        raise UsageError(f"{config.file_path}: coverage of fragment {at} is {made.coverage[at]}; allowed with msaa "
                         f"{config.msaa}: 1 to {(1 << config.msaa) - 1}")
    return made.coverage


def _order(config: Scene, depth: np.ndarray) -> np.ndarray:
    """Indices of the fragments in the order of submission."""
    index = np.arange(len(depth), dtype=np.uint64)
    return index if config.order == "file" else submission(config.order, depth, index, config.seed)


def recording_of(path: Path) -> Recording:
    """The recording in a file. Raises UsageError: one line that says what is wrong with it and what is allowed."""
    return _recording(path, files.stamp(path, WANTED))


def viewport_of(path: Path) -> tuple[int, int]:
    """Width and height of a recording, without reading its fragments."""
    files.stamp(path, WANTED)
    with npz.opened(path, AGAIN) as found:
        return _viewport(path, found)


def has_masks(path: Path) -> bool:
    """Whether a recording has coverage masks, without reading them."""
    with npz.opened(path, AGAIN) as found:
        return "coverage" in found


def samples_of(path: Path) -> int:
    """The fewest samples a pixel that the coverage masks of a recording leave; 1 where it has none."""
    masks = recording_of(path).coverage
    if masks is None:
        return 1
    most = int(masks.max(initial=1))
    return next(count for count in MSAA[1:] if most < 1 << count)


def digest(path: Path) -> str:
    """Hash of the contents of a file."""
    return files.digest([path], WANTED)


def covered_counts(path: Path) -> list[int]:
    """Pixels with 0, 1, 2, … fragments, the covered ones only."""
    return list(_covered(path, files.stamp(path, WANTED)))


@lru_cache(maxsize=16)
def _covered(path: Path, stamped: tuple[int, int]) -> tuple[int, ...]:
    found = np.bincount(_recording(path, stamped).counts).tolist()
    return 0, *found[1:]


@lru_cache(maxsize=1)
def _recording(path: Path, _stamped: tuple[int, int]) -> Recording:
    _hold_size(path)
    with npz.opened(path, AGAIN) as found:
        viewport = _viewport(path, found)
        missing = [name for name in NEEDED if name not in found]
        if missing:
            raise UsageError(f"{path}: the array {missing[0]} is missing; allowed: viewport, {', '.join(NEEDED)}")
        arrays = {name: found[name] for name in (*NEEDED, *OPTIONAL) if name in found}
    count = len(arrays["depth"]) if arrays["depth"].ndim else 0
    for name, values in arrays.items():
        fault = (NEEDED | OPTIONAL)[name].fault(values, count, viewport)
        if fault:
            raise UsageError(f"{path}: {name} {fault}")
    return Recording(viewport, arrays["pixel"].astype(np.int32), _told_apart(arrays["depth"]), arrays["rgba"],
                     arrays["object"].astype(np.int32) if "object" in arrays else None, arrays.get("front"),
                     arrays.get("coverage"))


def _viewport(path: Path, found: Mapping[str, np.ndarray]) -> tuple[int, int]:
    if "viewport" not in found:
        raise UsageError(f"{path}: the array viewport is missing; allowed: viewport, {', '.join(NEEDED)}")
    values = found["viewport"]
    if values.dtype.kind not in "iu" or values.shape != (2,) or (values < 1).any() or (values > MAX_SIDE).any():
        raise UsageError(f"{path}: viewport is {values.dtype} {values.tolist()}; allowed: int32 width and height, each "
                         f"from 1 to {MAX_SIDE}")
    return int(values[0]), int(values[1])


def _hold_size(path: Path) -> None:
    """Raise UsageError for a file whose arrays are too large for the memory, before any of them is read."""
    try:
        with zipfile.ZipFile(path) as file:
            size = sum(entry.file_size for entry in file.infolist())
    except (OSError, zipfile.BadZipFile):
        return  # said when it is opened
    needed_mb = size * MEMORY_PER_BYTE / 2**20
    if needed_mb > MEMORY_MB:
        raise UsageError(f"{path}: {size / 2**20:.0f} MiB of arrays need about {needed_mb:.0f} MiB of memory, above "
                         f"the limit of {MEMORY_MB:.0f} MiB; allowed: fewer fragments; record a smaller viewport")
