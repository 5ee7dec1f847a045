"""Two-channel colour of a picture (gpupro5_ch2 §2.4, Figs. 2.4 to 2.6), and the errors that it makes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from . import quality, twochannel
from .twochannel import Encoding

BASES_BYTES = 24  # of two colours in 32-bit floats


@dataclass(frozen=True)
class Encoded:
    """A picture and its decoded form: uint8 (H, W, 3), row 0 at the top, both.

    clipped: share of the pixels that come back brighter than a screen shows.
    """

    original: np.ndarray
    decoded: np.ndarray
    encoding: Encoding
    clipped: float

    @classmethod
    def of(cls, picture: np.ndarray) -> Encoded:
        """The plane is fitted to all texels of the picture (§2.2.1); two bytes of each are kept."""
        flat = picture.reshape(-1, 3)
        encoding = Encoding.fit(flat)
        back = encoding.decode(encoding.encode(flat))
        clipped = float((back > 1 + 0.5 / 255).any(axis=-1).mean())
        shown = np.rint(255 * np.clip(back, 0, 1)).astype(np.uint8)
        return cls(picture, shown.reshape(picture.shape), encoding, clipped)

    def record(self) -> dict[str, Any]:
        """Base colours, errors and bytes.

        base_colours: of 8 bits. luminance_error: mean and largest, of luminances in [0, 1]. hue_error: mean angle
        between the light of a texel before and after, degrees. psnr_db and flip: of the pictures of 8 bits.
        """
        before, after = (twochannel.light(image.reshape(-1, 3)) for image in (self.original, self.decoded))
        luminance = np.abs((after - before) @ twochannel.LUMINANCE)
        full, image = (_opaque(each) for each in (self.original, self.decoded))
        compared = quality.quality(image, full)
        pixels = self.original.shape[0] * self.original.shape[1]
        return {"base_colours": [np.rint(255 * np.sqrt(base)).astype(int).tolist()
                                 for base in (self.encoding.a, self.encoding.b)],
                "luminance_error_mean": float(luminance.mean()), "luminance_error_max": float(luminance.max()),
                "hue_error_degrees": twochannel.angle(before, after), "clipped": self.clipped,
                "psnr_db": compared["psnr_db"], "flip": compared["flip"],
                "bytes_before": 3 * pixels, "bytes_after": 2 * pixels + BASES_BYTES}

    def side_by_side(self) -> np.ndarray:
        """uint8 (H, 2·W + gap, 3): the original on the left, what comes back on the right."""
        gap = np.full((self.original.shape[0], 8, 3), 255, np.uint8)
        return np.hstack([self.original, gap, self.decoded])


def _opaque(picture: np.ndarray) -> np.ndarray:
    """float64 (H, W, 4): the picture with an alpha of 1."""
    return np.concatenate([picture / 255.0, np.ones((*picture.shape[:2], 1))], axis=-1)
