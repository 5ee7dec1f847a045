"""The pixels of multisampled scenes that fragments of one depth leave open.

Two triangles that share an edge have fragments of one depth there, in one pixel and not in one sample. So the rule of
docs/scenes.md, "Equal depths", holds for samples.
"""

from __future__ import annotations

import numpy as np

from ..effects import Settings
from ..effects.coverage import samples_of, straight_of
from .composite import Fragments, taken


def open_pixels(fragments: Fragments, settings: Settings, layers: int | None = None,
                criterion: str = "nearest") -> np.ndarray:
    """bool (H, W): pixels in which fragments of one depth leave the image open, of all or of the best `layers`.

    They do where their colours differ and they meet: in a sample, or in the pixel where samples are not told apart. And
    where some of them are among the best and others are not.
    """
    runs = _Runs.of(fragments)
    found = np.zeros(fragments.counts.size, dtype=bool)
    if not len(runs.starts):
        return found.reshape(fragments.counts.shape)
    every = fragments.payloads()
    payloads = every[runs.where]
    recoloured = runs.differ(straight_of(payloads))
    meeting = runs.meet(samples_of(payloads, settings.msaa)) | (settings.coverage != "samples")
    unlike = recoloured & meeting
    if layers is not None:
        among = taken(fragments.counts.ravel(), every[:, 3], layers, criterion)[runs.where]
        matters = recoloured if settings.coverage == "ignored" else runs.differ(payloads)
        unlike |= runs.differ(among[:, None]) & matters
    found[runs.pixel[unlike]] = True
    return found.reshape(fragments.counts.shape)


class _Runs:
    """Runs of two or more fragments that share their pixel and their depth.

    where: int64 (m,), the places of their fragments. starts: int64 (runs,), the first of each among them. pixel: int64
    (runs,).
    """

    def __init__(self, where: np.ndarray, starts: np.ndarray, pixel: np.ndarray):
        self.where, self.starts, self.pixel = where, starts, pixel

    @classmethod
    def of(cls, fragments: Fragments) -> _Runs:
        """The runs of all fragments."""
        pixel, depth = fragments.of_pixels(), fragments.depth
        as_before = np.zeros(len(depth) + 1, dtype=bool)
        as_before[1:-1] = (pixel[1:] == pixel[:-1]) & (depth[1:] == depth[:-1])
        where = np.flatnonzero(as_before[:-1] | as_before[1:])
        starts = np.flatnonzero(~as_before[where])
        return cls(where, starts, pixel[where[starts]])

    def differ(self, values: np.ndarray) -> np.ndarray:
        """bool (runs,): whether any of the values (m, channels) of a run's fragments differs from another's."""
        values = values.astype(np.float64)
        return (np.maximum.reduceat(values, self.starts) > np.minimum.reduceat(values, self.starts)).any(axis=-1)

    def meet(self, samples: np.ndarray) -> np.ndarray:
        """bool (runs,): whether any sample, of bool (m, samples), is covered by two fragments of a run."""
        return (np.add.reduceat(samples.astype(np.int64), self.starts) > 1).any(axis=-1)
