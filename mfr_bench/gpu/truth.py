"""The oracle of the scene on the device, of whichever kind; the images of methods are checked against it."""

from __future__ import annotations

from dataclasses import replace
from functools import cached_property

import numpy as np

from ..effects import PLAIN
from ..effects.coverage import samples_of
from ..methods.spec import Promise, SceneStats
from ..oracle import twochannel
from ..oracle.composite import Fragments, fragment_counts, scene_stats, stats_of
from ..oracle.effects import answer_of_effect
from ..oracle.listed import counts_of, listed
from ..oracle.ties import Answer, answer_of_fragments, answer_of_quads
from ..scene.pieces import Pieces
from ..scene.quads import Quads
from .capture import capture, count
from .context import Device
from .scene_buffer import SceneBuffer
from .targets import Canvas


def true_stats(device: Device, scene_buffer: SceneBuffer, canvas: Canvas) -> SceneStats:
    """The statistics of the scene on the device: of flat quads by the oracle, else as the device counts."""
    scene = scene_buffer.scene
    if isinstance(scene, Pieces):
        return scene_stats(scene, counts_of(scene))
    return stats_of(scene) if isinstance(scene, Quads) else scene_stats(scene, count(device, scene_buffer, canvas))


class Truth:
    """The images of one scene in float64. It must be the scene on the device when they are first asked for."""

    def __init__(self, device: Device, scene_buffer: SceneBuffer, canvas: Canvas):
        self._device, self._quads, self._canvas, self.scene = device, scene_buffer, canvas, scene_buffer.scene

    @cached_property
    def _fragments(self) -> Fragments | None:
        """None for flat quads that are composited by patches."""
        if isinstance(self.scene, Pieces):
            return listed(self.scene)
        if isinstance(self.scene, Quads):
            return None
        if self._quads.scene is not self.scene:
            raise ValueError("another scene is on the device")
        return capture(self._device, self._quads, self._canvas)

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

    def reference(self) -> np.ndarray:
        """float64 (H, W, 4): the image that errors of quality are against, of all fragments.

        Of a multisampled scene it is that of its samples, whatever else is made of coverage.
        """
        effect = self.scene.effect
        if effect.msaa == 1:
            return self.answer(Promise()).image
        fragments = self._fragments or listed(self.scene)
        return answer_of_effect(fragments, replace(effect, coverage=PLAIN.coverage)).image

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
