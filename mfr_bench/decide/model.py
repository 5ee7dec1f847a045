"""Asks a scene's oracle, before anything is measured, how many of the nearest layers keep an error."""

from __future__ import annotations

import numpy as np

from ..oracle.composite import composite, stats_of
from ..scene.quads import Quads


def enough_layers(scene: Quads, max_error: float) -> int:
    """The least number of nearest fragments per pixel whose image is within `max_error` of that of all fragments.

    The scene is one of flat quads, whose oracle needs no device. The error falls with the number, since what is left
    out lies behind what is kept; so it is found by halving.
    """
    everything, low, high = composite(scene), 1, stats_of(scene).n
    while low < high:
        middle = (low + high) // 2
        if float(np.abs(composite(scene, middle) - everything).max()) <= max_error:
            high = middle
        else:
            low = middle + 1
    return low
