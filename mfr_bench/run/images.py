"""The images of a cell: checked against what its method promises, counted where they differ, stored where asked for."""

from __future__ import annotations

import hashlib

import numpy as np

from ..gpu.frame import Frame
from ..gpu.work import admitted_map
from ..methods.spec import Variant
from ..oracle import quality
from ..oracle.ties import Answer
from .bench import Bench, Phases
from .jobs import Job
from .scene_work import SceneWork


class Images:
    """The images of one cell; `conformance` and `lost` are the worst of all that were checked.

    quality: errors of the first image against all fragments, but FLIP. Both are empty for a method that promises no
    image. lost: fragments that were dropped in a frame.
    """

    def __init__(self, bench: Bench, phases: Phases, scene: SceneWork, job: Job, variant: Variant, frame: Frame):
        self._bench, self._phases, self._scene, self._measure = bench, phases, scene, job.cell.measure
        self._method, self._variant, self._frame = job.cell.method, variant, frame
        self.promised = variant.guarantee != "none"
        image = frame.image()
        self.lost = frame.lost_in_a_frame()
        with phases.checking():
            self.conformance = self._conformance(image)
            self.quality = scene.quality(image) if self.promised else {}
            self._flip = scene.flip(image, bench.aside) if self.promised and not self._measure.eliminate else None

    def errors(self) -> dict[str, float | int | None]:
        """`conformance` and `quality` with FLIP, which may have to be waited for."""
        if self._flip is None:
            return self.conformance | self.quality
        with self._phases.checking():
            return self.conformance | self.quality | {"flip": self._flip()}

    def check_again(self) -> None:
        """Draw and check another frame, the last: it must be as right as the first."""
        self._frame.show(self._scene.show(0))
        self._frame.draw()
        self._count_lost()
        self._bench.device.check(f"{self._method}: sampling")
        if self.conformance:
            self._check_against_promise(self._frame.image())

    def distinct(self) -> int | None:
        """Different images of the scene on the device, where more than one frame is asked for and images compare.

        Each of them is checked against the promise. Images that differ in tied pixels alone count as one.
        """
        wanted = self._measure.repeat_images
        if wanted == 1 or not self.conformance:
            return None
        images: set[bytes] = set()
        untied: set[bytes] = set()
        for _ in range(wanted):
            self._bench.stop_if_asked()
            self._frame.draw()
            image = self._frame.image()
            seen = len(images)
            with self._phases.checking():
                images.add(hashlib.sha256(image).digest())
            if len(images) > seen:
                self._check_against_promise(image)
                untied.add(hashlib.sha256(self._scene.untied(self._variant, image)).digest())
        self._count_lost()
        return len(untied)

    def to_keep(self) -> dict[str, np.ndarray]:
        """The arrays that `measure.keep` asks for and the method has, of the last image and the scene on the device."""
        wanted, truth = self._measure.keep, self._scene.truth
        found = {}
        if "fragments" in wanted:
            found["fragments"] = truth.counts
        if "discarded" in wanted and (admitted := admitted_map(self._frame)) is not None:
            found["discarded"] = truth.counts - admitted
        if self.promised and {"image", "error", "loss"}.intersection(wanted):
            image = self._frame.image()
            with self._phases.checking():
                made = {"image": np.rint(255 * np.clip(image, 0, 1)),
                        "error": quality.pixel_errors(image, self._scene.promised(self._variant)),
                        "loss": quality.pixel_errors(image, Answer.only(self._scene.reference))}
            found |= {name: made[name] for name in made if name in wanted}
        return found

    def _conformance(self, image: np.ndarray) -> dict[str, float | int]:
        return self._scene.conformance(self._variant, image) if self.promised else {}

    def _check_against_promise(self, image: np.ndarray) -> None:
        """Check an image against the promise; the worst of all images that are checked counts."""
        with self._phases.checking():
            again = self._conformance(image)
        self.conformance = {name: max(value, again[name]) for name, value in self.conformance.items()}

    def _count_lost(self) -> None:
        self.lost = max(self.lost, self._frame.lost_in_a_frame())
