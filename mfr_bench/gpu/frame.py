"""Runs one variant of a method on one scene: allocates what it declares, draws its passes in order."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import cached_property, partial

import numpy as np

from ..errors import CapacityError
from ..glsl import (
    COLOURS_BINDING,
    DIAGNOSTICS,
    DIAGNOSTICS_BINDING,
    EDGE_FIELDS,
    FRAME_BINDING,
    FRAME_FIELDS,
    REGION_FIELDS,
    Binding,
    Source,
    buffer_bindings,
    split_ref,
    stages,
    texture_bindings,
)
from ..glsl.counters import WORK
from ..methods.shared.bands import Rectangle, bands
from ..methods.spec import (
    DISPATCH_OFFSET,
    IMAGE,
    LISTED,
    TILE_COMMAND,
    TILE_LIST,
    Counted,
    Grown,
    Known,
    Loop,
    Pass,
    Plan,
    Planned,
    SceneStats,
    State,
    Target,
    Variant,
    evaluate,
)
from ..oracle import twochannel
from ..scene import Geometry
from . import rawgl
from .device import Device
from .targets import Framebuffer, Texture

Mark = Callable[[str], None]

# By the geometry of a scene: each attribute, its moderngl format, the padding in its place where a program does not
# use it, and its field of the packed primitive.
COLOUR = ("in_rgba", "4f1", "4x", ("rgba", "u1", 4))
LAYOUTS = {
    "quad": (("in_rect", "4i", "16x", ("rect", "<i4", 4)), ("in_depth", "1f", "4x", ("depth", "<f4")), COLOUR),
    "strip": (*((f"in_corner{i}", "4f", "16x", (f"corner{i}", "<f4", 4)) for i in range(4)), COLOUR),
}


class SceneBuffer:
    """A scene's primitives in device memory. Uploads stay outside every timed region."""

    def __init__(self, device: Device, scene: Geometry):
        self.device, self.scene = device, scene
        self.buffer = device.ctx.buffer(_packed(scene))
        self._two_channel: tuple | None = None  # of those who store colours so: codes of the primitives, base colours

    def attributes(self, program) -> list[tuple]:
        """The per-instance attributes that the program uses, as moderngl's vertex_array takes them."""
        layout = LAYOUTS[self.scene.geometry]
        used = [name for name, *_ in layout if name in program]
        formats = " ".join(form if name in used else padding for name, form, padding, _ in layout)
        codes = [(self.two_channel[0], "4f1 /i", "in_code")] if "in_code" in program else []
        return [(self.buffer, f"{formats} /i", *used), *codes]

    @property
    def two_channel(self) -> tuple:
        """Buffers of the primitives' codes and of the base colours."""
        if self._two_channel is None:
            self._two_channel = tuple(map(self.device.ctx.buffer, _encoded(self.scene)))
        return self._two_channel

    def replace(self, scene: Geometry) -> None:
        """The next frame of an animation."""
        self.scene = scene
        _write(self.buffer, _packed(scene))
        for buffer, data in zip(self._two_channel or (), _encoded(scene) if self._two_channel else (), strict=True):
            _write(buffer, data)

    def release(self) -> None:
        for buffer in (self.buffer, *(self._two_channel or ())):
            buffer.release()


def _write(buffer, data: bytes) -> None:
    if len(data) > buffer.size:
        buffer.orphan(len(data))
    buffer.write(data)


def _encoded(scene: Geometry) -> tuple[bytes, bytes]:
    """Codes of the primitives, and the two base colours as vec4."""
    encoding, stored = twochannel.words(scene.rgba)
    return stored.tobytes() or bytes(4), np.float32([[*encoding.a, 0], [*encoding.b, 0]]).tobytes()


def _packed(scene: Geometry) -> bytes:
    """Primitives one after the other; room for one where there is none."""
    primitives = np.zeros(len(scene), dtype=[field for *_, field in LAYOUTS[scene.geometry]])
    arrays = scene.arrays()
    if "position" in arrays:
        arrays |= {f"corner{i}": scene.position[:, i] for i in range(4)}
    for name in primitives.dtype.names:
        primitives[name] = arrays[name]
    return primitives.tobytes() or bytes(primitives.itemsize)


class Canvas:
    """The image that every method of one viewport size resolves into: RGBA32F, premultiplied."""

    def __init__(self, device: Device, size: tuple[int, int]):
        self.texture = Texture(device.gl, "rgba32f", size)
        self.framebuffer = Framebuffer(device.gl, [self.texture])

    def release(self) -> None:
        self.framebuffer.release()
        self.texture.release()


class Frame:
    """One variant, ready to draw.

    `draw` runs all passes; it returns False where a growing buffer was too small, and has then doubled it.
    Raises ShaderError for GLSL that does not compile, MemoryError where the device has no room.
    """

    def __init__(self, device: Device, variant: Variant, stats: SceneStats, scene_buffer: SceneBuffer, canvas: Canvas):
        self.device, self.gl, self.variant, self.stats = device, device.gl, variant, stats
        self.scene_buffer, self.canvas = scene_buffer, canvas
        self.geometry_passes = 0  # of the last frame
        self._capacity = variant.start_capacity(stats)
        self._room = self._capacity  # elements allocated; never less than the capacity in use
        self._counted = 0  # samples that the latest counting pass let through
        self.chosen_k = 0  # of a method whose k the host decides
        self._shown = scene_buffer.scene
        self._drawn: Geometry | None = None  # the scene of the latest frame, while all that it left is in place
        self._plan: Plan | None = None  # of the latest frame, of a planned method
        self._next: tuple[Geometry, int | None, Plan] | None = None  # the newest plan, and what it was made from
        self._due: tuple[Pass | Loop, ...] = ()  # what a frame runs while it is as `_due_when` says
        self._due_when: tuple[Plan | None, bool, bool] | None = None  # plan, still, probing
        self._budgeted = variant.room(stats)  # most elements of a planned method with a budget
        self.band: Rectangle | None = None  # of the loop over bands that is running
        self._fragments: int | None = None  # of the latest frame of a planned method, once it is known
        self._uniforms = device.ctx.buffer(reserve=4 * len(FRAME_FIELDS + REGION_FIELDS + EDGE_FIELDS))
        self._diagnostics = device.ctx.buffer(bytes(4 * len(DIAGNOSTICS) + 8 * len(WORK)))
        self._query, self._tally = device.gl.generate("Queries"), device.gl.generate("Queries")
        self._tallied = False  # the tally has been taken and not been read
        self._tallied_scene: Geometry | None = None  # whose fragments are known or tallied
        self._probing = False
        self._textures = {t.name: [self._texture(t) for _ in range(t.copies)] for t in variant.targets}
        self._buffers: dict[str, list] = {}
        self._allocate()
        self._passes = {id(step): PassRunner(self, step) for step in variant.passes if self._compiles_now(step)}
        self._write_uniforms()
        device.check(f"{variant.method.id}: allocation")

    def _compiles_now(self, step: Pass) -> bool:
        """What a planned method may need is compiled when it is needed."""
        return self.variant.runs(step, self.stats) and not step.probes and step.runs_in is None

    def _texture(self, target: Target) -> Texture:
        samples, layers = self.variant.samples(target, self.stats), self.variant.layer_count(target, self.stats)
        return Texture(self.gl, target.format, (self.stats.W, self.stats.H),
                       samples if target.samples else 0, layers if target.layers else 0)

    def _allocate(self) -> None:
        """Make every buffer that is missing or too small for the room."""
        for buffer in self.variant.buffers:
            size = self.variant.block_bytes(buffer, self.stats, self._room)
            held = self._buffers.get(buffer.name, [])
            if held and held[0].size >= size:
                continue
            for old in held:
                old.release()
            self._buffers[buffer.name] = [self.device.ctx.buffer(reserve=size) for _ in range(buffer.copies)]
            self._drawn = None

    def _write_uniforms(self) -> None:
        scene = self._shown
        values = {"width": self.stats.W, "height": self.stats.H, "pixels": self.stats.P, "capacity": self._capacity,
                  "seed": scene.seed, "keep_threshold": min(scene.keep_threshold, 2**32 - 1),
                  "chosen_k": self.chosen_k}
        left, bottom, columns, rows = self.region
        values |= {"region_first": bottom * columns + left, "region_columns": columns, "region_pixels": columns * rows,
                   "region_left": left, "region_bottom": bottom, "region_right": left + columns,
                   "region_top": bottom + rows}
        words = [values[name] for name in FRAME_FIELDS + REGION_FIELDS + EDGE_FIELDS]
        self._uniforms.write(np.array(words, dtype=np.uint32).tobytes())

    @property
    def region(self) -> tuple[int, int, int, int]:
        """Left, bottom, width and height in pixels of what bounds the geometry on the screen."""
        return self._shown.bounds

    @property
    def memory_bytes(self) -> dict[str, int]:
        """Bytes of each allocated object, by the name of its declaration."""
        buffers = {name: sum(b.size for b in copies) for name, copies in self._buffers.items()}
        textures = {name: sum(t.bytes for t in copies) for name, copies in self._textures.items()}
        return buffers | textures

    def show(self, scene: Geometry) -> None:
        """Take the scene that `scene_buffer` now holds: its seed reaches the shaders."""
        if scene is not self._shown:
            self._shown, self._drawn = scene, None
            self._write_uniforms()

    @property
    def still(self) -> bool:
        """Whether the frame before the next, or before the one that is drawn, was of the same scene."""
        return self._drawn is self.scene_buffer.scene

    def draw(self, mark: Mark | None = None) -> bool:
        """Run every pass in order; `mark` is called with the pass's name after each."""
        self.geometry_passes = 0
        self._unpublished: set[str] = set()
        self._touched: set[str] = set(self._buffers)  # by the frame before
        if isinstance(self.variant.method.capacity, Planned):
            self._begin(self._next_plan())
        self._uniforms.bind_to_uniform_block(FRAME_BINDING)
        self._diagnostics.bind_to_storage_buffer(DIAGNOSTICS_BINDING)
        if self.variant.two_channel:
            self.scene_buffer.two_channel[1].bind_to_uniform_block(COLOURS_BINDING)
        iteration = 0
        for step in self._steps_due():
            if isinstance(step, Loop):
                iteration = self._loop(step, mark)
            else:
                self._run(step, iteration, mark)
        self._drawn = self.scene_buffer.scene
        return self._fits()

    def _steps_due(self) -> tuple[Pass | Loop, ...]:
        """The steps that a frame runs, looked up anew when its plan or state is another than the last one's."""
        when = (self._plan, self.still, self._probing)
        if when != self._due_when:
            self._due, self._due_when = tuple(self._only_due(self.variant.steps)), when
        return self._due

    def _only_due(self, steps: Sequence[Pass | Loop]) -> Iterator[Pass | Loop]:
        for step in steps:
            if isinstance(step, Loop):
                yield replace(step, passes=tuple(self._only_due(step.passes)), times=step.times if step.passes else "0")
            elif self.runs(step) and (self._probing or not step.probes):
                yield step

    def _next_plan(self) -> Plan:
        """By what the host knows now: its geometry, and the fragments of the frame before."""
        if self._tallied:
            self._fragments, self._tallied = self.gl.query_result(self._tally), False
        if self._next and self._next[0] is self._shown and self._next[1] == self._fragments:
            return self._next[2]
        *_, columns, rows = self.region
        shown = replace(self.stats, primitives=len(self._shown), area=columns * rows, layers=self._shown.layers,
                        reach=self._shown.reach)
        known = Known.of(shown, self._fragments, self._budgeted)
        self._next = self._shown, self._fragments, self.variant.method.capacity.rule(known, self.variant.scope)
        return self._next[2]

    def _begin(self, plan: Plan) -> None:
        if plan != self._plan:
            self._plan = plan
            self._write_uniforms()
        if plan.capacity is not None:
            self._set_capacity(plan.capacity)

    def _loop(self, loop: Loop, mark: Mark | None) -> int:
        """Iterations begun, or that another frame began for this one; `.previous` then names what the last wrote."""
        if loop.bands:
            return self._loop_bands(loop, mark)
        times = int(evaluate(loop.times, self.stats, self.variant.scope))
        for iteration in range(times):
            for step in loop.passes:
                counted = self._run(step, iteration, mark)
                if loop.until_empty and step.counts and counted == 0:
                    return iteration + 1
        return times

    def _loop_bands(self, loop: Loop, mark: Mark | None) -> int:
        """The passes once for each band, of which there are any where the plan says so."""
        if not (loop.passes and self._plan and self._plan.banded):
            return 0
        sums = self.words(loop.bands).reshape(self.stats.H, -1)
        try:
            for band in bands(sums, self.region, self._budgeted):
                self.band = band
                for step in loop.passes:
                    self._run(step, 0, mark)
        finally:
            self.band = None
        return 0

    def _run(self, step: Pass, iteration: int, mark: Mark | None) -> int | None:
        runner = self._runner(step)
        if runner is None:
            return None
        self._publish(runner)
        tallies = self._begin_tally(step)
        if step.counts:
            self.gl.glBeginQuery(rawgl.SAMPLES_PASSED, self._query)
        runner.run(iteration)
        self.geometry_passes += step.kind == "geometry"
        counted = None
        if tallies:
            self._end_tally()
        if step.counts:
            self.gl.glEndQuery(rawgl.SAMPLES_PASSED)
            counted = self._counted = self.gl.query_result(self._query)
            if isinstance(self.variant.method.capacity, (Counted, Planned)):
                self._set_capacity(counted if self._budgeted is None else max(0, min(counted, self._budgeted)))
            self._fragments, self._tallied_scene = counted, self._shown
        if step.totals:
            self._set_capacity(int(self.words(step.totals).sum()))
        if step.decides:
            self._decide()
        if step.probes:  # its counter is no buffer that later passes wait for; without, llvmpipe drops covered tiles
            self.gl.glMemoryBarrier(rawgl.BARRIERS["storage"])
        if mark:
            mark(step.name)
        return counted

    def _begin_tally(self, step: Pass) -> bool:
        """Count what passes, to be read before the next frame, where it is not known of the scene that is shown."""
        tallies = step.tallies and self._tallied_scene is not self._shown
        if tallies:
            self.gl.glBeginQuery(rawgl.SAMPLES_PASSED, self._tally)
        return tallies

    def _end_tally(self) -> None:
        self.gl.glEndQuery(rawgl.SAMPLES_PASSED)
        self._tallied, self._tallied_scene = True, self._shown

    def runs(self, step: Pass) -> bool:
        """Whether the pass is part of the latest frame, or of every one of this scene."""
        planned = step.runs_in is None or (self._plan is not None and step.runs_in(self._plan))
        due = step.still is None or step.still == self.still
        return planned and due and self.variant.runs(step, self.stats)

    def _runner(self, step: Pass) -> PassRunner | None:
        """Of a pass that is due; None where another one does its work."""
        if step.runs_in and id(step) not in self._passes:
            self._passes[id(step)] = PassRunner(self, step)
        return self._passes.get(id(step))

    def _publish(self, runner: PassRunner) -> None:
        """A barrier where the pass touches buffers that an earlier pass wrote, or writes what one still reads."""
        if self._unpublished & runner.touched or self._touched & runner.written:
            self.gl.glMemoryBarrier(rawgl.BARRIERS["storage"])
            self._unpublished.clear()
            self._touched.clear()
        self._unpublished |= runner.written
        self._touched |= runner.touched

    def _decide(self) -> None:
        """Set k and the capacity for the passes that follow, from what the last one has written."""
        decided = self.variant.method.capacity
        choice = decided.rule(self.words(decided.reads).tolist(), self._counted, self.stats.P, self.variant.scope)
        self.chosen_k = choice.k
        self._set_capacity(choice.capacity)
        self._write_uniforms()

    def _set_capacity(self, elements: int) -> None:
        if elements > self._room:
            self._room = elements
            self._allocate()
        if elements != self._capacity:
            self._capacity = elements
            self._write_uniforms()

    def _fits(self) -> bool:
        grown = self.variant.method.capacity
        if self._plan and self._plan.capacity is None:
            after = self._next_plan()
            return (after.path, after.capacity) == (self._plan.path, self._plan.capacity)
        if not isinstance(grown, Grown):
            return True
        wanted = int(self.words(grown.counter)[0])
        if wanted <= self._capacity:
            return True
        self._grow(2 * self._capacity, wanted)
        return False

    def _grow(self, elements: int, wanted: int) -> None:
        """Room for so many elements. Raises CapacityError where a storage block cannot have it."""
        most = self.device.limits.max_block_bytes
        for buffer in self.variant.buffers:
            if (size := self.variant.block_bytes(buffer, self.stats, elements)) > most:
                raise CapacityError(f"{wanted} fragments do not fit: {buffer.name} would grow to {size} bytes, "
                                 f"a storage block holds {most}")
        self._set_capacity(elements)

    def draw_fitting(self) -> None:
        """Draw until every growing buffer holds the frame, and its plan is that of the next.

        Raises CapacityError where a buffer cannot grow further.
        """
        while not self.draw():
            self.device.check(f"{self.variant.method.id}: growing to {self._capacity} elements")

    def words(self, name: str) -> np.ndarray:
        """uint32 contents of a buffer."""
        self.gl.glMemoryBarrier(rawgl.BARRIERS["buffer_update"])
        return np.frombuffer(self._buffers[name][0].read(), dtype=np.uint32)

    def fill(self, name: str, words: np.ndarray) -> None:
        """Give a buffer uint32 contents."""
        self._buffers[name][0].write(np.ascontiguousarray(words, dtype=np.uint32).tobytes())
        self._drawn = None

    def lost_fragments(self) -> int:
        """Fragments that found no room or never got the lock, since the last call."""
        return self._diagnostic("lost_fragments")

    def probe(self) -> dict[str, int]:
        """Fragments by each counter that the variant's probing passes fill; draws a frame, if there are any."""
        probing = {id(step): step for step in self.variant.passes if step.probes}
        counters = {step.probes for step in probing.values()}
        if not counters:
            return {}
        for name in counters:
            self._diagnostic(name)
        passes, self._probing = self.geometry_passes, True
        self._passes |= {i: PassRunner(self, step) for i, step in probing.items()
                         if i not in self._passes and self.runs(step)}
        self.draw()
        self.geometry_passes, self._probing = passes, False
        return {name: self._diagnostic(name) for name in counters}

    def draw_by(self, runners: Mapping[int, PassRunner]) -> None:
        """Draw a frame in which other runners do the work of its passes, by the identity of the pass."""
        own, self._passes = self._passes, dict(runners)
        try:
            self.draw()
        finally:
            self._passes = own

    def draw_map(self, runners: Mapping[int, PassRunner]) -> np.ndarray:
        """uint32 (H, W): what the runners' programs count for each pixel in one frame, as by `draw_by`."""
        own = self._diagnostics
        self._diagnostics = self.device.ctx.buffer(bytes(4 * (len(DIAGNOSTICS) + self.stats.P)))
        try:
            self.draw_by(runners)
            self.gl.glMemoryBarrier(rawgl.BARRIERS["buffer_update"])
            words = np.frombuffer(self._diagnostics.read(offset=4 * len(DIAGNOSTICS)), dtype=np.uint32)
        finally:
            self._diagnostics.release()
            self._diagnostics = own
        return words.reshape(self.stats.H, self.stats.W)

    def work(self) -> Counter[str]:
        """What counting programs have counted since `reset_work`, by the names of `instrument.WORK`."""
        self.gl.glMemoryBarrier(rawgl.BARRIERS["buffer_update"])
        counted = np.frombuffer(self._diagnostics.read(8 * len(WORK), offset=4 * len(DIAGNOSTICS)), dtype=np.uint32)
        low, high = counted[::2].astype(object), counted[1::2].astype(object)
        return Counter(dict(zip(WORK, low + 2**32 * high, strict=True)))

    def reset_work(self) -> None:
        self._diagnostics.write(bytes(8 * len(WORK)), offset=4 * len(DIAGNOSTICS))

    def _diagnostic(self, name: str) -> int:
        """A counter's value, which starts anew."""
        self.gl.glMemoryBarrier(rawgl.BARRIERS["buffer_update"])
        at = 4 * DIAGNOSTICS.index(name)
        value = int(np.frombuffer(self._diagnostics.read(4, offset=at), dtype=np.uint32)[0])
        self._diagnostics.write(bytes(4), offset=at)
        return value

    def image(self) -> np.ndarray:
        """float32 (H, W, 4), premultiplied, row 0 at the bottom."""
        return self.canvas.framebuffer.read()

    def named(self, name: str):
        """A buffer of one copy."""
        return self._buffers[name][0]

    def buffer(self, binding: Binding, iteration: int):
        copies = self._buffers[split_ref(binding.ref)[0]]
        return copies[_copy(binding.ref, iteration, len(copies))]

    def texture(self, ref: str, iteration: int) -> Texture:
        name = split_ref(ref)[0]
        if name == IMAGE:
            return self.canvas.texture
        copies = self._textures[name]
        return copies[_copy(ref, iteration, len(copies))]

    def release(self) -> None:
        for copies in self._buffers.values():
            for buffer in copies:
                buffer.release()
        for runner in self._passes.values():
            runner.release()
        for copies in self._textures.values():
            for texture in copies:
                texture.release()
        self._uniforms.release()
        self._diagnostics.release()
        for query in (self._query, self._tally):
            self.gl.delete("Queries", query)


def _copy(ref: str, iteration: int, copies: int) -> int:
    """Which copy a ref names: `.current` is iteration i's own, `.previous` the one of the iteration before."""
    return (iteration + (split_ref(ref)[1] == "previous")) % copies


def _around(left: int, bottom: int, columns: int, rows: int, width: int, height: int) -> list[tuple[int, ...]]:
    """The rectangles, left bottom width height, that are left of a viewport beside the one within it."""
    top = bottom + rows
    beside = [(0, 0, width, bottom), (0, top, width, height - top), (0, bottom, left, rows),
              (left + columns, bottom, width - left - columns, rows)]
    return [rectangle for rectangle in beside if rectangle[2] > 0 and rectangle[3] > 0]


class PassRunner:
    """One pass, compiled and bound to its frame's resources."""

    def __init__(self, frame: Frame, step: Pass):
        self.frame, self.step, self.gl = frame, step, frame.gl
        variant, stats = frame.variant, frame.stats
        self.buffers = buffer_bindings(variant, step)
        self.textures = texture_bindings(variant, step)
        self.touched = frozenset(split_ref(b.ref)[0] for b in self.buffers)
        self.touched |= {TILE_LIST, TILE_COMMAND} if step.by_tile else {step.command} if step.command else set()
        self.written = frozenset(split_ref(r)[0] for r in step.writes) & self.touched
        self.framebuffers: dict[int, Framebuffer] = {}
        self.program = self.vao = None
        if step.kind != "clear":
            self.program = frame.device.program(self._stages(), f"method {variant.method.id}, pass {step.name}")
        if step.kind in ("geometry", "fullscreen"):
            self.vao = frame.device.ctx.vertex_array(self.program, self._content())
        self._groups: dict[tuple[int, int], int] = {}  # work groups, by width and height of what they go over
        self.instances = variant.value(step.instances, stats)
        self.writes_depth = step.state.depth_write and any(frame.texture(r, 0).is_depth for r in step.into)

    def _content(self) -> list[tuple]:
        """The attributes of each instance."""
        if self.step.by_tile:
            return [(self.frame.named(TILE_LIST), "1u", "in_tile")]
        return self.frame.scene_buffer.attributes(self.program) if self.step.kind == "geometry" else []

    def _stages(self) -> tuple[Source, ...]:
        return stages(self.frame.variant, self.step, self.frame.stats)

    @cached_property
    def takes_iteration(self) -> bool:
        return self.program is not None and "iteration" in self.program

    @cached_property
    def clips_from_zero(self) -> bool:
        """Whether the vertex shader gives depths as they are; told to it once."""
        if "clips_from_zero" not in self.program:
            return False
        self.program["clips_from_zero"] = bool(self.gl.glClipControl)
        return bool(self.gl.glClipControl)

    def _framebuffer(self, iteration: int) -> Framebuffer:
        """The pass's own, or for a pass that only writes buffers the canvas, masked."""
        if not self.step.into or self.step.into == (IMAGE,):
            return self.frame.canvas.framebuffer
        parity = iteration % 2
        if parity not in self.framebuffers:
            self.framebuffers[parity] = Framebuffer(self.gl, [self.frame.texture(r, iteration) for r in self.step.into])
        return self.framebuffers[parity]

    def run(self, iteration: int) -> None:
        self._bind(iteration)
        if self.step.kind == "compute":
            self._dispatch(iteration)
            return
        framebuffer = self._framebuffer(iteration)
        framebuffer.use(colour=bool(self.step.into), depth=self.writes_depth)
        for ref, values in self.step.clears.items():
            self._clear(framebuffer, self.frame.texture(ref, iteration), values)
        if self.step.kind == "clear":
            self._zero(iteration)
            return
        for call in self._state_calls:
            call()
        self.gl.clip_depths_from_zero(self.clips_from_zero)
        if self.step.kind == "fullscreen":
            self._draw_screen()
        elif len(self.frame.scene_buffer.scene):
            count = len(self.frame.scene_buffer.scene)
            self._within(self._band, lambda: self.vao.render(mode=5, vertices=4, instances=count))  # GL_TRIANGLE_STRIP

    def _clear(self, framebuffer: Framebuffer, texture: Texture, values: tuple[float, ...]) -> None:
        beside = self.step.region and self.step.kind == "clear"
        for rectangle in _around(*self.frame.region, *framebuffer.size) if beside else (self._extent,):
            self._within(rectangle, lambda: framebuffer.clear(texture, values))

    @property
    def _band(self) -> Rectangle | None:
        """The part of the screen that a loop over bands leaves the pass."""
        return self.frame.band if self.step.region else None

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
        return self.frame.named(name)

    def _draw_screen(self) -> None:
        self._within(self._extent, self._draw_tiles if self.step.by_tile else self._draw_triangle)

    def _draw_triangle(self) -> None:
        """Over the whole viewport, GL_TRIANGLES."""
        if self.step.command:
            commands = self._commands(self.step.command)
            self.vao.render_indirect(commands, mode=4, count=1, first=self.step.defines["CLASS"])
        else:
            self.vao.render(mode=4, vertices=3, instances=self.instances)

    def _draw_tiles(self) -> None:
        """A point over each listed tile, in a viewport of whole tiles: points whose middle is outside are clipped."""
        width, height = self.frame.stats.W, self.frame.stats.H
        self.gl.glViewport(0, 0, width + -width % LISTED, height + -height % LISTED)
        self.vao.render_indirect(self._commands(TILE_COMMAND), mode=0, count=1)  # GL_POINTS

    def _zero(self, iteration: int) -> None:
        """Clear the buffers that a pass of kind `clear` writes, by the driver."""
        if self.buffers:
            self.gl.glMemoryBarrier(rawgl.BARRIERS["buffer_update"])
        for binding in self.buffers:
            buffer = self.frame.buffer(binding, iteration)
            self.gl.zero(buffer.glo, buffer.size)

    def _bind(self, iteration: int) -> None:
        for binding in self.buffers:
            self.frame.buffer(binding, iteration).bind_to_storage_buffer(binding.index)
        for binding in self.textures:
            self.frame.texture(binding.ref, iteration).bind(binding.index)
        if self.takes_iteration:
            self.program["iteration"] = iteration

    def _dispatch(self, iteration: int) -> None:
        """Images are published at once: what comes next may be a draw, a fetch or a read-back."""
        for unit, ref in enumerate(self.step.into):
            self.frame.texture(ref, iteration).bind_image(unit)
        if self.step.into:
            self.gl.glMemoryBarrier(rawgl.BARRIERS["image"])
        if self.step.by_tile:
            self.program.run_indirect(self._commands(TILE_COMMAND), DISPATCH_OFFSET)
        else:
            self.program.run(self._group_count())
        if self.step.into:
            self.gl.glMemoryBarrier(rawgl.BARRIERS["image"])

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
        """Of all locations alike, or of each its own way."""
        yield self._switch(rawgl.BLEND, state.blend or state.blends)
        if state.blend:
            equation, source, destination = state.blend
            factors = (source, destination, *(state.blend_alpha or (source, destination)))
            yield partial(self.gl.glBlendEquation, rawgl.EQUATIONS[equation])
            yield partial(self.gl.glBlendFuncSeparate, *(rawgl.FACTORS[factor] for factor in factors))
        for location, (equation, source, destination) in enumerate(state.blends):
            yield partial(self.gl.glBlendEquationi, location, rawgl.EQUATIONS[equation])
            yield partial(self.gl.glBlendFunci, location, rawgl.FACTORS[source], rawgl.FACTORS[destination])

    def _switch(self, capability: int, on: object) -> Callable[[], None]:
        return partial(self.gl.glEnable if on else self.gl.glDisable, capability)

    def release(self) -> None:
        for framebuffer in self.framebuffers.values():
            framebuffer.release()
        if self.vao:
            self.vao.release()
