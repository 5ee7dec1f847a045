"""The buffers and textures that a variant declares, in device memory, grown as frames need it."""

from __future__ import annotations

import numpy as np

from ..errors import CapacityError
from ..glsl.bindings import split_ref
from ..methods.spec import IMAGE, Buffer, Fitted, Target
from . import rawgl
from .context import Device
from .targets import BufferTexture, Canvas, Texture


class Allocation:
    """Everything that a fitted variant has allocated. `room` is the number of elements that there is room for.

    `version` changes whenever a buffer has been replaced, and its contents with it. Raises MemoryError where the device
    has no room.
    """

    def __init__(self, device: Device, fitted: Fitted, canvas: Canvas):
        self._device, self._fitted, self._canvas = device, fitted, canvas
        self.room = fitted.start_capacity()
        self.version = 0
        self._targets = {t.name: t for t in fitted.variant.targets}
        self._textures = {name: self._copies(t) for name, t in self._targets.items() if not t.on_demand}
        self._buffers: dict[str, list] = {}
        self._texels: dict[str, dict[bool, BufferTexture | None]] = {}  # of a buffer; by whether texels are pairs
        self._allocate()

    def _copies(self, target: Target) -> list[Texture]:
        return [self._texture(target) for _ in range(target.copies)]

    def _texture(self, target: Target) -> Texture:
        stats = self._fitted.stats
        return Texture(self._device.gl, target.format, (stats.W, stats.H),
                       self._fitted.samples(target) if target.samples else 0,
                       self._fitted.layer_count(target) if target.layers else 0)

    def _allocate(self, trims: bool = False) -> None:
        """Make every buffer that is missing or too small for the room, or with `trims` too large."""
        for buffer in self._fitted.variant.buffers:
            size = self._fitted.block_bytes(buffer, self.room)
            present = self._buffers.get(buffer.name, [])
            if present and (present[0].size == size or (present[0].size > size and not trims)):
                continue
            for old in (*present, *self._texels_of(buffer.name)):
                old.release()
            self._buffers[buffer.name] = [self._made(buffer, size) for _ in range(buffer.copies)]
            self.version += 1

    def _made(self, buffer: Buffer, size: int):
        """A new buffer: zeros where each frame continues from the frame before, undefined where it does not."""
        if buffer.continues:
            return self._device.ctx.buffer(bytes(size))
        return self._device.ctx.buffer(reserve=size)

    def _texels_of(self, name: str) -> list[BufferTexture]:
        """The textures of a buffer's memory, which go with the buffer."""
        return [texture for texture in self._texels.pop(name, {}).values() if texture]

    def texels(self, name: str, pairs: bool = False) -> BufferTexture | None:
        """A texture of the memory of a buffer of one copy; None where the device has none so large.

        A texel is an element, or with `pairs` two.
        """
        made = self._texels.setdefault(name, {})
        if pairs not in made:
            made[pairs] = self._made_texels(name, pairs)
        return made[pairs]

    def _made_texels(self, name: str, pairs: bool) -> BufferTexture | None:
        declared, = (b for b in self._fitted.variant.buffers if b.name == name)
        buffer, words = self.named(name), self._fitted.element_bytes(declared) // 4 * (2 if pairs else 1)
        if buffer.size // (4 * words) > self._device.max_texels:
            return None
        return BufferTexture(self._device.gl, buffer.glo, words)

    def hold(self, elements: int) -> None:
        """Make room for at least so many elements."""
        if elements > self.room:
            self.room = elements
            self._allocate()

    def trim(self, elements: int) -> None:
        """Leave room for no more than so many elements."""
        if elements < self.room:
            self.room = elements
            self._allocate(trims=True)

    def check_room(self, elements: int, wanted: int) -> None:
        """Raise CapacityError where a storage block cannot have so many elements, of which a frame `wanted` some."""
        most = self._device.max_block_bytes
        for buffer in self._fitted.variant.buffers:
            if (size := self._fitted.block_bytes(buffer, elements)) > most:
                raise CapacityError(f"{wanted} fragments do not fit: {buffer.name} would grow to {size} bytes, "
                                    f"a storage block holds {most}")

    @property
    def names(self) -> list[str]:
        """The names of all buffers."""
        return list(self._buffers)

    @property
    def memory_bytes(self) -> dict[str, int]:
        """Bytes of each allocated object, by the name of its declaration."""
        buffers = {name: sum(b.size for b in copies) for name, copies in self._buffers.items()}
        textures = {name: sum(t.bytes for t in copies) for name, copies in self._textures.items()}
        return buffers | textures

    def named(self, name: str):
        """A buffer of one copy."""
        return self._buffers[name][0]

    def buffer(self, ref: str, iteration: int):
        """The copy of a buffer that a pass of this iteration means."""
        copies = self._buffers[split_ref(ref)[0]]
        return copies[_copy(ref, iteration, len(copies))]

    def texture(self, ref: str, iteration: int) -> Texture:
        """The copy of a texture that a pass of this iteration means; the canvas for the image."""
        name = split_ref(ref)[0]
        if name == IMAGE:
            return self._canvas.texture
        if name not in self._textures:
            self._textures[name] = self._copies(self._targets[name])
        copies = self._textures[name]
        return copies[_copy(ref, iteration, len(copies))]

    def words(self, name: str) -> np.ndarray:
        """uint32 contents of a buffer."""
        self._device.gl.glMemoryBarrier(rawgl.BARRIERS["buffer_update"])
        return np.frombuffer(self._buffers[name][0].read(), dtype=np.uint32)

    def fill(self, name: str, words: np.ndarray) -> None:
        """Give a buffer uint32 contents."""
        self._buffers[name][0].write(np.ascontiguousarray(words, dtype=np.uint32).tobytes())
        self.version += 1

    def release(self) -> None:
        """Free the device memory."""
        for copies in (*self._buffers.values(), *self._textures.values(), *map(self._texels_of, list(self._texels))):
            for each in copies:
                each.release()


def _copy(ref: str, iteration: int, copies: int) -> int:
    """The copy that a ref names: `.current` is iteration i's own, `.previous` the one of the iteration before."""
    return (iteration + (split_ref(ref)[1] == "previous")) % copies
