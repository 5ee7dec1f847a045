"""Gives every texture unit the same sampler, so that no program is compiled again for the one that is left there.

Programs of llvmpipe depend on the samplers at their units. For a texture of a buffer, Mesa leaves there what an earlier
program has used, or none: after a method that reads an image of its own, each program that reads buffers through
textures would be compiled a second time, at its next frame.
"""

from __future__ import annotations

import moderngl

UNITS = 16  # that GL has at least
READ = 4  # samplers of one program that leave theirs behind, at most of those here
VERTEX = """#version 430 core
void main() { gl_Position = vec4(vec2(gl_VertexID & 1, gl_VertexID >> 1) * 4.0 - 1.0, 0.0, 1.0); }
"""
FRAGMENT = f"""#version 430 core
layout(binding = 0) uniform sampler2D read[{READ}];
out vec4 colour;
void main() {{ colour = {" + ".join(f"texelFetch(read[{i}], ivec2(0), 0)" for i in range(READ))}; }}
"""


class Samplers:
    """One sampler without filtering at each unit, and a draw that leaves it behind at the first of them."""

    def __init__(self, ctx: moderngl.Context):
        self._sampler = ctx.sampler(filter=(moderngl.NEAREST, moderngl.NEAREST))
        for unit in range(UNITS):
            self._sampler.use(unit)
        self._texture = ctx.texture((1, 1), 4, dtype="f4")
        self._framebuffer = ctx.framebuffer([ctx.texture((1, 1), 4, dtype="f4")])  # without depths, whose test matters
        self._ctx, self._array = ctx, ctx.vertex_array(ctx.program(vertex_shader=VERTEX, fragment_shader=FRAGMENT), [])
        self.settle()

    def settle(self) -> None:
        """Draw one pixel with a program that reads plain textures: one that read several samples leaves another.

        It blends, so that the program is compiled once and for no other blending that the pass before has left.
        """
        self._framebuffer.use()
        self._ctx.enable(moderngl.BLEND)
        self._ctx.blend_equation = moderngl.FUNC_ADD
        self._ctx.blend_func = moderngl.ONE, moderngl.ZERO
        for unit in range(READ):
            self._texture.use(unit)
        self._array.render(moderngl.TRIANGLES, vertices=3)
        self._ctx.disable(moderngl.BLEND)
