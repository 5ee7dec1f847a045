"""The right images of one scene, of whichever kind, and its statistics as far as no device has to be asked."""

from __future__ import annotations

from dataclasses import replace
from functools import cached_property

import numpy as np

from ..effects import PLAIN
from ..effects.coverage import samples_of
from ..methods.spec import Promise, SceneStats
from ..scene.geometry import Geometry
from ..scene.pieces import Pieces
from ..scene.quads import Quads
from . import twochannel
from .composite import Fragments, fragment_counts, scene_stats, stats_of
from .effects import answer_of_effect
from .listed import counts_of, listed
from .ties import Answer, answer_of_fragments, answer_of_quads


def known_stats(scene: Geometry) -> SceneStats | None:
    """The statistics of flat quads; None of a scene whose fragments a device has to count."""
    if isinstance(scene, Pieces):
        return scene_stats(scene, counts_of(scene))
    return stats_of(scene) if isinstance(scene, Quads) else None


class SceneTruth:
    """The images of one scene in float64. made: its fragments as a device made them, unless they are flat quads."""

    def __init__(self, scene: Geometry, made: Fragments | None = None):
        self.scene, self._made = scene, made

    @cached_property
    def _fragments(self) -> Fragments | None:
        """The fragments of the scene; None for flat quads that are composited by patches."""
        if isinstance(self.scene, Pieces):
            return listed(self.scene)
        return None if isinstance(self.scene, Quads) else self._of_device()

    def _of_device(self) -> Fragments:
        if self._made is None:
            raise ValueError("the fragments of this scene are what a device makes of it")
        return self._made

    @property
    def counts(self) -> np.ndarray:
        """int64 (H, W): the fragments of each pixel."""
        return self._fragments.counts if self._fragments else fragment_counts(self.scene)

    def answer(self, promise: Promise) -> Answer:
        """The images that are right, of the promised fragments."""
        if not self.scene.effect.blended:
            return answer_of_effect(self._fragments or listed(self.scene), self.scene.effect, promise.layers,
                                    promise.criterion)
        payload = twochannel.straight(self.scene.rgba) if promise.two_channel else None
        if self._fragments:
            return answer_of_fragments(self._fragments, promise.layers, promise.criterion, payload)
        return answer_of_quads(self.scene, promise.layers, promise.criterion, payload)

    def reference(self) -> Answer:
        """The answer that errors of quality are against: all fragments.

        Of a multisampled scene it is that of its samples, whatever else is made of coverage.
        """
        effect = self.scene.effect
        if effect.msaa == 1:
            return self.answer(Promise())
        fragments = self._fragments or listed(self.scene)
        return answer_of_effect(fragments, replace(effect, coverage=PLAIN.coverage))

    @cached_property
    def edge_pixels(self) -> int:
        """Pixels of a multisampled scene with a fragment that covers only some of their samples."""
        samples = self.scene.effect.msaa
        fragments = self._fragments or listed(self.scene)
        partly = ~samples_of(fragments.payloads(), samples).all(axis=1)
        return len(np.unique(fragments.of_pixels()[partly]))

    def image(self, promise: Promise) -> np.ndarray:
        """float64 (H, W, 4), premultiplied: the promised fragments, those of one depth in order of submission."""
        return self.answer(promise).image
