"""Pictures for the page: figures with few colours, kept images over a checkerboard, each as a data URI.

They are lossless WebP, which takes three quarters of the bytes of PNG for a figure and half of them for an image.
"""

from __future__ import annotations

import base64
import io
from collections.abc import Mapping
from pathlib import Path

import numpy as np

COLOURS = 24  # of a figure's palette: text, bars and lines need no more, and the file is a third
CHECK_PIXELS, LIGHT, DARK = 8, 255, 204  # of the checkerboard behind what is transparent
LARGEST_PIXELS = 512  # side of a kept image; larger ones are shown at every n-th pixel
SMALLEST_PIXELS = 192  # smaller ones are enlarged by whole factors


def data_uri(content: bytes, kind: str) -> str:
    """The bytes of an image, `png` or `webp`, as an address that needs no file."""
    return f"data:image/{kind};base64," + base64.b64encode(content).decode()


def figure_picture(path: Path) -> tuple[str, int, int]:
    """A figure's file as a data URI with a palette, and its width and height in pixels. Raises OSError."""
    from PIL import Image

    with Image.open(path) as opened:
        image = opened.convert("RGB").quantize(COLOURS, dither=Image.Dither.NONE)
    return data_uri(_encoded(image), "webp"), image.width, image.height


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
    y, x = np.indices(upright.shape[:2]) // CHECK_PIXELS
    board = np.where((x + y) % 2, LIGHT, DARK)[..., None]
    shown = upright[..., :3] + board * (1 - upright[..., 3:] / 255)
    made = Image.fromarray(np.clip(np.rint(shown), 0, 255).astype(np.uint8))
    return data_uri(_encoded(made), "webp"), made.width, made.height


def _encoded(image) -> bytes:
    content = io.BytesIO()
    image.convert("RGB").save(content, format="webp", lossless=True, method=2, quality=30)
    return content.getvalue()


def kept_images(arrays: Mapping[str, np.ndarray]) -> np.ndarray | None:
    """The image that a cell kept, or None."""
    image = arrays.get("image")
    return image if image is not None and image.ndim == 3 and image.shape[2] == 4 else None
