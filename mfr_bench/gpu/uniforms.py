"""The uniform blocks `Frame` and `Box`, and blocks of one field: what shaders know of viewport, scene and capacity.

A block that a shader declares counts as active though nothing reads it, and needs a buffer (OpenGL 4.6, §7.6.3): many
shaders declare `Colours`, which only payloads of two channels read.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..glsl.bindings import (
    ALONE_BINDING,
    ALONE_BYTES,
    ALONE_FIELDS,
    BOX_BINDING,
    BOX_FIELDS,
    COLOURS_BINDING,
    COLOURS_BYTES,
    EDGE_FIELDS,
    FRAME_BINDING,
    FRAME_FIELDS,
)
from ..methods.spec import SceneStats
from ..scene.geometry import Geometry
from .context import Device

FIELDS = FRAME_FIELDS + EDGE_FIELDS


def _block_bytes(fields: Sequence[str]) -> int:
    """Bytes of a block with a word for each field, in whole vec4 as drivers count them."""
    return 16 * -(-len(fields) // 4)


class Uniforms:
    """The buffers of the blocks, which are written whenever one of their fields changes."""

    def __init__(self, device: Device, stats: SceneStats):
        self._stats = stats
        self._buffer = device.ctx.buffer(reserve=_block_bytes(FIELDS))
        self._alone = device.ctx.buffer(reserve=ALONE_BYTES * len(ALONE_FIELDS))
        self._box = device.ctx.buffer(reserve=_block_bytes(BOX_FIELDS))
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
        alone = np.zeros((len(ALONE_FIELDS), ALONE_BYTES // 4), dtype=np.uint32)
        alone[:, 0] = [values[name] for name in ALONE_FIELDS]
        self._alone.write(alone.tobytes())
        self._box.write(np.array(scene.depth_bounds, dtype=np.float32).tobytes())

    def bind(self) -> None:
        """Let the shaders of the next draws see `Frame` and blocks of one field, and have a buffer for `Colours`."""
        self._buffer.bind_to_uniform_block(FRAME_BINDING)
        self._no_colours.bind_to_uniform_block(COLOURS_BINDING)
        for place in range(len(ALONE_FIELDS)):
            self._alone.bind_to_uniform_block(ALONE_BINDING + place, offset=place * ALONE_BYTES, size=ALONE_BYTES)

    def bind_box(self) -> None:
        """Let the shaders of the next draws see the block `Box`."""
        self._box.bind_to_uniform_block(BOX_BINDING)

    def release(self) -> None:
        """Free the device memory."""
        self._buffer.release()
        self._box.release()
        self._no_colours.release()
        self._alone.release()
