"""One image of one method, outside any measurement."""

from __future__ import annotations

import numpy as np

from ..methods.spec import Sizes, Variant
from ..scene import Scene
from .device import Device
from .frame import Canvas, Frame, SceneBuffer


def render(device: Device, variant: Variant, scene: Scene, sizes: Sizes) -> np.ndarray:
    """float32 (H, W, 4), premultiplied over transparent black, row 0 at the bottom."""
    quads, canvas = SceneBuffer(device, scene), Canvas(device, (sizes.W, sizes.H))
    frame = Frame(device, variant, sizes, quads, canvas)
    try:
        frame.draw_fitting()
        return frame.image()
    finally:
        frame.release()
        canvas.release()
        quads.release()
