"""Trials whose shaders stand by themselves, without the prelude of methods: other text around them hides the fault."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from .. import glsl
from . import rawgl
from .context import Device
from .targets import Framebuffer, Texture

SIZE = (24, 20)  # pixels
PIXELS = SIZE[0] * SIZE[1]
SECOND_WORDS = 1000  # of the block whose length is asked for
TRIANGLES = 3


def block_length(device: Device) -> tuple[bool, str]:
    """Whether `.length()` is the same in every lane behind a loop that lanes leave at different times."""
    _, second, seen = _drawn(device, "screen/triangle.vert", "probe/block_length.frag",
                             (8 * PIXELS + 5, SECOND_WORDS, PIXELS), columns=SIZE[0], pixels=PIXELS)
    wrong, missed = int((seen != SECOND_WORDS).sum()), int((second != 2).sum())
    return wrong == missed == 0, (f"{wrong} of {len(seen)} invocations see another length, {missed} of {len(second)} "
                                  "words are skipped; no method asks for it")


def primitive_numbers(device: Device) -> tuple[bool, str]:
    """Whether a fragment shader sees the number of its triangle beside an input of the vertex shader."""
    seen, = _drawn(device, "probe/numbered.vert", "probe/primitive_number.frag", (TRIANGLES + 1,), 3 * TRIANGLES,
                   triangles=TRIANGLES, columns=SIZE[0], rows=SIZE[1])
    right = int(seen[:TRIANGLES].clip(max=PIXELS).sum())
    return seen.tolist() == [PIXELS] * TRIANGLES + [0], (
        f"{right} of {TRIANGLES * PIXELS} fragments see it and an input; no method asks for it, the shader that "
        "records fragments does")


def _drawn(device: Device, vertex: str, fragment: str, lengths: Sequence[int], vertices: int = 3,
           **uniforms: int) -> list[np.ndarray]:
    """The words of storage blocks of these lengths, from binding 0 on, which are 0 before triangles are drawn."""
    ctx, array = device.ctx, None
    program = ctx.program(**{name: f"{glsl.prelude.VERSION}\n{glsl.includes.read(path)}" for name, path
                             in (("vertex_shader", vertex), ("fragment_shader", fragment))})
    for name, value in uniforms.items():
        program[name] = value
    buffers, texture = [ctx.buffer(bytes(4 * length)) for length in lengths], Texture(device.gl, "rgba8", SIZE)
    framebuffer = Framebuffer(device.gl, [texture])
    try:
        for binding, buffer in enumerate(buffers):
            buffer.bind_to_storage_buffer(binding)
        framebuffer.use(colour=True, depth=False)
        array = ctx.vertex_array(program, [])
        array.render(mode=rawgl.TRIANGLES, vertices=vertices)
        device.gl.glMemoryBarrier(rawgl.BARRIERS["buffer_update"])
        return [np.frombuffer(buffer.read(), dtype=np.uint32) for buffer in buffers]
    finally:
        for made in (array, framebuffer, texture, *buffers, program):
            if made is not None:
                made.release()
