"""A transparent image over a checkerboard, as people are used to see one."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import numpy as np


def over_checkerboard(image: np.ndarray, side_pixels: int, greys: tuple[float, float]) -> np.ndarray:
    """float (H, W, 3) from 0 to 1: the image over squares of two greys, the first one in the corner of pixel 0.

    image: (H, W, 4), premultiplied, from 0 to 1. side_pixels: of a square.
    """
    import numpy as np

    rows, columns = np.indices(image.shape[:2]) // side_pixels
    behind = np.array(greys)[(rows + columns) % 2][..., None]
    return np.clip(image[..., :3] + (1 - image[..., 3:]) * behind, 0, 1)
