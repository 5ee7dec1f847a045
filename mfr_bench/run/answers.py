"""The right images of scenes and how images compare with them: all work of the host that no frame waits for.

Each piece of work is a value that pickles and is called with the `Answers` of the process that does it. So it is the
same work in the process beside the device, and in the one that measures where that other is gone.
"""

from __future__ import annotations

import hashlib
import pickle
from collections import OrderedDict
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from ..effects import PLAIN
from ..measure.split import Split
from ..methods.spec import Promise, SceneStats
from ..oracle import quality
from ..oracle.composite import Fragments
from ..oracle.flip import OnScreen, displays
from ..oracle.ties import Answer
from ..oracle.truth import SceneTruth, known_stats
from ..scene import Scene, generate
from ..scene.geometry import Geometry
from ..store.arrays import packed
from .shared import Array

ANIMATION_FRAMES = 8  # that an animated scene cycles through
FRAMES = 3  # whose right images are kept: two of the scene that is measured, the first of the next
MOST_BYTES = 640 * 2**20  # of right images that are kept, beside the newest
ALL = Promise()  # every fragment: the A-buffer's image


@dataclass(frozen=True)
class Ties:
    """What a method loses of equal depths, as its declaration says (`methods.spec.Method`)."""

    loses_ties: bool
    spoils_ties: bool


@dataclass(frozen=True, eq=False)
class Subject:
    """A frame of a scene, which images are of.

    made: the fragments as a device made them (`gpu.capture.captured`); None for flat quads.
    """

    config: Scene
    frame: int = 0
    made: tuple[Array | None, ...] | None = None

    @property
    def key(self) -> tuple:
        """Tells the scene from others; a device may make others of one config."""
        return self.config, self.frame, tuple(each.name for each in self.made or () if each)


class Known:
    """One scene: its right images and the comparisons with them, each made when it is first asked for."""

    def __init__(self, scene: Geometry, fragments: Fragments | None, split: Split):
        self.scene, self.truth, self._split = scene, SceneTruth(scene, fragments), split
        self.answers: OrderedDict[Promise, Answer] = OrderedDict()
        self._compared: dict[tuple[str, bytes], Any] = {}

    def answer(self, promise: Promise) -> Answer:
        """The images that are right of the promised fragments."""
        if promise not in self.answers:
            with self._split.work("oracle"):
                self.answers[promise] = self.truth.answer(promise)
        self.answers.move_to_end(promise)
        return self.answers[promise]

    @cached_property
    def _of_samples(self) -> Answer:
        with self._split.work("oracle"):
            return self.truth.reference()

    @property
    def reference(self) -> Answer:
        """The answer of all fragments, that errors of quality are against."""
        return self.answer(ALL) if self.scene.effect.coverage == PLAIN.coverage else self._of_samples

    @cached_property
    def displays(self) -> tuple[np.ndarray, ...]:
        """What a screen shows of the image of all fragments."""
        return displays(self.reference.image)

    def once(self, what: str, digest: bytes, compare: Callable[[], Any]) -> Any:
        """A comparison of the image with this digest; equal images, as exact methods give them, share it."""
        if (what, digest) not in self._compared:
            self._compared[what, digest] = compare()
        return self._compared[what, digest]


class Answers:
    """The scenes that a process knows. split: counts what it spends on them."""

    def __init__(self, split: Split | None = None):
        self.split = split or Split()
        self._known: OrderedDict[tuple, Known] = OrderedDict()

    def of(self, subject: Subject) -> Known:
        """The scene as it is known; one that is not known is generated anew."""
        if subject.key not in self._known:
            with self.split.work("scene"):
                scene = generate(subject.config, subject.frame)
            self._keep(subject, scene)
        self._known.move_to_end(subject.key)
        self._let_go()
        return self._known[subject.key]

    def made(self, config: Scene) -> tuple[list[Geometry], list[SceneStats | None]]:
        """The frames of a scene with their statistics, None where a device has to count; the first becomes known."""
        with self.split.work("scene"):
            scenes = [generate(config, frame) for frame in range(ANIMATION_FRAMES if config.animate else 1)]
            stats = [known_stats(scene) for scene in scenes]
        if stats[0] is not None:
            self._keep(Subject(config), scenes[0])
        return scenes, stats

    def _keep(self, subject: Subject, scene: Geometry) -> None:
        with self.split.work("oracle"):
            made = [None if each is None else _changeable(each.array()) for each in subject.made or ()]
            fragments = Fragments.of(scene, *made) if made else None
        self._known[subject.key] = Known(scene, fragments, self.split)
        while len(self._known) > FRAMES:
            self._known.popitem(last=False)

    def _let_go(self) -> None:
        """Drop the right images that were not asked for the longest, beyond the bytes that may be kept."""
        every = [(known.answers, promise) for known in self._known.values() for promise in known.answers]
        held = sum(answers[promise].bytes for answers, promise in every)
        for answers, promise in every:
            if held <= MOST_BYTES:
                return
            held -= answers.pop(promise).bytes


def _changeable(array: np.ndarray) -> np.ndarray:
    return array if array.flags.writeable else array.copy()


# --- work ----------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Make:
    """Makes a scene; its frames and their statistics come pickled, to be read when they are wanted."""

    config: Scene

    def __call__(self, answers: Answers) -> bytes:
        return pickle.dumps(answers.made(self.config), pickle.HIGHEST_PROTOCOL)


@dataclass(frozen=True)
class Prepare:
    """Makes a right image before any image is compared with it."""

    subject: Subject
    promise: Promise

    def __call__(self, answers: Answers) -> None:
        answers.of(self.subject).answer(self.promise)


@dataclass(frozen=True)
class Compared:
    """How an image compares: errors against what was promised, and against all fragments if that was asked for.

    untied: a digest of the image without the pixels that equal depths leave open.
    """

    conformance: Mapping[str, float | int]
    quality: Mapping[str, float | int | None]
    untied: bytes


@dataclass(frozen=True)
class Compare:
    """Compares an image, float32 (H, W, 4). quality: against all fragments too; flip: with FLIP."""

    subject: Subject
    promise: Promise
    ties: Ties
    image: Array
    quality: bool = False
    flip: bool = False

    def __call__(self, answers: Answers) -> Compared:
        known, image = answers.of(self.subject), self.image.array()
        promised = known.answer(self.promise)
        with answers.split.work("check"):
            found = quality.conformance(image, promised, promised.given_by(self.ties))
            left = image if promised.unique else np.where(promised.tied[..., None], np.float32(0), image)
            untied = hashlib.sha256(left).digest()
            whole = untied if promised.unique else hashlib.sha256(image).digest()
            return Compared(found, self._quality(known, image, whole, answers.split) if self.quality else {}, untied)

    def _quality(self, known: Known, image: np.ndarray, digest: bytes, split: Split) -> dict[str, float | int | None]:
        full = known.reference
        found = known.once("quality", digest, lambda: quality.quality(image, full.image, with_flip=False, orders=full))
        if not self.flip:
            return found
        with split.work("flip"):
            return found | {"flip": known.once("flip", digest, lambda: _flip(known, image))}


def _flip(known: Known, image: np.ndarray) -> float:
    """FLIP, once for all images that a screen shows alike; where orders are open each is beside the nearest of its own.
    """
    if not known.reference.unique:
        images = OnScreen.of(image, known.reference.nearest(image))
        return 0.0 if images.equal else images.flip()
    images = OnScreen.beside(image, known.displays)
    return 0.0 if images.equal else known.once("shown", images.digest, images.flip)


@dataclass(frozen=True)
class Edges:
    """Counts the pixels of a multisampled scene with a fragment that covers only some of their samples."""

    subject: Subject

    def __call__(self, answers: Answers) -> int:
        known = answers.of(self.subject)
        with answers.split.work("check"):
            return known.truth.edge_pixels


@dataclass(frozen=True)
class Packed:
    """The arrays that a cell keeps, as the contents of its .npz, empty where there are none; discarded: fragments."""

    content: bytes
    discarded: int | None


@dataclass(frozen=True)
class Keep:
    """Makes and compresses the arrays that a cell keeps (`store.columns.ARRAYS`).

    image: the last, float32 (H, W, 4), or None. admitted: uint32 (H, W), the fragments of each pixel that were not
    discarded, or None where the method does not tell.
    """

    subject: Subject
    promise: Promise
    wanted: tuple[str, ...]
    image: Array | None
    admitted: Array | None

    def __call__(self, answers: Answers) -> Packed:
        known = answers.of(self.subject)
        with answers.split.work("check"):
            arrays = self._of_counts(known) | (self._of_image(known) if self.image else {})
        with answers.split.work("compress"):
            discarded = int(arrays["discarded"].sum()) if "discarded" in arrays else None
            return Packed(packed(arrays), discarded)

    def _of_counts(self, known: Known) -> dict[str, np.ndarray]:
        found = {}
        if "fragments" in self.wanted:
            found["fragments"] = known.truth.counts
        if "discarded" in self.wanted and self.admitted:
            found["discarded"] = known.truth.counts - self.admitted.array()
        return found

    def _of_image(self, known: Known) -> dict[str, np.ndarray]:
        image = self.image.array()
        makers = {"image": lambda: np.rint(255 * np.clip(image, 0, 1)),
                  "error": lambda: quality.pixel_errors(image, known.answer(self.promise)),
                  "loss": lambda: quality.pixel_errors(image, known.reference)}
        return {name: make() for name, make in makers.items() if name in self.wanted}
