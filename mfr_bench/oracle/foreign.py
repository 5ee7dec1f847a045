"""The float64 models of effects that packages and folders from outside bring: imported and called, whatever they do."""

from __future__ import annotations

import traceback
from pathlib import Path

import numpy as np

from ..effects import Settings
from ..effects.rays import Rays
from ..errors import MfrError
from ..methods.loading import module_of


def image_of(rays: Rays, settings: Settings) -> np.ndarray:
    """float64 (pixels, 4): the image of an effect from outside. Raises MfrError with a line where its model fails."""
    try:
        module = module_of(settings.name, settings.effect.place)
        image = np.asarray(module.model(_read_only(rays), settings), dtype=np.float64)
    except (Exception, SystemExit) as error:  # whatever foreign code raises is one line
        raise MfrError(f"the model of effect {settings.name} fails: {_where(error, settings.name)}"
                       f"{' '.join(f'{type(error).__name__}: {error}'.split())}") from error
    if image.shape != (rays.counts.size, 4):
        raise MfrError(f"the model of effect {settings.name} gives an array of shape {image.shape}; allowed: "
                       f"{(rays.counts.size, 4)}")
    if not np.isfinite(image).all():
        raise MfrError(f"the model of effect {settings.name} gives infinite numbers or none; allowed: finite numbers")
    return image


def _read_only(rays: Rays) -> Rays:
    """The same arrays, which cannot be written to: what checks other methods uses them too."""
    arrays = [array.view() for array in (rays.counts, rays.depth, rays.rgba)]
    for array in arrays:
        array.flags.writeable = False
    return Rays(*arrays)


def _where(error: BaseException, name: str) -> str:
    """File and line of the effect's module where it raised, if that is known."""
    frames = [frame for frame in traceback.extract_tb(error.__traceback__) if Path(frame.filename).stem == name]
    return f"{frames[-1].filename}:{frames[-1].lineno}: " if frames else ""
