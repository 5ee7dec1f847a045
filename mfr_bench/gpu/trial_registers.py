"""A trial of programs that keep more values at once than the processor has registers."""

from __future__ import annotations

import moderngl
import numpy as np

from .. import glsl
from .context import Device
from .vectors import VARIABLE, WITHOUT, instructions

SIDE, GROUP = 16, 8  # pixels of the image's and of a work group's side
PIXELS = SIDE * SIDE
NODES = 9  # of each pixel
CHOSEN = 0.0625  # what the shader looks for in its texture
ROUNDING = 1e-4  # of a channel from 0 to 1


def full_registers(device: Device) -> tuple[bool, str]:
    """Whether each pixel composites the nodes of its list, of which it keeps all in registers at once."""
    rgba = np.random.default_rng(1).integers(0, 256, (PIXELS, NODES, 4), dtype=np.uint8)
    image, left_behind = _dispatched(device, rgba)
    right = int((np.abs(image - _composited(rgba)).max(axis=-1) <= ROUNDING).sum())
    passed = right == PIXELS and left_behind == 0
    chosen = f", with {VARIABLE}={instructions()}" if instructions() else ""
    advice = "" if passed else f"; on Mesa, {VARIABLE}={WITHOUT} in the environment avoids it"
    return passed, f"{right} of {PIXELS} pixels right that keep {NODES} nodes in registers{chosen}{advice}"


def _dispatched(device: Device, rgba: np.ndarray) -> tuple[np.ndarray, int]:
    """The image of the lists, and the nodes left behind. rgba: pixels by nodes by channels, nearest first."""
    ctx = device.ctx
    program = ctx.compute_shader(f"{glsl.prelude.VERSION}\n{glsl.includes.read('probe/full_registers.comp')}")
    program["columns"] = program["rows"] = SIDE
    nodes = np.stack([np.arange(PIXELS * NODES, dtype=np.uint32), rgba.reshape(-1, 4).view(np.uint32)[:, 0]], axis=1)
    ends = np.arange(1, PIXELS + 1, dtype=np.uint32) * NODES
    words = (np.full(PIXELS, NODES, np.uint32), ends.astype(np.uint32), nodes, np.zeros(1, np.uint32))
    buffers = [ctx.buffer(array.tobytes()) for array in words]
    chosen = ctx.texture((SIDE, SIDE), 1, np.full(PIXELS, CHOSEN, np.float32).tobytes(), dtype="f4")
    image = ctx.texture((SIDE, SIDE), 4, dtype="f4")
    try:
        for binding, buffer in enumerate(buffers):
            buffer.bind_to_storage_buffer(binding)
        chosen.filter = (moderngl.NEAREST, moderngl.NEAREST)
        chosen.use(0)
        image.bind_to_image(0, read=False, write=True)
        program.run((SIDE // GROUP) ** 2)
        ctx.memory_barrier()
        return (np.frombuffer(image.read(), np.float32).reshape(PIXELS, 4),
                int(np.frombuffer(buffers[-1].read(), np.uint32)[0]))
    finally:
        for made in (image, chosen, *buffers, program):
            made.release()


def _composited(rgba: np.ndarray) -> np.ndarray:
    """Colour and opacity of each pixel, by the definition of compositing front to back."""
    layers = rgba.astype(np.float64) / 255
    through = np.cumprod(1 - layers[..., 3:], axis=1)
    before = np.concatenate([np.ones_like(through[:, :1]), through[:, :-1]], axis=1)
    colour = (before * layers[..., :3] * layers[..., 3:]).sum(axis=1)
    return np.concatenate([colour, 1 - through[:, -1]], axis=1)
