"""Pictures for the page: figures with few colours, kept images over a checkerboard, each as a data URI.

They are lossless WebP, which takes three quarters of the bytes of PNG for a figure and half of them for an image.
"""

from __future__ import annotations

import base64
import io
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from ..errors import StoreError
from ..report import style
from ..report.checkerboard import over_checkerboard
from ..report.figures.seal import SAID, SAID_ROWS

COLOURS = 256  # of a figure's palette, at most
APART = 130  # of two colours of a palette: no colour of a figure is further than that from the one that stands for it
AREA = 0.002  # share of the pixels from which a colour is in the palette, however near another one is
NAMED_AREA = 0.0001  # the same of a colour that stands for a pass, a method or an outcome: less than a key of a legend
CHECKER_PIXELS, CHECKER_GREYS = 8, (0.8, 1.0)  # of a square behind what is transparent
LARGEST_PIXELS = 512  # side of a kept image; larger ones are shown at every n-th pixel
SMALLEST_PIXELS = 192  # smaller ones are enlarged by whole factors


def data_uri(content: bytes, kind: str) -> str:
    """The bytes of an image, `png` or `webp`, as an address that needs no file."""
    return f"data:image/{kind};base64," + base64.b64encode(content).decode()


def figure_picture(path: Path) -> tuple[str, int, int, tuple[str, ...]]:
    """A figure's file as a data URI with few colours, its width and height in pixels, and its small print.

    The small print, which takes half of the bytes as pixels, is left out of the picture where the file has it as text,
    a line for each thing that it says; where the file does not tell how many rows show it, these stay. Raises
    StoreError where the file is damaged.
    """
    with _opened(path) as opened:
        said, told = opened.info.get(SAID, ""), opened.info.get(SAID_ROWS, "")
        rows = int(told) if told.isdecimal() and int(told) < opened.height else 0
        image = _with_few_colours(opened.convert("RGB").crop((0, 0, opened.width, opened.height - rows)))
    return data_uri(_encoded(image), "webp"), image.width, image.height, tuple(said.splitlines())


def _opened(path: Path):
    """The image of a figure's file."""
    from PIL import Image

    try:
        opened = Image.open(path)
        opened.load()
    except (OSError, SyntaxError, ValueError) as error:
        raise StoreError(f"{path}: no picture ({error}); mfr-bench plot {path.parents[1]} draws it again") from None
    return opened


def _with_few_colours(image):
    """The image with each colour replaced by the nearest of a palette.

    The palette has the most frequent colours that are far enough apart: those of text, lines and bars as they are, and
    few of those between them at smooth edges; and all that a legend may name, such as the like ones of two passes.
    Pillow's median cut gives text most of a palette, and lines of like colours, such as red and purple ones, a common
    one.
    """
    from PIL import Image

    found = sorted(image.getcolors(image.width * image.height), reverse=True)
    colours = np.array([colour for _, colour in found], dtype=np.int32)
    areas = np.array([count for count, _ in found]) / (image.width * image.height)
    least = np.where(np.isin(_codes(colours), _named()), NAMED_AREA, AREA)
    nearest = colours[_nearest_chosen(colours, np.where(areas >= least, 1, APART**2))]
    table = np.zeros((2**24, 3), dtype=np.uint8)  # only the pages of colours that are there take memory
    table[_codes(colours)] = nearest
    return Image.fromarray(table[_codes(np.asarray(image, dtype=np.int32))])


def _nearest_chosen(colours: np.ndarray, apart: np.ndarray) -> np.ndarray:
    """Choose at most COLOURS of the colours, the first ones first; for each colour the place of the nearest chosen one.

    apart: for each colour the squared distance from those chosen before from which on it is chosen itself.
    """
    distance = np.full(len(colours), np.iinfo(np.int32).max)
    nearest = np.zeros(len(colours), dtype=np.int64)
    for _ in range(COLOURS):
        place = int(np.argmax(distance >= apart))
        if distance[place] < apart[place]:
            break
        own = ((colours - colours[place]) ** 2).sum(axis=1)
        nearest[own < distance] = place
        distance = np.minimum(distance, own)
    return nearest


def _named() -> list[int]:
    """The colours that stand for something in figures, as numbers of 24 bits."""
    outcomes = [fill for fill, _ in style.STATE_COLOURS.values()]
    return [int(colour[1:], 16) for colour in (
        *style.PASS_COLOURS.values(), *style.SPARE_PASS_COLOURS, *style.VARIANT_COLOURS,
        *style.method_colours().values(), *outcomes)]


def _codes(colours: np.ndarray) -> np.ndarray:
    """Colours (..., 3) as numbers of 24 bits."""
    return colours[..., 0] << 16 | colours[..., 1] << 8 | colours[..., 2]


def kept_picture(image: np.ndarray) -> tuple[str, int, int]:
    """A kept image as a data URI, and its width and height.

    image: (H, W, 4) in 0 to 255, premultiplied, row 0 at the bottom, as a cell keeps it.
    """
    from PIL import Image

    upright = np.asarray(image, dtype=np.float64)[::-1]
    step = -(-max(upright.shape[:2]) // LARGEST_PIXELS)
    upright = upright[::step, ::step]
    times = max(1, SMALLEST_PIXELS // max(upright.shape[:2]))
    upright = upright.repeat(times, axis=0).repeat(times, axis=1)
    shown = 255 * over_checkerboard(upright / 255, CHECKER_PIXELS, CHECKER_GREYS)
    made = Image.fromarray(np.rint(shown).astype(np.uint8))
    return data_uri(_encoded(made), "webp"), made.width, made.height


def _encoded(image) -> bytes:
    content = io.BytesIO()
    image.convert("RGB").save(content, format="webp", lossless=True, method=3, quality=100)
    return content.getvalue()


def kept_images(arrays: Mapping[str, np.ndarray]) -> np.ndarray | None:
    """The image that a cell kept, or None."""
    image = arrays.get("image")
    return image if image is not None and image.ndim == 3 and image.shape[2] == 4 else None
