"""Textures of the viewport's size and the framebuffers that draw into them."""

from __future__ import annotations

import ctypes

import numpy as np

from ..methods.spec import FORMAT_WORDS
from . import rawgl
from .context import Device
from .rawgl import RawGL


class BufferTexture:
    """A texture of a buffer's memory, through which shaders read its elements, one or two at a time."""

    def __init__(self, gl: RawGL, buffer: int, words: int):
        self.gl, self.name = gl, gl.generate("Textures")
        gl.glBindTexture(rawgl.TEXTURE_BUFFER, self.name)
        gl.glTexBuffer(rawgl.TEXTURE_BUFFER, rawgl.TEXEL_FORMATS[words], buffer)

    def bind(self, unit: int) -> None:
        self.gl.glActiveTexture(rawgl.TEXTURE0 + unit)
        self.gl.glBindTexture(rawgl.TEXTURE_BUFFER, self.name)

    def release(self) -> None:
        self.gl.delete("Textures", self.name)


class Texture:
    """An immutable texture without mipmaps or filtering. `format` is a key of `rawgl.FORMATS`.

    With `samples` it is a multisample texture, with `layers` an array; without either, a plain one. To make one takes
    unit 0, which every pass that reads a texture binds anew: a frame that makes one keeps what it has bound elsewhere.
    """

    def __init__(self, gl: RawGL, format: str, size: tuple[int, int], samples: int = 0, layers: int = 0):
        self.gl, self.format, self.size, self.layers = gl, format, size, layers
        self.target = (rawgl.TEXTURE_2D_MULTISAMPLE if samples else rawgl.TEXTURE_2D_ARRAY if layers
                       else rawgl.TEXTURE_2D)
        self.name = gl.generate("Textures")
        gl.glActiveTexture(rawgl.TEXTURE0)
        gl.glBindTexture(self.target, self.name)
        self._allocate(samples)
        self.samples = gl.texture_samples(self.target) if samples else 1

    def _allocate(self, samples: int) -> None:
        internal = rawgl.FORMATS[self.format]
        if samples:
            self.gl.glTexStorage2DMultisample(self.target, samples, internal, *self.size, True)
            return
        if self.layers:
            self.gl.glTexStorage3D(self.target, 1, internal, *self.size, self.layers)
        else:
            self.gl.glTexStorage2D(self.target, 1, internal, *self.size)
        for parameter in (rawgl.TEXTURE_MIN_FILTER, rawgl.TEXTURE_MAG_FILTER):
            self.gl.glTexParameteri(self.target, parameter, rawgl.NEAREST)

    @property
    def is_depth(self) -> bool:
        return self.format.startswith("depth")

    @property
    def bytes(self) -> int:
        """The size of the target in bytes, with all samples and layers."""
        return int(4 * FORMAT_WORDS[self.format]) * self.size[0] * self.size[1] * self.samples * max(1, self.layers)

    def attach(self, attachment: int) -> None:
        """Attach the target to the bound framebuffer; the layers of an array to successive attachments."""
        for layer in range(self.layers):
            self.gl.glFramebufferTextureLayer(rawgl.FRAMEBUFFER, attachment + layer, self.name, 0, layer)
        if not self.layers:
            self.gl.glFramebufferTexture(rawgl.FRAMEBUFFER, attachment, self.name, 0)

    def bind(self, unit: int) -> None:
        self.gl.glActiveTexture(rawgl.TEXTURE0 + unit)
        self.gl.glBindTexture(self.target, self.name)

    def bind_image(self, unit: int) -> None:
        """Bind the target as an image for a compute pass to write."""
        self.gl.glBindImageTexture(unit, self.name, 0, False, 0, rawgl.WRITE_ONLY, rawgl.FORMATS[self.format])

    def release(self) -> None:
        self.gl.delete("Textures", self.name)


class Framebuffer:
    """Draws into `textures`: colours in location order, at most one depth, with its stencil where it has one."""

    def __init__(self, gl: RawGL, textures: list[Texture]):
        self.gl, self.textures, self.size = gl, textures, textures[0].size
        self.colours = [t for t in textures if not t.is_depth]
        self.name = gl.generate("Framebuffers")
        gl.glBindFramebuffer(rawgl.FRAMEBUFFER, self.name)
        self.locations: dict[int, range] = {}  # of each colour texture, by its name
        first = 0
        for texture in self.colours:
            texture.attach(rawgl.COLOR_ATTACHMENT0 + first)
            self.locations[texture.name] = range(first, first + max(1, texture.layers))
            first += max(1, texture.layers)
        for texture in textures:
            if texture.is_depth:
                texture.attach(rawgl.DEPTH_STENCIL_ATTACHMENT if "stencil" in texture.format
                               else rawgl.DEPTH_ATTACHMENT)
        attachments = [rawgl.COLOR_ATTACHMENT0 + i for i in range(first)] or [0]
        gl.glDrawBuffers(len(attachments), (ctypes.c_uint * len(attachments))(*attachments))
        status = gl.glCheckFramebufferStatus(rawgl.FRAMEBUFFER)
        if status != rawgl.FRAMEBUFFER_COMPLETE:
            raise MemoryError(f"framebuffer incomplete ({status:#x}) with {[t.format for t in textures]}")

    def use(self, colour: bool, depth: bool) -> None:
        """Make this the draw target; `colour` and `depth` say whether draws may write."""
        self.gl.glBindFramebuffer(rawgl.FRAMEBUFFER, self.name)
        self.gl.glViewport(0, 0, *self.size)
        self.gl.glColorMask(colour, colour, colour, colour)
        self.gl.glDepthMask(depth)

    def keep(self, texture: Texture) -> None:
        """Let draws leave an attached colour as it is, until the framebuffer is used again."""
        for location in self.locations[texture.name]:
            self.gl.glColorMaski(location, False, False, False, False)

    def clear(self, texture: Texture, values: tuple[float, ...]) -> None:
        """Give one attached texture a value: channels, or depth and stencil. It is in use, with writes allowed."""
        if "stencil" in texture.format:
            self.gl.glClearBufferfi(rawgl.DEPTH_STENCIL, 0, values[0], int(values[1]))
        elif texture.is_depth:
            self.gl.clear(rawgl.DEPTH, 0, values)
        else:
            for location in self.locations[texture.name]:
                self._clear_colour(location, texture, values)

    def _clear_colour(self, location: int, texture: Texture, values: tuple[float, ...]) -> None:
        if texture.format.endswith("ui"):
            self.gl.clear_whole(rawgl.COLOR, location, values)
        else:
            self.gl.clear(rawgl.COLOR, location, values)

    def read(self) -> np.ndarray:
        """float32 (H, W, 4) of the first colour texture, row 0 at the bottom."""
        width, height = self.size
        pixels = np.empty((height, width, 4), dtype=np.float32)
        self.gl.glBindFramebuffer(rawgl.FRAMEBUFFER, self.name)
        self.gl.glReadBuffer(rawgl.COLOR_ATTACHMENT0)
        self.gl.glReadPixels(0, 0, width, height, rawgl.RGBA, rawgl.FLOATS, pixels.ctypes.data)
        return pixels

    def release(self) -> None:
        self.gl.delete("Framebuffers", self.name)


class BareFramebuffer:
    """Takes draws that write to buffers alone: it has samples and no attachments."""

    def __init__(self, gl: RawGL, size: tuple[int, int], samples: int):
        self.gl, self.size = gl, size
        self.name = gl.generate("Framebuffers")
        gl.glBindFramebuffer(rawgl.FRAMEBUFFER, self.name)
        for parameter, value in ((rawgl.DEFAULT_WIDTH, size[0]), (rawgl.DEFAULT_HEIGHT, size[1]),
                                 (rawgl.DEFAULT_SAMPLES, samples), (rawgl.DEFAULT_FIXED_PLACES, True)):
            gl.glFramebufferParameteri(rawgl.FRAMEBUFFER, parameter, value)

    def use(self, colour: bool, depth: bool) -> None:
        """Make this the draw target. There is nothing to write to."""
        self.gl.glBindFramebuffer(rawgl.FRAMEBUFFER, self.name)
        self.gl.glViewport(0, 0, *self.size)

    def release(self) -> None:
        """Free the GL object."""
        self.gl.delete("Framebuffers", self.name)


class Canvas:
    """The image that every method of one viewport size resolves into: RGBA32F, premultiplied.

    `drawn_in(samples)` is the framebuffer of draws into the image that are rasterized into samples, `bare(samples)` of
    draws that write to buffers alone. Both are made when they are first asked for.
    """

    def __init__(self, device: Device, size: tuple[int, int]):
        self._gl, self._size = device.gl, size
        self.texture = Texture(device.gl, "rgba32f", size)
        self.framebuffer = Framebuffer(device.gl, [self.texture])
        self._sampled: dict[int, Framebuffer] = {}
        self._bare: dict[int, BareFramebuffer] = {}

    def drawn_in(self, samples: int) -> Framebuffer:
        """The framebuffer whose draws become the image: with 1 sample directly, else by `resolve`."""
        if samples == 1:
            return self.framebuffer
        if samples not in self._sampled:
            self._sampled[samples] = Framebuffer(self._gl, [Texture(self._gl, "rgba32f", self._size, samples)])
        return self._sampled[samples]

    def bare(self, samples: int) -> BareFramebuffer:
        """The framebuffer without attachments."""
        if samples not in self._bare:
            self._bare[samples] = BareFramebuffer(self._gl, self._size, samples)
        return self._bare[samples]

    def resolve(self, samples: int) -> None:
        """Make the image the mean of the samples of what was drawn."""
        gl, box = self._gl, (0, 0, *self._size)
        gl.glBindFramebuffer(rawgl.READ_FRAMEBUFFER, self.drawn_in(samples).name)
        gl.glBindFramebuffer(rawgl.DRAW_FRAMEBUFFER, self.framebuffer.name)
        gl.glBlitFramebuffer(*box, *box, rawgl.COLOR_BUFFER_BIT, rawgl.NEAREST)

    def release(self) -> None:
        """Free the device memory."""
        for made in (self.framebuffer, *self._sampled.values(), *self._bare.values()):
            made.release()
        for texture in (self.texture, *(texture for made in self._sampled.values() for texture in made.textures)):
            texture.release()
