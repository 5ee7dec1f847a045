"""One scene on the device, with what images of it are compared with, for all cells that share it."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from functools import cached_property

import numpy as np

from ..gpu.capture import captured
from ..gpu.scene_buffer import SceneBuffer
from ..gpu.targets import Canvas
from ..gpu.truth import true_stats
from ..methods.spec import Fitted, Promise, SceneStats, Variant
from ..scene import Scene
from ..scene.geometry import Geometry
from ..scene.quads import Quads
from .answers import ALL, Compare, Compared, Edges, Keep, Packed, Prepare, Subject, Ties
from .aside import Aside, Pending
from .bench import Bench
from .shared import Array

FRAGMENT_BYTES = 9  # depth, primitive and mask
BESIDE_BYTES = 256 * 2**20  # of fragments that a device made, above which no second process has a copy


class SceneWork:
    """A scene's frames, statistics and device buffers. Its images are compared by the `aside` of the bench.

    Images are of the frame that is on the device: of an animation the first and the last are compared.
    """

    def __init__(self, bench: Bench, config: Scene):
        self.config, self._bench, self._device = config, bench, bench.device
        with bench.split.work("scene"):
            self.scenes, stats = bench.ahead.made(config)
        with bench.split.work("upload"):
            self.show(0)
        with bench.split.work("scene"):
            self._stats = {id(self.show(i)): known or true_stats(self._device, self.scene_buffer, self.canvas)
                           for i, known in enumerate(stats)}
            self.stats = _largest(list(self._stats.values()))
        self._subjects: dict[int, Subject] = {}

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
    def animated(self) -> bool:
        """Whether there are frames that show other scenes than the first."""
        return len(self.scenes) > 1

    @property
    def frame(self) -> int:
        """The number of the frame that is on the device."""
        return next(i for i, scene in enumerate(self.scenes) if scene is self.scene_buffer.scene)

    @property
    def shown(self) -> SceneStats:
        """The statistics of the scene on the device now."""
        return self._stats[id(self.scene_buffer.scene)]

    @property
    def first(self) -> SceneStats:
        """The statistics of the first frame."""
        return self._stats[id(self.scenes[0])]

    def show(self, frame: int) -> Geometry:
        """Bring the scene of an animation's frame to the device."""
        scene = self.scenes[frame % len(self.scenes)]
        if scene is not self.scene_buffer.scene:
            self.scene_buffer.replace(scene)
        return scene

    # --- images ----------------------------------------------------------------------------------

    @cached_property
    def _aside(self) -> Aside:
        """The process that compares the images of this scene."""
        return self._bench.here if self._made_bytes > BESIDE_BYTES else self._bench.aside_for(self.config)

    @property
    def _made_bytes(self) -> int:
        """Memory of the fragments that a device has to make for the oracle: none of flat quads."""
        return 0 if isinstance(self.scenes[0], Quads) else FRAGMENT_BYTES * self.stats.F

    @property
    def _subject(self) -> Subject:
        """The frame on the device, with the fragments that the device makes of it: it is asked once."""
        frame = self.frame
        if frame not in self._subjects:
            self._subjects[frame] = Subject(self.config, frame, self._captured() if self._made_bytes else None)
        return self._subjects[frame]

    def _captured(self) -> tuple[Array | None, ...]:
        with self._bench.split.work("oracle"):
            found = captured(self._device, self.scene_buffer, self.canvas)
            return tuple(None if each is None else self._aside.share(each) for each in found)

    def prepare(self, variants: Iterable[Variant]) -> None:
        """Begin to make the images that these variants will be compared with, before the first of them is drawn."""
        self.show(0)
        for promise in dict.fromkeys(map(self._promise, variants)):
            self._aside.begin(Prepare(self._subject, promise))

    def compare(self, variant: Variant, image: np.ndarray, quality: bool = False,
                flip: bool = False) -> Pending[Compared]:
        """Begin to compare an image of the frame on the device with what the variant aims at."""
        ties = Ties(variant.method.loses_ties, variant.method.spoils_ties)
        shared = self._aside.share(image)
        return self._aside.begin(Compare(self._subject, self._promise(variant), ties, shared, quality, flip), shared)

    def keep(self, variant: Variant, wanted: tuple[str, ...], image: np.ndarray | None,
             admitted: np.ndarray | None) -> Pending[Packed]:
        """Begin to make and to compress the arrays that a cell keeps."""
        image, admitted = (None if each is None else self._aside.share(each) for each in (image, admitted))
        work = Keep(self._subject, self._promise(variant), wanted, image, admitted)
        return self._aside.begin(work, *filter(None, (image, admitted)))

    def edge_pixels(self) -> Pending[int]:
        """Begin to count the pixels at edges, of a multisampled scene."""
        return self._aside.begin(Edges(self._subject))

    def _promise(self, variant: Variant) -> Promise:
        """The image that the variant aims at; that of all fragments is one, however many layers that takes."""
        promise = Fitted(variant, self.shown).promise()
        if promise.layers is not None and promise.layers >= self.stats.n:
            return replace(ALL, two_channel=promise.two_channel)
        return promise

    def release(self) -> None:
        for name in ("scene_buffer", "canvas"):
            if name in self.__dict__:
                self.__dict__[name].release()
        for array in (array for subject in self._subjects.values() for array in subject.made or ()):
            if array is not None:
                array.release()


def _largest(stats: list[SceneStats]) -> SceneStats:
    """Room for every frame of an animation."""
    biggest = max(stats, key=lambda s: s.F)
    fragments, deepest = map(max, zip(*(s.in_front or (s.F, s.n) for s in stats), strict=True))
    return replace(biggest, n=max(s.n for s in stats), primitives=max(s.primitives for s in stats),
                   in_front=(fragments, deepest) if biggest.in_front else None)
