"""The uniform blocks `Frame` and `Box`: what shaders know of the viewport, the scene and the capacity.

A block that a shader declares counts as active though nothing reads it, and needs a buffer (OpenGL 4.6, §7.6.3): many
shaders declare `Colours`, which only payloads of two channels read.
"""

from __future__ import annotations

import numpy as np

from ..glsl.bindings import (
    BOX_BINDING,
    BOX_FIELDS,
    COLOURS_BINDING,
    COLOURS_BYTES,
    EDGE_FIELDS,
    FRAME_BINDING,
    FRAME_FIELDS,
    REGION_FIELDS,
)
from ..methods.spec import SceneStats
from ..scene.geometry import Geometry
from .context import Device

FIELDS = FRAME_FIELDS + REGION_FIELDS + EDGE_FIELDS


class Uniforms:
    """The buffers of the blocks, which are written whenever one of their fields changes."""

    def __init__(self, device: Device, stats: SceneStats):
        self._stats = stats
        self._buffer = device.ctx.buffer(reserve=4 * len(FIELDS))
        self._box = device.ctx.buffer(reserve=4 * len(BOX_FIELDS))
        self._no_colours = device.ctx.buffer(reserve=COLOURS_BYTES)

    def write(self, scene: Geometry, capacity: int, chosen_k: int) -> None:
        """Give every field its value. `chosen_k`: the fragments that a pixel keeps; 0 where all are kept."""
        stats, (left, bottom, columns, rows) = self._stats, scene.bounds
        values = {
            "width": stats.W, "height": stats.H, "pixels": stats.P, "capacity": capacity, "seed": scene.seed,
            "keep_threshold": min(scene.keep_threshold, 2**32 - 1), "chosen_k": chosen_k,
            "region_first": bottom * columns + left, "region_columns": columns, "region_pixels": columns * rows,
            "region_left": left, "region_bottom": bottom, "region_right": left + columns, "region_top": bottom + rows}
        self._buffer.write(np.array([values[name] for name in FIELDS], dtype=np.uint32).tobytes())
        self._box.write(np.array(scene.depth_bounds, dtype=np.float32).tobytes())

    def bind(self) -> None:
        """Let the shaders of the next draws see the block `Frame`, and have a buffer for `Colours`."""
        self._buffer.bind_to_uniform_block(FRAME_BINDING)
        self._no_colours.bind_to_uniform_block(COLOURS_BINDING)

    def bind_box(self) -> None:
        """Let the shaders of the next draws see the block `Box`."""
        self._box.bind_to_uniform_block(BOX_BINDING)

    def release(self) -> None:
        """Free the device memory."""
        self._buffer.release()
        self._box.release()
        self._no_colours.release()
