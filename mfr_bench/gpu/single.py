"""One image of one method, outside any measurement."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np

from ..methods.spec import Fitted, SceneStats, Variant
from ..oracle.quality import conformance
from ..scene.geometry import Geometry
from .context import Device
from .frame import Frame
from .scene_buffer import SceneBuffer
from .targets import Canvas
from .truth import Truth, true_stats


class Shown:
    """A scene on the device, for one method at a time. `stats` are its true ones."""

    def __init__(self, device: Device, scene: Geometry):
        self.device = device
        self.scene_buffer, self.canvas = SceneBuffer(device, scene), Canvas(device, scene.viewport)
        self.stats: SceneStats = true_stats(device, self.scene_buffer, self.canvas)
        self.truth = Truth(device, self.scene_buffer, self.canvas)

    def render(self, variant: Variant) -> np.ndarray:
        """float32 (H, W, 4), premultiplied over transparent black, row 0 at the bottom."""
        frame = Frame(self.device, Fitted(variant, self.stats), self.scene_buffer, self.canvas)
        try:
            frame.draw_fitting()
            return frame.image()
        finally:
            frame.release()

    def errors(self, variant: Variant, image: np.ndarray) -> dict[str, float | int] | None:
        """The errors of an image against what the variant promises; None where nothing can be compared."""
        if variant.guarantee == "none":
            return None
        promised = self.truth.answer(Fitted(variant, self.stats).promise())
        return conformance(image, promised, promised.given_by(variant.method))


@contextmanager
def shown(device: Device, scene: Geometry) -> Iterator[Shown]:
    """The scene on the device while the context lasts."""
    on = Shown(device, scene)
    try:
        yield on
    finally:
        on.canvas.release()
        on.scene_buffer.release()
