"""Measures how far an image is from the float64 oracle. Images are (H, W, 4), premultiplied over transparent black."""

from __future__ import annotations

import math

import numpy as np

from .flip import OnScreen
from .ties import Answer

WRONG_PIXEL = 1 / 512  # a channel error above half a step of 8 bits shows


def conformance(image: np.ndarray, promised: Answer, given: Answer | None = None) -> dict[str, float | int]:
    """Errors against what the method promises.

    max_abs_error: of any channel, colours in [0, 1]. wrong_pixels: pixels with a channel error above 1/512. Both allow
    what is `given` by a method that loses equal depths, where these are few enough to meet by chance. In any case
    tied_pixels counts these pixels, tied_error is the error of the worst, and order_error is how far one is from the
    order of submission.
    """
    tied = promised.tied
    error = pixel_errors(image, promised)
    allowed = given if given and given.tied_by_chance else promised
    worst, wrong = _worst(error if allowed is promised else pixel_errors(image, allowed))
    return {"max_abs_error": worst, "wrong_pixels": wrong, "tied_pixels": int(np.count_nonzero(tied)),
            "tied_error": float(error[tied].max(initial=0.0)),
            "order_error": float(_error(image[tied], promised.image[tied]).max(initial=0.0))}


def pixel_errors(image: np.ndarray, promised: Answer) -> np.ndarray:
    """float64 (H, W): how far the worst channel of each pixel is from the values that are right."""
    _require_same_shape(image, promised.image)
    return _error(image, promised.nearest(image)).max(axis=-1)


def quality(image: np.ndarray, full: np.ndarray, with_flip: bool = True,
            orders: Answer | None = None) -> dict[str, float | int | None]:
    """Errors against the image of all fragments.

    rmse: over all channels. psnr_db: infinite where the images are equal. flip: mean of NVIDIA's FLIP of the displayed
    8-bit images, over black or over white, whichever is worse; None without it, since it takes longer than all else.
    max_error_all, wrong_pixels_all: as `conformance` has them against the promise, but no fragment may be lost. Where
    fragments share a depth all of these are against the nearest of `orders`, the images of all fragments in any order
    of equal depths.
    """
    _require_same_shape(image, full)
    right = orders.nearest(image) if orders else full
    error = _error(image, right)
    rmse = math.sqrt(float(np.mean(error ** 2)))
    worst, wrong = _worst(error.max(axis=-1))
    return {"rmse": rmse, "psnr_db": -20 * math.log10(rmse) if rmse > 0 else math.inf,
            "flip": OnScreen.of(image, right).flip() if with_flip else None,
            "max_error_all": worst, "wrong_pixels_all": wrong}


def _worst(error: np.ndarray) -> tuple[float, int]:
    """The largest error of a pixel, and the number of wrong pixels."""
    return float(error.max()), int(np.count_nonzero(error > WRONG_PIXEL))


def _error(image: np.ndarray, oracle: np.ndarray) -> np.ndarray:
    """Absolute errors in float64; a value that is not finite counts as an error of 1."""
    error = np.abs(image.astype(np.float64) - oracle)
    error[~np.isfinite(error)] = 1.0
    return error


def _require_same_shape(image: np.ndarray, oracle: np.ndarray) -> None:
    if image.shape != oracle.shape:
        raise ValueError(f"image {image.shape} against oracle {oracle.shape}")
