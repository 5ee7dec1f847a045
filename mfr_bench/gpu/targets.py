"""Textures of the viewport's size and the framebuffers that draw into them."""

from __future__ import annotations

import ctypes

import numpy as np

from . import rawgl
from .rawgl import RawGL


class Texture:
    """An immutable texture without mipmaps or filtering. `format` is a key of `rawgl.FORMATS`."""

    def __init__(self, gl: RawGL, format: str, size: tuple[int, int]):
        self.gl, self.format, self.size = gl, format, size
        self.name = gl.generate("Textures")
        gl.glBindTexture(rawgl.TEXTURE_2D, self.name)
        gl.glTexStorage2D(rawgl.TEXTURE_2D, 1, rawgl.FORMATS[format], *size)
        for parameter in (rawgl.TEXTURE_MIN_FILTER, rawgl.TEXTURE_MAG_FILTER):
            gl.glTexParameteri(rawgl.TEXTURE_2D, parameter, rawgl.NEAREST)

    @property
    def is_depth(self) -> bool:
        return self.format.startswith("depth")

    def bind(self, unit: int) -> None:
        self.gl.glActiveTexture(rawgl.TEXTURE0 + unit)
        self.gl.glBindTexture(rawgl.TEXTURE_2D, self.name)

    def release(self) -> None:
        self.gl.delete("Textures", self.name)


class Framebuffer:
    """Draws into `textures`: colours in location order, at most one depth."""

    def __init__(self, gl: RawGL, textures: list[Texture]):
        self.gl, self.textures, self.size = gl, textures, textures[0].size
        self.colours = [t for t in textures if not t.is_depth]
        self.name = gl.generate("Framebuffers")
        gl.glBindFramebuffer(rawgl.FRAMEBUFFER, self.name)
        for index, texture in enumerate(self.colours):
            gl.glFramebufferTexture(rawgl.FRAMEBUFFER, rawgl.COLOR_ATTACHMENT0 + index, texture.name, 0)
        for texture in textures:
            if texture.is_depth:
                gl.glFramebufferTexture(rawgl.FRAMEBUFFER, rawgl.DEPTH_ATTACHMENT, texture.name, 0)
        attachments = [rawgl.COLOR_ATTACHMENT0 + i for i in range(len(self.colours))] or [0]
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

    def clear(self, texture: Texture, values: tuple[float, ...]) -> None:
        """Give one attached texture a value. The framebuffer is in use, with writes allowed."""
        if texture.is_depth:
            self.gl.clear(rawgl.DEPTH, 0, values)
        else:
            self.gl.clear(rawgl.COLOR, self.colours.index(texture), values)

    def read(self) -> np.ndarray:
        """float32 (H, W, 4) of the first colour texture, row 0 at the bottom."""
        width, height = self.size
        pixels = np.empty((height, width, 4), dtype=np.float32)
        self.gl.glBindFramebuffer(rawgl.FRAMEBUFFER, self.name)
        self.gl.glReadBuffer(rawgl.COLOR_ATTACHMENT0)
        self.gl.glReadPixels(0, 0, width, height, 0x1908, 0x1406, pixels.ctypes.data)  # GL_RGBA, GL_FLOAT
        return pixels

    def release(self) -> None:
        self.gl.delete("Framebuffers", self.name)
