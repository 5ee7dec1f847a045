"""Asks a scene's oracle, before anything is measured, how many of the nearest layers keep an error."""

from __future__ import annotations

import math
import time

import numpy as np

from ..oracle.composite import composite, stats_of
from ..scene.quads import Quads


def enough_layers(scene: Quads, max_error: float, until: float = math.inf) -> int:
    """The least number of nearest fragments per pixel whose image is within `max_error` of that of all fragments.

    until: a time of the monotonic clock; a look that would end later is not taken, and the least number known to be
    enough is the answer.

    The scene is one of flat quads, whose oracle needs no device. The error falls with the number, since what is left
    out lies behind what is kept; so it is found by halving.
    """
    begun = time.monotonic()
    everything, low, high = composite(scene), 1, stats_of(scene).n
    look_s = time.monotonic() - begun
    while low < high and time.monotonic() + look_s <= until:
        middle = (low + high) // 2
        if float(np.abs(composite(scene, middle) - everything).max()) <= max_error:
            high = middle
        else:
            low = middle + 1
    return high
