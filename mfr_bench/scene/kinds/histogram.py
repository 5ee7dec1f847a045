"""`kind: histogram`: exactly so many pixels of each depth complexity, scattered or in clusters."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated

from annotated_types import Interval

from ..spec.kind import MAX_PRIMITIVES, CommonKeys, Described, Fault, Kind, flat_geometry
from ..spec.values import MAX_SIDE, Allowed

MAX_FRAGMENTS = 2**26  # about 2 GiB for the oracle's lists
UNUSED = ("pixel_density", "mean_depth", "fragment_probability", "animate")

Pixels = Annotated[tuple[Annotated[int, Interval(ge=0, le=MAX_SIDE**2)], ...],
                   Allowed("a list of whole numbers of pixels, by depth complexity from 0")]


@dataclass(frozen=True, kw_only=True)
class HistogramKeys:
    """The keys of histograms.

    pixels: how many pixels have 0, 1, 2, … fragments; all together those of the viewport. cluster: pixels from the
    middle of a hill of depth complexity to the middle of the next; 1: every pixel for itself.
    """

    pixels: Pixels = ()
    cluster: Annotated[int, Interval(ge=1, le=MAX_SIDE), Allowed(f"a whole number from 1 to {MAX_SIDE}")] = 1


def _adds_up(scene: CommonKeys) -> Fault | None:
    viewport, given = math.prod(scene.size), sum(scene.pixels)
    what = f"{given} pixels for a viewport of {viewport}; allowed: numbers that add up to {viewport}"
    return None if given == viewport else (("scene.pixels", "scene.size", "scene.kind"), what)


def _too_many(scene: CommonKeys) -> Fault | None:
    count = fragments(scene)
    what = f"{count} fragments; allowed: at most {MAX_FRAGMENTS}"
    return (("scene.pixels",), what) if count > MAX_FRAGMENTS else None


def fragments(scene: CommonKeys) -> int:
    """All fragments of the histogram."""
    return sum(depth * pixels for depth, pixels in enumerate(scene.pixels))


class Histogram(Kind):
    """Pixels by their depth complexity."""

    name = "histogram"
    noun = "quads"
    Keys = HistogramKeys
    generator = "histogram.histogram"
    measured = True
    unused = UNUSED
    rules = (_adds_up, _too_many)
    rows = (Described("`histogram`", "so many pixels of each depth complexity, scattered or in clusters",
                      "exactly as `pixels` says", "the same", "a scene of which no more is known"),)
    key_words = """\
- `pixels: [p0, p1, …]`: how many pixels have 0, 1, 2, … fragments. They add up to those of the viewport.
- `cluster`: pixels from the middle of a hill of depth complexity to that of the next; 1, the default, gives every pixel
  its depth by itself. Pixels are ranked by a smooth noise of this width and take the depths of the histogram by rank,
  so that it is met exactly whatever the width.
- Each layer is cut into rectangles of whole pixels, a quad each, as high as equal runs of pixels lie above each other.
  Every quad has a depth and a colour of its own.
"""

    def geometry_of(self, scene: CommonKeys) -> str:
        return flat_geometry(scene)

    def primitives(self, scene: CommonKeys) -> int:
        """About: those of a layer of scattered pixels are one for each, clusters have a few in each row."""
        return min(MAX_PRIMITIVES, max(1, fragments(scene) // (2 * scene.cluster - 1)))

    def covered_pixels(self, scene: CommonKeys) -> int:
        return max(1, sum(scene.pixels[1:]))

    def expected_counts(self, scene: CommonKeys) -> list[float]:
        return [0, *scene.pixels[1:]]


KIND = Histogram()
