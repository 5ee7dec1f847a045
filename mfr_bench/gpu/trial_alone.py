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
TURNS = 7  # of a loop at most


def block_length(device: Device) -> tuple[bool, str]:
    """Whether `.length()` is the same in every lane behind a loop that lanes leave at different times."""
    blocks = [np.zeros(length, dtype=np.uint32) for length in (8 * PIXELS + 5, SECOND_WORDS, PIXELS)]
    _, second, seen = _drawn(device, "screen/triangle.vert", "probe/block_length.frag", blocks, columns=SIZE[0],
                             pixels=PIXELS)
    wrong, missed = int((seen != SECOND_WORDS).sum()), int((second != 2).sum())
    return wrong == missed == 0, (f"{wrong} of {len(seen)} invocations see another length, {missed} of {len(second)} "
                                  "words are skipped; no method asks for it")


def primitive_numbers(device: Device) -> tuple[bool, str]:
    """Whether a fragment shader sees the number of its triangle beside an input of the vertex shader."""
    seen, = _drawn(device, "probe/numbered.vert", "probe/primitive_number.frag",
                   [np.zeros(TRIANGLES + 1, dtype=np.uint32)], 3 * TRIANGLES, triangles=TRIANGLES, columns=SIZE[0],
                   rows=SIZE[1])
    right = int(seen[:TRIANGLES].clip(max=PIXELS).sum())
    return seen.tolist() == [PIXELS] * TRIANGLES + [0], (
        f"{right} of {TRIANGLES * PIXELS} fragments see it and an input; no method asks for it, the shader that "
        "records fragments does")


def behind_loop(device: Device) -> tuple[bool, str]:
    """Whether elements that a loop reads are the same behind it, in lanes that left it before others."""
    words = np.arange(1, PIXELS + TURNS + 1, dtype=np.uint32)
    _, seen = _drawn(device, "screen/triangle.vert", "probe/behind_loop.frag",
                     [words, np.zeros(3 * PIXELS, dtype=np.uint32)], columns=SIZE[0])
    own, turns = words[:PIXELS], np.arange(PIXELS, dtype=np.uint32) % TURNS + 1
    last = words[own + turns - 1]
    wrong = [int((column != right).sum()) for column, right in
             zip(seen.reshape(-1, 3).T, (turns * (words[own] + last) // 2, own, last), strict=True)]
    return not any(wrong), (f"of {PIXELS} pixels {wrong[0]} have a wrong sum, {wrong[1]} another element of their own, "
                            f"{wrong[2]} another last element")


def _drawn(device: Device, vertex: str, fragment: str, blocks: Sequence[np.ndarray], vertices: int = 3,
           **uniforms: int) -> list[np.ndarray]:
    """The words of storage blocks after triangles are drawn, uint32; blocks: the words before, from binding 0 on."""
    ctx, array = device.ctx, None
    program = ctx.program(**{name: f"{glsl.prelude.VERSION}\n{glsl.includes.read(path)}" for name, path
                             in (("vertex_shader", vertex), ("fragment_shader", fragment))})
    for name, value in uniforms.items():
        program[name] = value
    buffers, texture = [ctx.buffer(block.tobytes()) for block in blocks], Texture(device.gl, "rgba8", SIZE)
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
