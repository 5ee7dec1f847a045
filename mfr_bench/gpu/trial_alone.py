"""Trials whose shaders stand by themselves, without the prelude of methods: other text around them hides the fault."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from .. import glsl
from . import rawgl
from .context import Device
from .targets import BufferTexture, Framebuffer, Texture

SIZE = (24, 20)  # pixels
PIXELS = SIZE[0] * SIZE[1]
SECOND_WORDS = 1000  # of the block whose length is asked for
TRIANGLES = 3
TURNS = 7  # of a loop at most
HELD = 128  # elements of a local array


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


def stored_ahead(device: Device) -> tuple[bool, str]:
    """Whether a loop stores elements of a local array in their place, where it compares the next place before."""
    words = np.arange(HELD, 0, -1, dtype=np.uint32)
    _, seen = _drawn(device, "screen/triangle.vert", "probe/stored_ahead.frag",
                     [words, np.zeros(PIXELS, dtype=np.uint32)], columns=SIZE[0], count=HELD)
    return bool((seen == HELD).all()), (f"{seen.min()} of {HELD} elements are in their place; no method compares the "
                                        "next place before it stores")


def texture_formats(device: Device) -> tuple[bool, str]:
    """Whether a draw reads a texture of a buffer in its own format, behind one that reads the buffer in another format.

    Element 1 is word 5 of the first texture, with four words a texel, and word 3 of the second, with two.
    """
    words, counts = np.arange(1, 9, dtype=np.uint32), np.zeros(9, dtype=np.uint32)
    _, seen = _drawn(device, "screen/triangle.vert", "probe/texture_format.frag", [words, counts], textures=(4, 2))
    return bool(seen[3] == seen[5] == PIXELS), (
        f"{seen[3]} of {PIXELS} pixels see its element, {seen[5]} that of the other; no frame reads one buffer in two")


def _drawn(device: Device, vertex: str, fragment: str, blocks: Sequence[np.ndarray], vertices: int = 3,
           textures: Sequence[int] = (), **uniforms: int) -> list[np.ndarray]:
    """The words of storage blocks after triangles are drawn, uint32; blocks: the words before, from binding 0 on.

    textures: they are drawn once for each, with a texture of the first block's memory at unit 0, of so many words a
    texel.
    """
    ctx, array = device.ctx, None
    program = ctx.program(**{name: f"{glsl.prelude.VERSION}\n{glsl.includes.read(path)}" for name, path
                             in (("vertex_shader", vertex), ("fragment_shader", fragment))})
    for name, value in uniforms.items():
        program[name] = value
    buffers, texture = [ctx.buffer(block.tobytes()) for block in blocks], Texture(device.gl, "rgba8", SIZE)
    framebuffer = Framebuffer(device.gl, [texture])
    views = [BufferTexture(device.gl, buffers[0].glo, words) for words in textures]
    try:
        for binding, buffer in enumerate(buffers):
            buffer.bind_to_storage_buffer(binding)
        framebuffer.use(colour=True, depth=False)
        array = ctx.vertex_array(program, [])
        for view in views or [None]:
            if view is not None:
                view.bind(0)
            array.render(mode=rawgl.TRIANGLES, vertices=vertices)
        device.gl.glMemoryBarrier(rawgl.BARRIERS["buffer_update"])
        return [np.frombuffer(buffer.read(), dtype=np.uint32) for buffer in buffers]
    finally:
        for made in (array, framebuffer, texture, *views, *buffers, program):
            if made is not None:
                made.release()
