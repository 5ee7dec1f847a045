"""The mean colour of a texture, which stands for all of it: fragments of a triangle share one colour here."""

from __future__ import annotations

import io
import struct
import zlib
from pathlib import Path

import numpy as np

from ...errors import UsageError

# The errors that Pillow raises over a file that is no image, is damaged or too large; its decoders raise any of them.
NO_PICTURE = (OSError, ValueError, SyntaxError, EOFError, LookupError, TypeError, MemoryError, struct.error, zlib.error,
              OverflowError)
NOTE = "a texture is replaced by its mean colour"


def mean_colour(image: Path | bytes, where: str) -> np.ndarray:
    """float64 (4,): the mean of each stored channel in [0, 1]. Raises UsageError for what is no image."""
    from PIL import Image  # comes with matplotlib

    try:
        with Image.open(io.BytesIO(image) if isinstance(image, bytes) else image) as opened:
            texels = np.asarray(opened.convert("RGBA"), dtype=np.float64)
    except (*NO_PICTURE, Image.DecompressionBombError) as error:
        raise UsageError(f"{where}: the texture cannot be read ({error}); allowed: an image that Pillow reads; "
                         "mend the file, or remove the texture from its material") from None
    return texels.reshape(-1, 4).mean(axis=0) / 255
