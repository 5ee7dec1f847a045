"""The images of a cell: checked against what its method promises, counted where they differ, stored where asked for.

They are compared while other frames are drawn, so that what is found of them is asked for at the end.
"""

from __future__ import annotations

import hashlib

import numpy as np

from ..gpu.frame import Frame
from ..gpu.work import admitted_map
from ..methods.spec import Variant
from .answers import Compared, Packed
from .aside import Pending
from .bench import Bench, Phases
from .events import CHECK
from .jobs import Job
from .scene_work import SceneWork


class Images:
    """The images of one cell. promised: whether the method promises any. lost: fragments that were dropped in a frame.

    The worst of all images that are checked counts.
    """

    def __init__(self, bench: Bench, phases: Phases, scene: SceneWork, job: Job, variant: Variant, frame: Frame):
        self._bench, self._phases, self._scene, self._measure = bench, phases, scene, job.cell.measure
        self._method, self._variant, self._frame = job.cell.method, variant, frame
        self.promised = variant.guarantee != "none"
        self._keeps_image = self.promised and self._measure.keeps_image
        self._compared: list[Pending[Compared]] = []  # the first with the errors against all fragments
        self._packed: Pending[Packed] | None = None
        self._edges: Pending[int] | None = None
        self._several = False  # whether images of one scene were drawn to see whether they differ
        image = self._read()
        self.lost = frame.lost_in_a_frame()
        self.check(image, quality=True, flip=not self._measure.eliminate)

    def _read(self) -> np.ndarray:
        with self._bench.split.work("read-back"):
            return self._frame.image()

    def check(self, image: np.ndarray, **more: bool) -> None:
        """Begin to compare an image of the frame on the device with the promise, if any; more: as of `SceneWork`."""
        if self.promised:
            with self._phases.apart(CHECK):
                self._compared.append(self._scene.compare(self._variant, image, **more))

    # --- the last frames -------------------------------------------------------------------------

    def of_sample(self) -> np.ndarray | None:
        """Read the image of the frame that was just timed; None where another is compared.

        Those of an animation, and one that is to be kept, are drawn at the end.
        """
        if self.promised and not (self._scene.animated or self._keeps_image):
            return self._read()
        return None

    def draw_again(self) -> None:
        """Draw and check another image of the frame on the device."""
        self._frame.draw()
        if self.promised:
            self.check(self._read())

    def draw_several(self) -> None:
        """Draw the scene on the device again where more than one image is asked for and images compare.

        Each that differs from those before is checked against the promise.
        """
        wanted = self._measure.repeat_images
        if wanted == 1 or not self.promised:
            return
        images: set[bytes] = set()
        self._several, self._first_of_several = True, len(self._compared)
        for _ in range(wanted):
            self._bench.stop_if_asked()
            self._frame.draw()
            image = self._read()
            seen = len(images)
            with self._phases.apart(CHECK):
                images.add(hashlib.sha256(image).digest())
            if len(images) > seen:
                self.check(image)
        self.count_lost()

    def keep(self) -> None:
        """Begin to pack the arrays that `measure.keep` asks for and the method has: of the last image and the scene."""
        wanted = self._measure.keep
        admitted = admitted_map(self._frame) if "discarded" in wanted else None
        image = self._read() if self._keeps_image else None
        if "fragments" in wanted or admitted is not None or image is not None:
            with self._phases.apart(CHECK):
                self._packed = self._scene.keep(self._variant, wanted, image, admitted)

    def count_edges(self) -> None:
        """Begin to count the pixels at edges."""
        with self._phases.apart(CHECK):
            self._edges = self._scene.edge_pixels()

    def count_lost(self) -> None:
        """Count the fragments that frames lost since the first one; a cell has its worst frames."""
        self.lost = max(self.lost, self._frame.lost_in_a_frame())
        self._bench.device.check(f"{self._method}: sampling")

    # --- what was found --------------------------------------------------------------------------

    @property
    def ready(self) -> bool:
        """Whether nothing has to be waited for."""
        return all(pending.ready for pending in (*self._compared, self._packed, self._edges) if pending)

    @property
    def quality(self) -> dict[str, float | int | None]:
        """Errors of the first image against all fragments; empty for a method that promises no image."""
        if not self.promised:
            return {}
        with self._phases.apart(CHECK):
            return dict(self._compared[0]().quality)

    def errors(self) -> dict[str, float | int | None]:
        """Errors against the promise, the worst of all images, and those of `quality`; empty without a promise."""
        quality = self.quality
        with self._phases.apart(CHECK):
            every = [pending().conformance for pending in self._compared]
        worst = {name: max(found[name] for found in every) for name in every[0]} if every else {}
        return worst | quality

    def distinct(self) -> int | None:
        """Different images among those of one scene, where several were drawn; tied pixels alone tell none apart."""
        if not self._several:
            return None
        with self._phases.apart(CHECK):
            return len({pending().untied for pending in self._compared[self._first_of_several:]})

    def kept(self) -> Packed:
        """The arrays that the cell keeps."""
        if self._packed is None:
            return Packed(b"", None)
        with self._phases.apart(CHECK):
            return self._packed()

    def edge_pixels(self) -> int:
        """The pixels at edges, which were counted."""
        with self._phases.apart(CHECK):
            return self._edges()
