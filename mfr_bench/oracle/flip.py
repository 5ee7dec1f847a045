"""NVIDIA's FLIP of two images as a screen of 8 bits shows them, evaluated only where they differ.

Its threads wait for each other asleep. By default they spin: a call took 80 ms of processor time instead of 2, however
small its image was, on two cores that had other work, and held up what the device drew meanwhile.
"""

from __future__ import annotations

import hashlib
import os
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

TOLERANCE = 1 / 512  # half a step of 8 bits: a value that is further outside [0, 1] is on no screen
REACH = 10  # pixels: at 67 pixels per degree, FLIP's default, its filters see no further
SIDES = (4, 16, 64, 256)  # of the blocks that are evaluated, in pixels, without their surroundings
BACKDROPS = (0.0, 1.0)  # black and white


@dataclass(frozen=True)
class OnScreen:
    """An image and its oracle as a screen of 8 bits shows them.

    pairs: both, uint8 (H, W, 3), over black and over white. shown: bool (H, W), the pixels of the image that are
    finite and in [0, 1].
    """

    pairs: tuple[tuple[np.ndarray, np.ndarray], ...]
    shown: np.ndarray

    @classmethod
    def of(cls, image: np.ndarray, oracle: np.ndarray) -> OnScreen:
        """Images are (H, W, 4), premultiplied."""
        return cls.beside(image, displays(oracle))

    @classmethod
    def beside(cls, image: np.ndarray, references: Sequence[np.ndarray]) -> OnScreen:
        """An image, as above, and what a screen shows of its oracle, as `displays` gives it."""
        shown = np.all((image >= -TOLERANCE) & (image <= 1 + TOLERANCE), axis=-1)  # false of what is no number
        return cls(tuple(zip(references, displays(image), strict=True)), shown)

    @property
    def digest(self) -> bytes:
        """Tells what a screen shows of the image from what it shows of others."""
        found = hashlib.sha256(np.packbits(self.shown))
        for _, image in self.pairs:
            found.update(image)
        return found.digest()

    @property
    def equal(self) -> bool:
        """Whether a screen shows no difference in any pixel, over neither backdrop."""
        return bool(self.shown.all()) and all(np.array_equal(*pair) for pair in self.pairs)

    def flip(self) -> float:
        """Mean of FLIP's map over black or over white, whichever is larger; a pixel that is not shown counts as 1."""
        return max(float(np.where(self.shown, flip_map(*pair), 1.0).mean()) for pair in self.pairs)


def displays(image: np.ndarray) -> tuple[np.ndarray, ...]:
    """What a screen shows of an image, (H, W, 4) and premultiplied, over each of BACKDROPS."""
    return tuple(displayed(image, backdrop) for backdrop in BACKDROPS)


def displayed(image: np.ndarray, backdrop: float) -> np.ndarray:
    """The colours that a screen of 8 bits shows of a premultiplied image over a grey backdrop: uint8 (H, W, 3)."""
    finite = np.where(np.isfinite(image), image, 0.0)
    over = finite[..., :3] + backdrop * (1 - finite[..., 3:])
    return np.rint(255 * np.clip(over, 0, 1)).astype(np.uint8)


def flip_map(reference: np.ndarray, test: np.ndarray) -> np.ndarray:
    """FLIP of each pixel of two uint8 (H, W, 3) images: float32 (H, W).

    Of rows and columns that repeat, as where large quads show, no more are evaluated than the filters tell apart.
    """
    rows = _evaluated_lines(reference, test)
    reference, test = (image[rows.kept] for image in (reference, test))
    columns = _evaluated_lines(*(image.swapaxes(0, 1) for image in (reference, test)))
    found = _around_what_differs(*(np.ascontiguousarray(image[:, columns.kept]) for image in (reference, test)))
    return found[rows.of][:, columns.of]


@dataclass(frozen=True)
class _Lines:
    """Which lines of an image are evaluated, and which of them each line of the image looks like to the filters."""

    kept: np.ndarray
    of: np.ndarray


def _evaluated_lines(*images: np.ndarray) -> _Lines:
    """Keeps, of lines that repeat in all images, REACH at either end and one for those between, which see the same."""
    new = np.ones(len(images[0]), dtype=bool)
    new[1:] = np.any([(image[1:] != image[:-1]).any(axis=(1, 2)) for image in images], axis=0)
    starts = np.flatnonzero(new)
    lengths = np.diff(starts, append=len(new))
    place = np.arange(len(new)) - np.repeat(starts, lengths)
    kept = (place <= REACH) | (np.repeat(lengths, lengths) - place <= REACH)
    return _Lines(np.flatnonzero(kept), np.cumsum(kept) - 1)


def _around_what_differs(reference: np.ndarray, test: np.ndarray) -> np.ndarray:
    """The map, 0 where no pixel within REACH differs.

    If few do, the blocks around them are cut out with what the filters see, and evaluated side by side as one image.
    """
    found = np.zeros(reference.shape[:2], np.float32)
    differ = np.any(reference != test, axis=-1)
    if not differ.any():
        return found
    side, blocks = _blocks(differ)
    if len(blocks) * _width(side) ** 2 >= found.size:
        return _evaluated(reference, test)
    patches = _evaluated(*(_cut_out(image, blocks, side) for image in (reference, test)))
    for (y, x), patch in zip(blocks, np.split(patches, len(blocks)), strict=True):
        top, left = max(0, y - REACH), max(0, x - REACH)
        into = found[top:y + side + REACH, left:x + side + REACH]
        y_in, x_in = top - y + 2 * REACH, left - x + 2 * REACH
        into[:] = patch[y_in:y_in + into.shape[0], x_in:x_in + into.shape[1]]
    return found


def _width(side: int) -> int:
    """The width of a block with what its values and those within REACH of it depend on."""
    return side + 4 * REACH


def _blocks(differ: np.ndarray) -> tuple[int, np.ndarray]:
    """The corners (y, x) of the blocks that hold all pixels that differ, and their side: the least work of all.

    differ: bool (H, W).
    """
    found, within = [], 1
    for side in SIDES:
        differ, within = _any_of_each_block(differ, side // within), side
        found.append((side, side * np.argwhere(differ)))
    return min(found, key=lambda each: len(each[1]) * _width(each[0]) ** 2)


def _any_of_each_block(of: np.ndarray, side: int) -> np.ndarray:
    """Whether any element of each block of side x side elements is true; the last blocks may reach beyond the edge."""
    rows, columns = (-(-length // side) for length in of.shape)
    padded = np.zeros((rows * side, columns * side), dtype=bool)
    padded[:of.shape[0], :of.shape[1]] = of
    return padded.reshape(rows, side, columns, side).any(axis=(1, 3))


def _cut_out(image: np.ndarray, blocks: Iterable[tuple[int, int]], side: int) -> np.ndarray:
    """The blocks with their surroundings, one above the other. FLIP repeats an image's edge beyond it, as here."""
    around = 2 * REACH
    padded = np.pad(image, ((around, around + side), (around, around + side), (0, 0)), mode="edge")
    return np.concatenate([padded[y:y + _width(side), x:x + _width(side)] for y, x in blocks])


def _evaluated(reference: np.ndarray, test: np.ndarray) -> np.ndarray:
    os.environ.setdefault("OMP_WAIT_POLICY", "passive")  # read when the module is loaded
    import flip_evaluator  # a compiled module; only images that differ need it

    found, _, _ = flip_evaluator.evaluate(*(np.ascontiguousarray(image, np.float32) / np.float32(255)
                                            for image in (reference, test)), "LDR", applyMagma=False,
                                          computeMeanError=False)
    return found[..., 0]
