"""A scene's primitives in device memory, as vertex attributes, and the depth of what is opaque in it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import moderngl
import numpy as np

from ..glsl import StageSource, read
from ..glsl.bindings import OPAQUE_UNIT
from ..methods.spec import COMMAND_WORDS
from ..oracle import twochannel
from ..scene.geometry import Geometry
from ..scene.primitives import OPAQUE
from . import rawgl
from .context import Device
from .targets import Framebuffer, Texture

VERTEX_VERSION = "#version 430 core\n"


@dataclass(frozen=True)
class Attribute:
    """A vertex attribute: its name in GLSL, its moderngl format, and its field of a packed record.

    padding: the format in its place where a program does not use it.
    """

    name: str
    format: str
    padding: str
    field: tuple


@dataclass(frozen=True)
class Layout:
    """The way that the primitives of a geometry reach the device.

    mode and vertices: GL's mode, and vertices of a primitive. per_vertex: whether a record is one vertex of a
    primitive; else it is a whole primitive, drawn as an instance. indices: the vertices of a primitive that are drawn,
    one after the other; without them each once.
    """

    mode: int
    vertices: int
    per_vertex: bool
    attributes: tuple[Attribute, ...]
    indices: tuple[int, ...] = ()


COLOUR = Attribute("in_rgba", "4f1", "4x", ("rgba", "u1", 4))
CORNER = Attribute("in_corner", "4f", "16x", ("corner", "<f4", 4))
TRIANGLE = Layout(rawgl.TRIANGLES, 3, True, (CORNER, COLOUR))
# The two triangles of a strip. Instances of four vertices take a software driver up to an eighth of a frame longer.
STRIP = Layout(rawgl.TRIANGLES, 4, True, (CORNER, COLOUR), indices=(0, 1, 2, 2, 1, 3))
QUAD = Layout(rawgl.TRIANGLE_STRIP, 4, False, (Attribute("in_rect", "4i", "16x", ("rect", "<i4", 4)),
                                         Attribute("in_depth", "1f", "4x", ("depth", "<f4")), COLOUR))
LAYOUTS: Mapping[str, Layout] = {
    "quad": QUAD, "masked": QUAD, "strip": STRIP, "triangle": TRIANGLE, "reversed": TRIANGLE,
}


class SceneBuffer:
    """The primitives of `scene` on the device. Uploads stay outside every timed region."""

    def __init__(self, device: Device, scene: Geometry):
        self.device, self.scene = device, scene
        self._layout = LAYOUTS[scene.geometry]
        self.buffer = device.ctx.buffer(_packed(scene))
        self._indices = device.ctx.buffer(_indices(scene)) if self._layout.indices else None
        self._parted: moderngl.Buffer | None = None  # indices of the opaque primitives, and then of the others
        self._two_channel: tuple | None = None  # for payloads of two channels: codes of the primitives, base colours
        self._opaque = OpaqueDepth(device, scene.viewport) if scene.occluded else None
        if self._opaque:
            self._opaque.draw(scene)

    def vertex_array(self, program, opaque_first: bool = False):
        """The vertex array by which the program draws the scene; `opaque_first`: in parts, by `draw_part`."""
        if opaque_first and self._parted is None:
            self._parted = self.device.ctx.buffer(_parted(self.scene))
        return self.device.ctx.vertex_array(program, self._attributes(program), index_element_size=4,
                                            index_buffer=self._parted if opaque_first else self._indices)

    def _attributes(self, program) -> list[tuple]:
        """The attributes that the program uses, as moderngl's vertex_array takes them."""
        attributes, per = self._layout.attributes, "/v" if self._layout.per_vertex else "/i"
        used = [a.name for a in attributes if a.name in program]
        formats = " ".join(a.format if a.name in used else a.padding for a in attributes)
        codes = [(self.two_channel[0], f"4f1 {per}", "in_code")] if "in_code" in program else []
        return [(self.buffer, f"{formats} {per}", *used), *codes]

    def draw(self, vertex_array, commands=None) -> None:
        """Draw every primitive; with `commands`, a buffer of an indirect draw for each instance, in their order."""
        vertices, count = len(self._layout.indices) or self._layout.vertices, len(self.scene)
        if commands is not None:
            room = commands.size // (4 * COMMAND_WORDS)
            vertex_array.render_indirect(commands, mode=self._layout.mode, count=min(count, room))
        elif self._layout.per_vertex:
            vertex_array.render(mode=self._layout.mode, vertices=vertices * count)
        else:
            vertex_array.render(mode=self._layout.mode, vertices=vertices, instances=count)

    def draw_part(self, vertex_array, opaque: bool) -> None:
        """Draw the opaque primitives, or all others, of a geometry whose records are vertices."""
        vertices = len(self._layout.indices) or self._layout.vertices
        first, end = (0, self.scene.opaque_primitives) if opaque else (self.scene.opaque_primitives, len(self.scene))
        if end > first:
            vertex_array.render(mode=self._layout.mode, vertices=vertices * (end - first), first=vertices * first)

    def bind_opaque(self) -> None:
        """Let the shaders of the next draws see the depth of what is opaque, where anything is."""
        if self._opaque:
            self._opaque.texture.bind(OPAQUE_UNIT)

    @property
    def two_channel(self) -> tuple:
        """The buffers of the primitives' codes and of the base colours."""
        if self._two_channel is None:
            self._two_channel = tuple(map(self.device.ctx.buffer, self._encoded()))
        return self._two_channel

    def replace(self, scene: Geometry) -> None:
        """Upload the next frame of an animation."""
        self.scene = scene
        _write(self.buffer, _packed(scene))
        if self._indices:
            _write(self._indices, _indices(scene))
        if self._parted:
            _write(self._parted, _parted(scene))
        for buffer, data in zip(self._two_channel or (), self._encoded() if self._two_channel else (), strict=True):
            _write(buffer, data)
        if self._opaque:
            self._opaque.draw(scene)

    def _encoded(self) -> tuple[bytes, bytes]:
        """The codes of the records, and the two base colours as vec4."""
        encoding, stored = twochannel.words(self.scene.rgba)
        if self._layout.per_vertex:
            stored = np.repeat(stored, self._layout.vertices, axis=0)
        return stored.tobytes() or bytes(4), np.float32([[*encoding.a, 0], [*encoding.b, 0]]).tobytes()

    def release(self) -> None:
        """Free the device memory."""
        for made in (self.buffer, self._indices, self._parted, *(self._two_channel or ()), self._opaque):
            if made:
                made.release()


class OpaqueDepth:
    """A depth buffer of the viewport's size with a scene's opaque triangles, drawn outside every timed region."""

    def __init__(self, device: Device, viewport: tuple[int, int]):
        self._device = device
        self.texture = Texture(device.gl, "depth32f", viewport)
        self._framebuffer = Framebuffer(device.gl, [self.texture])
        sources = tuple(StageSource(entry, VERTEX_VERSION + read(entry), ("prelude", entry))
                        for entry in ("scene/opaque.vert", "scene/opaque.frag"))
        self._program = device.program(sources, "opaque triangles")

    def draw(self, scene: Geometry) -> None:
        """Draw the opaque triangles of the scene."""
        gl, ctx = self._device.gl, self._device.ctx
        corners = np.ascontiguousarray(scene.opaque, dtype="<f4").reshape(-1, 4)
        buffer = ctx.buffer(corners.tobytes())
        vertices = ctx.vertex_array(self._program, [(buffer, "4f /v", "in_corner")])
        self._framebuffer.use(colour=False, depth=True)
        self._framebuffer.clear(self.texture, (1.0,))
        gl.glDisable(rawgl.BLEND)
        gl.glEnable(rawgl.DEPTH_TEST)
        gl.glDepthFunc(rawgl.DEPTH_FUNCTIONS["less"])
        gl.clip_depths_from_zero(False)
        vertices.render(mode=rawgl.TRIANGLES, vertices=len(corners))
        gl.glDisable(rawgl.DEPTH_TEST)
        vertices.release()
        buffer.release()

    def release(self) -> None:
        """Free the device memory."""
        self._framebuffer.release()
        self.texture.release()


def _write(buffer, data: bytes) -> None:
    if len(data) > buffer.size:
        buffer.orphan(len(data))
    buffer.write(data)


def _packed(scene: Geometry) -> bytes:
    """The records one after the other; room for one primitive where there is none."""
    layout = LAYOUTS[scene.geometry]
    repeats = layout.vertices if layout.per_vertex else 1
    records = np.zeros(len(scene) * repeats, dtype=[attribute.field for attribute in layout.attributes])
    for name, values in _fields(scene).items():
        records[name] = values
    return records.tobytes() or bytes(records.itemsize * repeats)


def _fields(scene: Geometry) -> dict[str, np.ndarray]:
    """The fields of the records by name."""
    if LAYOUTS[scene.geometry] is QUAD:
        return {"rect": scene.rect, "depth": scene.depth, "rgba": scene.rgba}
    return {"corner": scene.position.reshape(-1, 4),
            "rgba": np.repeat(scene.rgba, LAYOUTS[scene.geometry].vertices, axis=0)}


def _parted(scene: Geometry) -> bytes:
    """The vertices of the opaque primitives and then of the others, as `_indices` has them."""
    return _indices(scene, np.argsort(scene.rgba[:, 3] != OPAQUE, kind="stable"))


def _indices(scene: Geometry, order: np.ndarray | None = None) -> bytes:
    """The vertices to draw, uint32, primitive by primitive in this order; room for one where there is none."""
    layout = LAYOUTS[scene.geometry]
    primitive = np.arange(max(1, len(scene)), dtype=np.uint32) if order is None else order.astype(np.uint32)
    each = np.array(layout.indices or range(layout.vertices), dtype=np.uint32)
    return (primitive[:, None] * np.uint32(layout.vertices) + each).tobytes()
