"""One scene on the device, with its oracle images, for all cells that share it."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from dataclasses import replace
from functools import cached_property
from typing import Any

import numpy as np

from ..effects import PLAIN
from ..gpu.context import Device
from ..gpu.scene_buffer import SceneBuffer
from ..gpu.targets import Canvas
from ..gpu.truth import Truth, true_stats
from ..measure.split import Split
from ..methods.spec import Fitted, Promise, SceneStats, Variant
from ..oracle import quality
from ..oracle.flip import OnScreen
from ..oracle.ties import Answer
from ..scene import generate
from ..scene.geometry import Geometry
from .aside import Aside

ANIMATION_FRAMES = 8  # that an animated scene cycles through
ALL = Promise()  # every fragment: the A-buffer's image


class SceneWork:
    """A scene's frames, statistics, device buffers and oracle images, each made when it is first needed."""

    def __init__(self, device: Device, config, split: Split):
        self.split = split
        self._device, self._answers, self._compared, self._truths = device, {}, {}, {}
        self._references: dict[int, np.ndarray] = {}
        with split.work("scene"):
            frames = ANIMATION_FRAMES if config.animate else 1
            self.scenes = [generate(config, frame) for frame in range(frames)]
            self._stats = {id(self.show(i)): true_stats(device, self.scene_buffer, self.canvas) for i in range(frames)}
            self.stats = _largest(list(self._stats.values()))

    @cached_property
    def scene_buffer(self) -> SceneBuffer:
        return SceneBuffer(self._device, self.scenes[0])

    @cached_property
    def canvas(self) -> Canvas:
        return Canvas(self._device, self.scenes[0].viewport)

    @property
    def frames(self) -> list[SceneStats]:
        """The statistics of every frame of an animation."""
        return list(self._stats.values())

    @property
    def shown(self) -> SceneStats:
        """The statistics of the scene on the device now."""
        return self._stats[id(self.scene_buffer.scene)]

    def show(self, frame: int) -> Geometry:
        """Bring the scene of an animation's frame to the device."""
        scene = self.scenes[frame % len(self.scenes)]
        if scene is not self.scene_buffer.scene:
            self.scene_buffer.replace(scene)
        return scene

    @property
    def truth(self) -> Truth:
        """The oracle of the scene on the device now."""
        scene = self.scene_buffer.scene
        return self._truths.setdefault(id(scene), Truth(self._device, self.scene_buffer, self.canvas))

    def conformance(self, variant: Variant, image: np.ndarray) -> dict[str, float | int]:
        """Errors of an image of the scene on the device against what the variant aims at."""
        promised = self.promised(variant)
        return quality.conformance(image, promised, promised.given_by(variant.method))

    def promised(self, variant: Variant) -> Answer:
        """The images that are right of what the variant aims at in the scene on the device now."""
        return self.answer(Fitted(variant, self.shown).promise())

    def answer(self, promise: Promise) -> Answer:
        """The images that are right of the promised fragments of the scene on the device now; computed once."""
        if promise.layers is not None and promise.layers >= self.stats.n:
            promise = replace(ALL, two_channel=promise.two_channel)
        which = id(self.scene_buffer.scene), promise
        if which not in self._answers:
            with self.split.work("oracle"):
                self._answers[which] = self.truth.answer(promise)
        return self._answers[which]

    def untied(self, variant: Variant, image: np.ndarray) -> np.ndarray:
        """The image without the pixels that equal depths leave open."""
        answer = self.promised(variant)
        return image if answer.unique else np.where(answer.tied[..., None], np.float32(0), image)

    def quality(self, image: np.ndarray) -> dict[str, float | None]:
        """Errors against all fragments, but FLIP; equal images, as exact methods give them, are compared once."""
        return self._once("quality", image, lambda full: quality.quality(image, full, with_flip=False))

    def flip(self, image: np.ndarray, aside: Aside) -> Callable[[], float]:
        """Begin to take FLIP against all fragments; the function that is returned waits for it."""
        return self._once("flip", image, lambda full: _flip_aside(OnScreen.of(image, full), aside))

    def _once(self, what: str, image: np.ndarray, compared: Callable[[np.ndarray], Any]) -> Any:
        """The comparison of an image with that of all fragments, which equal images share."""
        which = what, id(self.scene_buffer.scene), hashlib.sha256(image).digest()
        if which not in self._compared:
            self._compared[which] = compared(self.reference)
        return self._compared[which]

    @property
    def reference(self) -> np.ndarray:
        """The image of all fragments of the scene on the device now, that errors of quality are against."""
        if self.scene_buffer.scene.effect.coverage == PLAIN.coverage:
            return self.answer(ALL).image
        which = id(self.scene_buffer.scene)
        if which not in self._references:
            with self.split.work("oracle"):
                self._references[which] = self.truth.reference()
        return self._references[which]

    def release(self) -> None:
        for name in ("scene_buffer", "canvas"):
            if name in self.__dict__:
                self.__dict__[name].release()


def _flip_aside(images: OnScreen, aside: Aside) -> Callable[[], float]:
    """What waits for FLIP; images that a screen shows alike need no other process."""
    return (lambda: 0.0) if images.equal else aside.begin(images.flip)


def _largest(stats: list[SceneStats]) -> SceneStats:
    """Room for every frame of an animation."""
    biggest = max(stats, key=lambda s: s.F)
    return replace(biggest, n=max(s.n for s in stats), primitives=max(s.primitives for s in stats))
