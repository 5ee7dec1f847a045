"""Places primitives: the block in the middle, and how unevenly layers cover it.

Only additions, multiplications, divisions and square roots, which every machine rounds alike.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import TypeVar

Number = TypeVar("Number")  # a float, or a float64 array

MOST_POWER = 60  # of a spread


@lru_cache(maxsize=256)
def block(size: tuple[int, int], density: float) -> tuple[int, int]:
    """Width and height of the block: the viewport's shape, its area nearest to density·W·H.

    Where several shapes are as near, the one closest to the viewport's own aspect ratio.
    """
    (width, height), scale = size, math.sqrt(density)
    target, ideal = density * width * height, width * scale
    shapes = [(w, _rest(target, w, height)) for w in _about(ideal, width)]
    shapes += [(_rest(target, h, width), h) for h in _about(height * scale, height)]
    return min(shapes, key=lambda s: (abs(s[0] * s[1] - target), abs(s[0] - ideal)))


def _about(ideal: float, most: int) -> range:
    """Lengths within a tenth of the ideal one."""
    return range(max(1, int(ideal * 0.9)), min(most, int(ideal * 1.1) + 1) + 1)


def _rest(area: float, side: int, most: int) -> int:
    """The other side that brings a rectangle nearest to the area."""
    return min(max(round(area / side), 1), most)


@dataclass(frozen=True)
class Spread:
    """Numbers in [0, 1] of a given mean, from numbers spread evenly there: a blend of two whole powers."""

    power: int
    blend: float

    def __call__(self, even: Number) -> Number:
        low = 1.0
        for _ in range(self.power):
            low = low * even
        return low * (1 - self.blend) + low * even * self.blend


def spread(mean: float) -> Spread:
    """The spread of a mean in [0, 1]; x**p has the mean 1 / (p + 1). Means below 1 / 61 become that."""
    exponent = min(MOST_POWER, max(0.0, 1 / max(mean, 1e-9) - 1))
    power = int(exponent)
    return Spread(power, (1 / (power + 1) - 1 / (exponent + 1)) * (power + 1) * (power + 2))


def shares(layers: int, mean: float) -> list[float]:
    """Share of the covered pixels that each layer covers, from 1 downwards; they add up to `mean`, at most `layers`."""
    if layers < 2:
        return [1.0] * layers
    rest = min(1.0, (mean - 1) / (layers - 1))
    raw = [spread(rest)((layers - i - 0.5) / (layers - 1)) for i in range(1, layers)]
    scale = rest * (layers - 1) / sum(raw)
    return [1.0, *(min(1.0, share * scale) for share in raw)]
