"""Bases of the geometries: which fragments are generated, and where primitives with corners can be on the screen."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import ClassVar

import numpy as np

from ..effects import PLAIN, Settings
from .overlap import areas_of, bounds_of, boxes_of, depth_bounds_of, most_over

ALIGNED = 8  # pixels: of two words each, a line of a cache
OPAQUE = 255  # the alpha, of 8 bits, of what no light passes


def _outwards(first: int, length: int, end: int) -> tuple[int, int]:
    """The pixels from `first` on, from the multiple of ALIGNED before them to the one after or `end`: first, length."""
    begin = first - first % ALIGNED
    return begin, min(end, first + length + -(first + length) % ALIGNED) - begin


class Primitives:
    """Primitives of which each fragment is generated with a probability: by a hash of pixel, primitive and seed."""

    geometry: ClassVar[str]  # how primitives reach the device: shaders/scene/<geometry>.vert
    rgba: np.ndarray
    fragment_probability: float
    shading: int
    effect: Settings

    @property
    def keep_threshold(self) -> int:
        """A fragment is generated where its hash is below this; 2**32 means always."""
        return min(2**32, round(self.fragment_probability * 2**32))

    @property
    def occluded(self) -> bool:
        """Whether something opaque is drawn first and may hide fragments."""
        return False

    @cached_property
    def opaque_primitives(self) -> int:
        """Primitives that let no light through."""
        return int((self.rgba[:, 3] == OPAQUE).sum())


@dataclass(frozen=True)
class Cornered(Primitives):
    """Primitives in submission order, given by corners in clip space, each with one colour.

    position: float32 (n, corners, 4), x y z w. rgba: uint8 (n, 4), straight alpha. seed decides which fragments are
    rejected. shading: steps of each fragment that is shaded. effect: what is done with the fragments of a pixel.
    """

    triangles_each: ClassVar[int]  # that a primitive is drawn as
    least: ClassVar[int] = 0  # no pixel draws its number of fragments

    viewport: tuple[int, int]
    position: np.ndarray
    rgba: np.ndarray
    fragment_probability: float
    seed: int
    shading: int = field(default=0, kw_only=True)
    effect: Settings = field(default=PLAIN, kw_only=True)

    def __len__(self) -> int:
        return len(self.position)

    @property
    def rejects(self) -> bool:
        """Whether some fragments of the primitives are not generated."""
        return self.keep_threshold < 2**32 or self.occluded

    @cached_property
    def boxes(self) -> np.ndarray:
        """int32 (n, 4): the pixels of the viewport that bound each primitive, x0 y0 x1 y1, half-open (`boxes_of`)."""
        return boxes_of(self.position, self.viewport)

    @cached_property
    def bounds(self) -> tuple[int, int, int, int]:
        """Left, bottom, width and height in pixels of a rectangle that bounds the primitives in the viewport.

        It begins and ends at multiples of ALIGNED or the viewport's edge: adjacent pixels then share lines of a cache.
        """
        left, bottom, width, height = bounds_of(self.boxes)
        (left, width), (bottom, height) = (
            _outwards(first, length, end) for first, length, end in zip((left, bottom), (width, height), self.viewport,
                                                                        strict=True))
        return left, bottom, width, height

    @cached_property
    def depth_bounds(self) -> tuple[float, float]:
        """Window depths between which the primitives lie."""
        return depth_bounds_of(self.position)

    @cached_property
    def layers(self) -> int:
        """Most fragments that a pixel can have, by the boxes alone: one of each triangle."""
        return self.triangles_each * most_over(self.boxes, self.viewport)

    @cached_property
    def expected(self) -> int:
        """Fragments to expect of a frame: the areas of all primitives in pixels."""
        return round(float(areas_of(self.position, self.boxes, self.viewport).sum()))

    @property
    def reach(self) -> None:
        """Most fragments of a frame: no closer bound than each layer in each pixel is known."""
        return None
