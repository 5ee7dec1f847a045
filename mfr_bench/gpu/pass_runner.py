"""Draws one pass: its program, its fixed-function state, its part of the screen."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import cached_property, partial
from typing import Protocol

from ..glsl import StageSource, split_ref, stages
from ..glsl.bindings import length_name, texel_bindings
from ..methods.shared.bands import Rectangle
from ..methods.spec import (
    DISPATCH_OFFSET,
    IMAGE,
    LISTED,
    TILE_COMMAND,
    TILE_LIST,
    Fitted,
    Pass,
    SceneStats,
    State,
    Variant,
    evaluate,
)
from . import rawgl
from .allocation import Allocation
from .context import Device
from .plan import PassPlan
from .rawgl import RawGL
from .scene_buffer import SceneBuffer
from .targets import BareFramebuffer, Canvas, Framebuffer, Texture
from .uniforms import Uniforms

# Blending that leaves what is drawn as it is. A program drawn with any blending is compiled once by llvmpipe, one drawn
# without twice; a pass over the screen takes 1 to 2 ns a pixel more (docs/measurement.md, "Compiling once").
REPLACING = ("add", "one", "zero")
MIXED = ("r32f",)  # formats of which llvmpipe blends what was there in, times zero: findings/blended_by_zero.sh
NETWORK = re.compile(r"^#define NETWORK (?P<fragments>\d+)", re.MULTILINE)  # a sort in registers: takes LLVM longest
LAYERS, SORTED = 16, 8  # of a scene, and fragments of a network, from which on that is about 1 % of a frame at most


class FrameResources(Protocol):
    """The parts of a frame that a pass needs: the device, what is allocated, the scene, and the part of the screen.

    region: left, bottom, width and height in pixels of what bounds the geometry. band: the part of it that a loop over
    bands leaves the pass, or None. flushes_dispatches: whether the driver needs a flush after each dispatch.
    """

    device: Device
    gl: RawGL
    fitted: Fitted
    variant: Variant
    stats: SceneStats
    allocation: Allocation
    scene_buffer: SceneBuffer
    canvas: Canvas
    uniforms: Uniforms
    flushes_dispatches: bool
    band: Rectangle | None

    @property
    def region(self) -> Rectangle: ...


def _around(left: int, bottom: int, columns: int, rows: int, width: int, height: int) -> list[tuple[int, ...]]:
    """The rectangles, left bottom width height, that cover a viewport except for the one within it."""
    top = bottom + rows
    beside = [(0, 0, width, bottom), (0, top, width, height - top), (0, bottom, left, rows),
              (left + columns, bottom, width - left - columns, rows)]
    return [rectangle for rectangle in beside if rectangle[2] > 0 and rectangle[3] > 0]


class PassRunner:
    """One pass, compiled and bound to its frame's resources. `planned` says which it accesses."""

    def __init__(self, frame: FrameResources, step: Pass):
        self.frame, self.step, self.gl = frame, step, frame.gl
        self.planned = PassPlan.of(frame.variant, step)
        self.framebuffers: dict[int, Framebuffer] = {}
        self.program = self.vao = None
        self._times_frames = frame.device.times_frames
        if step.kind != "clear":
            self._made = self._stages()
            self.program = frame.device.program(self._made, f"method {frame.variant.method.id}, pass {step.name}")
        if step.kind in ("geometry", "fullscreen"):
            self.vao = self._vertex_array()
        self._texel_units = [(bound.ref, frame.fitted.reads_pairs(step, bound.ref), bound.index)
                             for bound in texel_bindings(frame.variant, step)]
        self._groups: dict[tuple[int, int], int] = {}  # work groups, by width and height of what they go over
        self.instances = frame.fitted.value(step.instances)
        self.samples = frame.stats.samples if step.kind == "geometry" else 1  # of a pixel, to rasterize into
        self.writes_depth = step.state.depth_write and any(self._texture(r, 0).is_depth for r in step.into)

    def _texture(self, ref: str, iteration: int) -> Texture:
        return self.frame.allocation.texture(ref, iteration)

    def _vertex_array(self):
        if self.step.kind == "geometry":
            return self.frame.scene_buffer.vertex_array(self.program, self.step.opaque_first)
        tiles = [(self.frame.allocation.named(TILE_LIST), "1u", "in_tile")] if self.step.by_tile else []
        return self.frame.device.ctx.vertex_array(self.program, tiles)

    def _stages(self) -> tuple[StageSource, ...]:
        return stages(self.frame.fitted, self.step)

    @cached_property
    def _by_storage(self) -> PassRunner:
        """The pass that reads buffers as they lie, where they are too large for textures."""
        return PassRunner(self.frame, replace(self.step, texels=()))

    @cached_property
    def takes_box(self) -> bool:
        """Whether a shader reads the uniform block `Box`."""
        return self.program is not None and "Box" in self.program

    @cached_property
    def takes_iteration(self) -> bool:
        return self.program is not None and "iteration" in self.program

    @cached_property
    def _lengths(self) -> list[tuple[str, str, int]]:
        """The uniforms that hold lengths of buffers: name, ref of the buffer, bytes of an element."""
        declared = {b.name: b for b in self.frame.variant.buffers}
        sized = [(length_name(b.name), b.ref, self.frame.fitted.element_bytes(declared[split_ref(b.ref)[0]]))
                 for b in self.planned.buffers]
        return [entry for entry in sized if self.program is not None and entry[0] in self.program]

    @cached_property
    def clips_from_zero(self) -> bool:
        """Whether the vertex shader writes depths from 0 to 1; sets its uniform once."""
        if "clips_from_zero" not in self.program:
            return False
        self.program["clips_from_zero"] = bool(self.gl.glClipControl)
        return bool(self.gl.glClipControl)

    def _framebuffer(self, iteration: int) -> Framebuffer | BareFramebuffer:
        """The pass's own, or for a pass that only writes buffers the canvas, masked, or one without attachments."""
        if not self.step.into:
            return self.frame.canvas.framebuffer if self.samples == 1 else self.frame.canvas.bare(self.samples)
        if self.step.into == (IMAGE,):
            return self.frame.canvas.drawn_in(self.samples)
        parity = iteration % 2
        if parity not in self.framebuffers:
            self.framebuffers[parity] = Framebuffer(self.gl, [self._texture(r, iteration) for r in self.step.into])
        return self.framebuffers[parity]

    def run(self, iteration: int) -> None:
        texels = [(self.frame.allocation.texels(ref, pairs), unit) for ref, pairs, unit in self._texel_units]
        if any(texture is None for texture, _ in texels):
            self._by_storage.run(iteration)
            return
        self._bind(iteration)
        for texture, unit in texels:
            texture.bind(unit)
        if self.step.kind == "compute":
            self._dispatch(iteration)
            return
        self._begin(self._framebuffer(iteration), iteration)
        if self.step.kind == "clear":
            self._zero(iteration)
            return
        for call in self._state_calls:
            call()
        self.gl.clip_depths_from_zero(self.clips_from_zero)
        if self.step.kind == "fullscreen":
            self._draw_screen()
        elif len(self.frame.scene_buffer.scene):
            self._within(self._corner if self.step.corner else self._band, self._draw_geometry)
        if self.samples > 1 and self.step.into:
            self.frame.canvas.resolve(self.samples)

    def _begin(self, framebuffer: Framebuffer | BareFramebuffer, iteration: int) -> None:
        """Make the framebuffer the draw target, clear what the pass clears, and then mask what it keeps."""
        framebuffer.use(colour=bool(self.step.into), depth=self.writes_depth)
        for ref, values in self.step.clears.items():
            sampled = self.samples > 1  # what is drawn into then has a texture of its own, of which the image is made
            self._clear(framebuffer, framebuffer.textures[0] if sampled else self._texture(ref, iteration), values)
        for ref in self.step.keeps:
            framebuffer.keep(self._texture(ref, iteration))

    def _clear(self, framebuffer: Framebuffer, texture: Texture, values: tuple[float, ...]) -> None:
        beside = self.step.region and self.step.kind == "clear"
        for rectangle in _around(*self.frame.region, *framebuffer.size) if beside else (self._extent,):
            self._within(rectangle, lambda: framebuffer.clear(texture, values))

    @property
    def _band(self) -> Rectangle | None:
        """The part of the screen that a loop over bands leaves the pass."""
        return self.frame.band if self.step.region else None

    @property
    def _corner(self) -> Rectangle:
        """The first pixel of what bounds the geometry."""
        return (*self.frame.region[:2], 1, 1)

    @property
    def _extent(self) -> Rectangle | None:
        """The part of the screen that the pass clears, and goes over where it is a full-screen one."""
        return self._band or (self.frame.region if self.step.region else None)

    def _within(self, rectangle: Rectangle | None, draw: Callable[[], None]) -> None:
        """Draw or clear only the rectangle; None: the whole viewport."""
        if rectangle:
            self.gl.glEnable(rawgl.SCISSOR_TEST)
            self.gl.glScissor(*rectangle)
        draw()
        if rectangle:
            self.gl.glDisable(rawgl.SCISSOR_TEST)

    def _commands(self, name: str):
        """A buffer of indirect commands, once what shaders have written there and to the list is in place."""
        self.gl.glMemoryBarrier(rawgl.BARRIERS["indirect"])
        return self.frame.allocation.named(name)

    def _draw_screen(self) -> None:
        self._within(self._extent, self._draw_tiles if self.step.by_tile else self._draw_triangle)

    def _draw_triangle(self) -> None:
        """Draw a triangle over the whole viewport."""
        if self.step.command:
            commands = self._commands(self.step.command)
            self.vao.render_indirect(commands, mode=rawgl.TRIANGLES, count=1, first=self.step.defines["CLASS"])
        else:
            self.vao.render(mode=rawgl.TRIANGLES, vertices=3, instances=self.instances)

    def _draw_geometry(self) -> None:
        if self.step.opaque_first:
            self.frame.scene_buffer.draw_part(self.vao, opaque=True)
            self.gl.glDepthMask(False)
            self.frame.scene_buffer.draw_part(self.vao, opaque=False)
            return
        self.frame.scene_buffer.draw(self.vao, self._commands(self.step.command) if self.step.command else None)

    def _draw_tiles(self) -> None:
        """A point over each listed tile, in a viewport of whole tiles: points whose middle is outside are clipped."""
        width, height = self.frame.stats.W, self.frame.stats.H
        self.gl.glViewport(0, 0, width + -width % LISTED, height + -height % LISTED)
        self.vao.render_indirect(self._commands(TILE_COMMAND), mode=rawgl.POINTS, count=1)

    def _zero(self, iteration: int) -> None:
        """Clear the buffers that a pass of kind `clear` writes, by the driver."""
        if self.planned.buffers:
            self.gl.glMemoryBarrier(rawgl.BARRIERS["buffer_update"])
        for binding in self.planned.buffers:
            buffer = self.frame.allocation.buffer(binding.ref, iteration)
            self.gl.zero(buffer.glo, buffer.size)

    def _bind(self, iteration: int) -> None:
        for binding in self.planned.buffers:
            buffer = self.frame.allocation.buffer(binding.ref, iteration)
            if binding.atomic:
                self.gl.glBindBufferBase(rawgl.ATOMIC_COUNTER_BUFFER, binding.index, buffer.glo)
            else:
                buffer.bind_to_storage_buffer(binding.index)
        for binding in self.planned.textures:
            self._texture(binding.ref, iteration).bind(binding.index)
        if self.takes_box:
            self.frame.uniforms.bind_box()
        if self.takes_iteration:
            self.program["iteration"] = iteration
        for name, ref, element_bytes in self._lengths:
            self.program[name] = self.frame.allocation.buffer(ref, iteration).size // element_bytes

    def _dispatch(self, iteration: int) -> None:
        """Images are published at once: what comes next may be a draw, a fetch or a read-back.

        A flush follows where the driver needs one before the next draw.
        """
        for unit, ref in enumerate(self.step.into):
            self._texture(ref, iteration).bind_image(unit)
        if self.step.into:
            self.gl.glMemoryBarrier(rawgl.BARRIERS["image"])
        if self.step.by_tile:
            self.program.run_indirect(self._commands(TILE_COMMAND), DISPATCH_OFFSET)
        else:
            self.program.run(self._group_count())
        if self.step.into:
            self.gl.glMemoryBarrier(rawgl.BARRIERS["image"])
        if self.frame.flushes_dispatches:
            self.gl.glFlush()

    def _group_count(self) -> int:
        """Work groups of a dispatch over the viewport, or over the region as if it were one."""
        stats = self.frame.stats
        extent = self.frame.region[2:] if self.step.region else (stats.W, stats.H)
        if extent not in self._groups:
            within = replace(stats, W=max(1, extent[0]), H=max(1, extent[1]))
            self._groups[extent] = int(evaluate(self.step.groups, within, self.frame.variant.scope))
        return self._groups[extent]

    @cached_property
    def _state_calls(self) -> tuple[Callable[[], None], ...]:
        """The GL calls that set the pass's fixed-function state."""
        return tuple(self._state(self.step.state))

    def _state(self, state: State) -> Iterator[Callable[[], None]]:
        yield from self._blending(state)
        yield self._switch(rawgl.DEPTH_TEST, state.depth_test)
        if state.depth_test:
            yield partial(self.gl.glDepthFunc, rawgl.DEPTH_FUNCTIONS[state.depth_test])
        yield self._switch(rawgl.STENCIL_TEST, state.stencil)
        if state.stencil:
            test = rawgl.STENCIL_TESTS[state.stencil.test]
            yield partial(self.gl.glStencilFunc, test, state.stencil.reference, 0xFF)
            yield partial(self.gl.glStencilOp, *[rawgl.STENCIL_UPDATES[state.stencil.update]] * 3)
        yield self._switch(rawgl.MULTISAMPLE, state.multisample)

    def _blending(self, state: State) -> Iterator[Callable[[], None]]:
        """Set the blending, one for all output locations or one for each.

        Where nothing is blended, a pass over the screen may blend so that what it draws stands alone: see `REPLACING`.
        """
        hides = (self.step.kind == "fullscreen" and not (state.blends or state.depth_test or state.stencil)
                 and not any(self._texture(ref, 0).format in MIXED for ref in self.step.into))
        blend = state.blend or (REPLACING if hides and self._compiles_once else None)
        yield self._switch(rawgl.BLEND, blend or state.blends)
        if blend:
            equation, source, destination = blend
            factors = (source, destination, *(state.blend_alpha or (source, destination)))
            yield partial(self.gl.glBlendEquation, rawgl.EQUATIONS[equation])
            yield partial(self.gl.glBlendFuncSeparate, *(rawgl.FACTORS[factor] for factor in factors))
        for location, (equation, source, destination) in enumerate(state.blends):
            yield partial(self.gl.glBlendEquationi, location, rawgl.EQUATIONS[equation])
            yield partial(self.gl.glBlendFunci, location, rawgl.FACTORS[source], rawgl.FACTORS[destination])

    @property
    def _compiles_once(self) -> bool:
        """Whether to blend where it spares a compilation, and costs the time of no frame more than it may."""
        if not self.frame.device.compiles_opaque_twice:
            return False
        if not self._times_frames:
            return True
        network = NETWORK.search(self._made[-1].text)
        return network is not None and self.frame.stats.n >= LAYERS and int(network["fragments"]) >= SORTED

    def _switch(self, capability: int, on: object) -> Callable[[], None]:
        return partial(self.gl.glEnable if on else self.gl.glDisable, capability)

    def release(self) -> None:
        """Free what the pass alone has, and let go of its program, which it and its frame, a cycle, would keep."""
        for framebuffer in self.framebuffers.values():
            framebuffer.release()
        if self.vao:
            self.vao.release()
        self.program = self.vao = None
        if "_by_storage" in self.__dict__:
            self._by_storage.release()
