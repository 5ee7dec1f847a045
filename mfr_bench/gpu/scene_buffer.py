"""A scene's primitives in device memory, as vertex attributes."""

from __future__ import annotations

import numpy as np

from ..oracle import twochannel
from ..scene import Geometry
from .device import Device

# By the geometry of a scene: each attribute, its moderngl format, the padding in its place where a program does not
# use it, and its field of the packed primitive.
COLOUR = ("in_rgba", "4f1", "4x", ("rgba", "u1", 4))
LAYOUTS = {
    "quad": (("in_rect", "4i", "16x", ("rect", "<i4", 4)), ("in_depth", "1f", "4x", ("depth", "<f4")), COLOUR),
    "strip": (*((f"in_corner{i}", "4f", "16x", (f"corner{i}", "<f4", 4)) for i in range(4)), COLOUR),
}


class SceneBuffer:
    """The primitives of `scene` on the device. Uploads stay outside every timed region."""

    def __init__(self, device: Device, scene: Geometry):
        self.device, self.scene = device, scene
        self.buffer = device.ctx.buffer(_packed(scene))
        self._two_channel: tuple | None = None  # for payloads of two channels: codes of the primitives, base colours

    def attributes(self, program) -> list[tuple]:
        """The per-instance attributes that the program uses, as moderngl's vertex_array takes them."""
        layout = LAYOUTS[self.scene.geometry]
        used = [name for name, *_ in layout if name in program]
        formats = " ".join(form if name in used else padding for name, form, padding, _ in layout)
        codes = [(self.two_channel[0], "4f1 /i", "in_code")] if "in_code" in program else []
        return [(self.buffer, f"{formats} /i", *used), *codes]

    def draw(self, vertex_array) -> None:
        """Draw every primitive, as an instance of a triangle strip of four vertices."""
        vertex_array.render(mode=5, vertices=4, instances=len(self.scene))  # GL_TRIANGLE_STRIP

    @property
    def two_channel(self) -> tuple:
        """The buffers of the primitives' codes and of the base colours."""
        if self._two_channel is None:
            self._two_channel = tuple(map(self.device.ctx.buffer, _encoded(self.scene)))
        return self._two_channel

    def replace(self, scene: Geometry) -> None:
        """Upload the next frame of an animation."""
        self.scene = scene
        _write(self.buffer, _packed(scene))
        for buffer, data in zip(self._two_channel or (), _encoded(scene) if self._two_channel else (), strict=True):
            _write(buffer, data)

    def release(self) -> None:
        """Free the device memory."""
        for buffer in (self.buffer, *(self._two_channel or ())):
            buffer.release()


def _write(buffer, data: bytes) -> None:
    if len(data) > buffer.size:
        buffer.orphan(len(data))
    buffer.write(data)


def _encoded(scene: Geometry) -> tuple[bytes, bytes]:
    """The codes of the primitives, and the two base colours as vec4."""
    encoding, stored = twochannel.words(scene.rgba)
    return stored.tobytes() or bytes(4), np.float32([[*encoding.a, 0], [*encoding.b, 0]]).tobytes()


def _packed(scene: Geometry) -> bytes:
    """The primitives one after the other; room for one where there is none."""
    primitives = np.zeros(len(scene), dtype=[field for *_, field in LAYOUTS[scene.geometry]])
    arrays = scene.arrays()
    if "position" in arrays:
        arrays |= {f"corner{i}": scene.position[:, i] for i in range(4)}
    for name in primitives.dtype.names:
        primitives[name] = arrays[name]
    return primitives.tobytes() or bytes(primitives.itemsize)
