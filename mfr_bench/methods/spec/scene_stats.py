"""Facts of a scene that formulas, plans and conditions of passes see."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

from ...effects import PLAIN, Settings


@dataclass(frozen=True)
class SceneStats:
    """The statistics of a scene that a frame needs. Counts are of fragments unless said otherwise."""

    W: int  # viewport width, pixels
    H: int  # viewport height, pixels
    n: int  # most fragments in any pixel, at least 1
    F: int  # fragments of the frame
    primitives: int  # submitted
    rejects: bool = False  # some fragments are not generated (f_p < 1, or pixels that draw their number)
    histogram: tuple[int, ...] = ()  # histogram[i] = pixels with i fragments
    geometry: str = "quad"  # how primitives reach the device: shaders/scene/<geometry>.vert
    area: int | None = None  # pixels of the rectangle that bounds the geometry; None: of the viewport
    layers: int | None = None  # most fragments that a pixel can have by the geometry; None: those of every primitive
    reach: int | None = None  # most fragments that the geometry can have; None: every layer in every pixel
    occluded: bool = False  # opaque triangles in a depth buffer of their own may hide fragments
    shading: int = 0  # arithmetic steps of each fragment that is shaded
    effect: Settings = PLAIN  # what is done with the fragments of a pixel
    opaque_primitives: int = 0  # that let no light through
    expected: int = 0  # fragments to expect of the geometry, by its areas
    in_front: tuple[int, int] | None = None  # F and n without what opaque primitives, drawn first, hide; None: F and n
    least: int = 0  # fewest fragments that a pixel draws of those of all primitives; 0: every pixel has all

    @property
    def P(self) -> int:
        """Pixels of the viewport."""
        return self.W * self.H

    @property
    def flat(self) -> bool:
        """Whether each primitive has one depth, and meets no pixel but at its edges."""
        return self.geometry in ("quad", "masked")

    @property
    def draws_in_parts(self) -> bool:
        """Whether opaque primitives can be drawn without the others, and no fragment of either is rejected."""
        return not (self.flat or self.rejects) and 0 < self.opaque_primitives < self.primitives and self.one_sample

    @property
    def samples(self) -> int:
        """Samples of a pixel that the geometry is rasterized into."""
        return 1 if self.geometry == "masked" else self.effect.msaa

    @property
    def one_sample(self) -> bool:
        """Whether the geometry is rasterized into one sample a pixel."""
        return self.samples == 1

    @property
    def unmasked(self) -> bool:
        """Whether fragments cover whole pixels, and have no masks."""
        return self.effect.msaa == 1

    @property
    def forward(self) -> bool:
        """Whether window depths grow from the eye."""
        return self.geometry != "reversed"

    @property
    def blended(self) -> bool:
        """Whether the fragments of a pixel of one sample are blended, and nothing else is done with them."""
        return self.effect.blended

    @property
    def lengthless(self) -> bool:
        """Whether no effect takes differences of depth as lengths."""
        return not self.effect.effect.measures

    @property
    def most_layers(self) -> int:
        """Most fragments that a pixel can have by the geometry alone: a strip of two triangles may cover it twice."""
        return self.layers if self.layers is not None else self.primitives * (2 if self.geometry == "strip" else 1)

    def bounded(self, k: int) -> int:
        """Fragments left when each pixel keeps at most `k`: the sum of min(f, k) over the pixels."""
        return sum(min(f, k) * pixels for f, pixels in self._filled)

    def paged(self, page: int) -> int:
        """Cells in the pages of `page` cells that the fragments fill when no two pixels share one."""
        return sum(math.ceil(f / page) * page * pixels for f, pixels in self._filled)

    @cached_property
    def _filled(self) -> tuple[tuple[int, int], ...]:
        """The numbers of fragments that some pixels have, each with how many do."""
        return tuple((f, pixels) for f, pixels in enumerate(self.histogram) if pixels)

    @cached_property
    def names(self) -> Mapping[str, float]:
        """The counts by the names that formulas have for them."""
        return {"W": self.W, "H": self.H, "P": self.P, "n": self.n, "F": self.F, "f": self.F / self.P}


# Facts of SceneStats that a parameter may ask of a scene, in words.
SCENE_FACTS: Mapping[str, str] = {
    "flat": "flat primitives that meet no pixel but at its edges",
    "blended": "the effect transparency and one sample a pixel, since its image is not made of the fragments one by "
               "one, nearest first",
    "one_sample": "one sample a pixel, since a pass over the geometry draws into targets of one",
    "unmasked": "one sample a pixel, since it keeps one of the fragments of one depth, which two sides of an edge have",
    "lengthless": "an effect that measures no lengths, since the keys that are stored are no depths",
    "forward": "depths that grow from the eye, since a pass tests against a depth buffer",
}
