"""Counters outside every method's memory: lost fragments, probes, and the work of programs that count it."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np

from ..glsl.bindings import DIAGNOSTICS, DIAGNOSTICS_BINDING
from ..glsl.counters import WORK
from . import rawgl
from .context import Device

WORD = 4  # bytes
WORK_OFFSET = WORD * len(DIAGNOSTICS)


class Diagnostics:
    """The storage block `Diagnostics` of shaders: a word for each of DIAGNOSTICS, then two for each of WORK."""

    def __init__(self, device: Device):
        self._device = device
        self._buffer = device.ctx.buffer(bytes(WORK_OFFSET + 2 * WORD * len(WORK)))

    def bind(self) -> None:
        """Let the shaders of the next draws see the counters."""
        self._buffer.bind_to_storage_buffer(DIAGNOSTICS_BINDING)

    def take(self, name: str) -> int:
        """The value of one of DIAGNOSTICS, which starts again from 0."""
        at = WORD * DIAGNOSTICS.index(name)
        value = int(self._read(WORD, at)[0])
        self._buffer.write(bytes(WORD), offset=at)
        return value

    def work(self) -> Counter[str]:
        """The counts of counting programs since `reset_work`, by the names of `glsl.counters.WORK`."""
        counted = self._read(2 * WORD * len(WORK), WORK_OFFSET)
        low, high = counted[::2].astype(object), counted[1::2].astype(object)
        return Counter(dict(zip(WORK, low + 2**32 * high, strict=True)))

    def reset_work(self) -> None:
        """Start every counter of WORK again from 0."""
        self._buffer.write(bytes(2 * WORD * len(WORK)), offset=WORK_OFFSET)

    @contextmanager
    def mapped(self, pixels: int) -> Iterator[None]:
        """Within this, programs that count for each pixel have a word for each in place of WORK; see `map`."""
        own = self._buffer
        self._buffer = self._device.ctx.buffer(bytes(WORK_OFFSET + WORD * pixels))
        try:
            yield
        finally:
            self._buffer.release()
            self._buffer = own

    def map(self) -> np.ndarray:
        """uint32 (pixels,): what was counted for each pixel within `mapped`."""
        return self._read(-1, WORK_OFFSET)

    def _read(self, size: int, offset: int) -> np.ndarray:
        self._device.gl.glMemoryBarrier(rawgl.BARRIERS["buffer_update"])
        return np.frombuffer(self._buffer.read(size, offset=offset), dtype=np.uint32)

    def release(self) -> None:
        """Free the device memory."""
        self._buffer.release()
