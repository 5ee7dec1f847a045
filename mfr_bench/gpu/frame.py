"""Executes the frames of one fitted variant: plans each, puts barriers between its passes, and draws them.

    plan          what a frame runs, with which bindings and barriers; without GL
    allocation    the buffers and textures that the variant declares
    schedule      the plans of a method that plans its frames
    pass_runner   one pass: program, state, part of the screen
    diagnostics   counters outside the method's memory
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import replace
from functools import cached_property

import numpy as np

from ..glsl.bindings import COLOURS_BINDING
from ..methods.shared.bands import Rectangle, bands
from ..methods.spec import Counted, Fitted, FrameState, Grown, Pass, Plan, Planned, evaluate
from ..scene.geometry import Geometry
from . import rawgl
from .allocation import Allocation
from .context import Device
from .diagnostics import Diagnostics
from .pass_runner import PassRunner
from .plan import Barriers, FramePlan, LoopPlan, frame_plan
from .scene_buffer import SceneBuffer
from .schedule import Schedule
from .targets import Canvas
from .uniforms import Uniforms

Mark = Callable[[str], None]


class Frame:
    """One variant on one scene, ready to draw.

    `draw` runs all passes, and where a growing buffer was too small doubles it and runs them again.
    Raises ShaderError for GLSL that does not compile, MemoryError where the device has no room.
    """

    ALLOCATION = Allocation  # makes the buffers and textures; a check of writes outside them has a class of its own

    def __init__(self, device: Device, fitted: Fitted, scene_buffer: SceneBuffer, canvas: Canvas):
        planned = isinstance(fitted.variant.method.capacity, Planned)
        self.device, self.gl = device, device.gl
        self.fitted = fitted = replace(fitted, features=device.features) if planned else fitted
        self.variant, self.stats = fitted.variant, fitted.stats
        self.scene_buffer, self.canvas = scene_buffer, canvas
        self.geometry_passes = 0  # of the last frame
        self.chosen_k = int(self.variant.scope.get("k", 0))  # what the host decides, where it does
        self.band: Rectangle | None = None  # of the loop over bands that is running
        self.plan: Plan | None = None  # of the latest frame, of a planned method
        self._capacity = fitted.start_capacity()  # elements in use, never more than there is room for
        self._counted = 0  # samples that the latest counting pass let through
        self._shown = scene_buffer.scene
        self._drawn: tuple[Geometry, int] | None = None  # scene of the latest frame, and version of the allocation
        self._had_room_once = False  # whether a frame has had room for everything
        self.drawn = self._asked_after = 0  # frames so far, and those before lost fragments were last asked for
        self._probing = False
        self._frame_plan: tuple[tuple, FramePlan] | None = None  # the newest, with the fields of the state it is for
        self._barriers = Barriers(())
        # Found by trials, which must not come while a pass draws.
        self.flushes_dispatches = any(p.kind == "compute" for p in self.variant.passes) and device.flushes_dispatches
        self._barrier_bits = rawgl.BARRIERS["storage"] | (
            rawgl.BARRIERS["texels"] if any(p.texels for p in self.variant.passes) else 0)
        self.allocation = self.ALLOCATION(device, fitted, canvas)
        self.diagnostics = Diagnostics(device)
        self._schedule = Schedule(device.gl, fitted, self._deepest)
        self.uniforms = Uniforms(device, fitted.stats)
        self._query = device.gl.generate("Queries")
        self._runners = {id(step): PassRunner(self, step) for step in self.variant.passes if self._compiles_now(step)}
        self._write_uniforms()
        device.settle()
        device.check(f"{self.variant.method.id}: allocation")

    def _compiles_now(self, step: Pass) -> bool:
        """Whether to compile a pass before the first frame; what a plan or a probe may need is compiled when needed."""
        return self.fitted.needed(step) and not step.probes and step.runs_in is None

    def _write_uniforms(self) -> None:
        self.uniforms.write(self._shown, self._capacity, self.chosen_k)

    @property
    def region(self) -> Rectangle:
        """Left, bottom, width and height in pixels of what bounds the geometry on the screen."""
        return self._shown.bounds

    @property
    def memory_bytes(self) -> dict[str, int]:
        """Bytes of each allocated object, by the name of its declaration."""
        return self.allocation.memory_bytes

    def show(self, scene: Geometry) -> None:
        """Take the scene that `scene_buffer` now has: its seed reaches the shaders."""
        if scene is not self._shown:
            self._shown = scene
            self._write_uniforms()

    # --- the plan of a frame ---

    @property
    def static(self) -> bool:
        """Whether the frame before was of the scene that is shown, and all that it left is in place."""
        if self._drawn is None:
            return False
        scene, version = self._drawn
        return scene is self.scene_buffer.scene and version == self.allocation.version

    def _planned_now(self) -> FramePlan:
        """The plan of a frame in the present state, made anew when that has changed."""
        state = self.plan, self.static, self._probing
        if self._frame_plan is None or self._frame_plan[0] != state:
            self._frame_plan = state, frame_plan(self.fitted, FrameState(*state))
        return self._frame_plan[1]

    @property
    def running(self) -> tuple[Pass, ...]:
        """The passes that the next frame runs, or the one that is drawn, loops once."""
        return tuple(step for planned in self._planned_now().steps
                     for step in (planned.passes if isinstance(planned, LoopPlan) else (planned,)))

    def _begin(self, plan: Plan) -> None:
        if plan != self.plan:
            self.plan = plan
            self._write_uniforms()
            if plan.capacity == 0:
                self.allocation.trim(0)
        if plan.capacity is not None:
            self._set_capacity(plan.capacity)

    # --- drawing ---

    def draw(self, mark: Mark | None = None) -> bool:
        """Run every pass in order; `mark` is called with the pass's name after each.

        A frame that had too little room is drawn again at once with more, as a part of the same frame: one that fitted
        does not show that the next does, where chance or another scene decides it. Returns whether the plan is that of
        the next frame. Raises CapacityError where a buffer cannot grow further.
        """
        self.geometry_passes = 0
        self.drawn += 1
        self._barriers = Barriers(self.allocation.names)
        if isinstance(self.variant.method.capacity, Planned):
            self._begin(self._schedule.next_plan(self._shown))
        self.uniforms.bind()
        self.diagnostics.bind()
        self.scene_buffer.bind_opaque()
        if self.variant.two_channel:
            self.scene_buffer.two_channel[1].bind_to_uniform_block(COLOURS_BINDING)
        iteration = 0
        for step in self._planned_now().steps:
            if isinstance(step, LoopPlan):
                iteration = self._loop(step, mark)
            else:
                self._run(step, iteration, mark)
                if step is self._fills and not (self._had_room_once or self._had_room()):
                    return self._draw_again(mark)
        self._drawn = self.scene_buffer.scene, self.allocation.version
        self._had_room_once = self._had_room()
        return self._settled() if self._had_room_once else self._draw_again(mark)

    def _draw_again(self, mark: Mark | None) -> bool:
        """Draw the frame by its next plan or with more room; the passes of both are its own."""
        passes = self.geometry_passes
        settled = self.draw(mark)
        self.geometry_passes += passes
        return settled

    def _loop(self, planned: LoopPlan, mark: Mark | None) -> int:
        """Run a loop. Returns its iterations, or those that the frame before began for this one.

        `.previous` then names what the last iteration wrote.
        """
        loop = planned.loop
        if loop.bands:
            return self._loop_bands(planned, mark)
        times = int(evaluate(loop.times, self.stats, self.fitted.scope)) if loop.passes else 0
        for iteration in range(times):
            for step in planned.passes:
                counted = self._run(step, iteration, mark)
                if loop.until_empty and step.counts and counted == 0:
                    return iteration + 1
        return times

    def _loop_bands(self, planned: LoopPlan, mark: Mark | None) -> int:
        """Run the passes once for each band, of which there are any where the plan says so."""
        if not (planned.passes and self.plan and self.plan.banded):
            return 0
        sums = self.words(planned.loop.bands).reshape(self.stats.H, -1)
        try:
            for band in bands(sums, self.region, self._schedule.room):
                self.band = band
                for step in planned.passes:
                    self._run(step, 0, mark)
        finally:
            self.band = None
        return 0

    def _run(self, step: Pass, iteration: int, mark: Mark | None) -> int | None:
        """Draw a pass, and do what the host does after it. Returns the samples that a counting pass let through."""
        runner = self._runner(step)
        if runner is None:
            return None
        if self._barriers.due(runner.planned):
            self.gl.glMemoryBarrier(self._barrier_bits)
        counts_for_plan = step.counts_for_plan and self._schedule.begin_count(self._shown)
        if step.counts:
            self.gl.glBeginQuery(rawgl.SAMPLES_PASSED, self._query)
        runner.run(iteration)
        self.geometry_passes += step.kind == "geometry"
        if counts_for_plan:
            self._schedule.end_count(self._shown)
        counted = self._end_count() if step.counts else None
        if step.totals:
            self._set_capacity(int(self.words(step.totals).sum()))
        if step.decides:
            self._decide()
        if step.probes:  # its counter is no buffer that later passes wait for; without, llvmpipe drops covered tiles
            self.gl.glMemoryBarrier(rawgl.BARRIERS["storage"])
        if mark:
            mark(step.name)
        return counted

    def _runner(self, step: Pass) -> PassRunner | None:
        """The runner for this pass, created on demand for a planned method; None if another runner handles it."""
        if step.runs_in and id(step) not in self._runners:
            self._runners[id(step)] = PassRunner(self, step)
        return self._runners.get(id(step))

    def _end_count(self) -> int:
        """Read how many samples a counting pass let through, which may be the capacity that later passes need."""
        self.gl.glEndQuery(rawgl.SAMPLES_PASSED)
        counted = self._counted = self.gl.query_result(self._query)
        if isinstance(self.variant.method.capacity, (Counted, Planned)):
            room = self._schedule.room
            self._set_capacity(counted if room is None else max(0, min(counted, room)))
        self._schedule.learn(self._shown, counted)
        return counted

    # --- capacity ---

    def _decide(self) -> None:
        """Set k and the capacity for the passes that follow, from what the last one has written."""
        decided = self.variant.method.capacity
        choice = decided.rule(self.words(decided.reads).tolist(), self._counted, self.stats.P, self.fitted.scope)
        self.chosen_k = choice.k
        self._set_capacity(choice.capacity)
        self._write_uniforms()

    def _set_capacity(self, elements: int) -> None:
        self.allocation.hold(elements)
        if elements != self._capacity:
            self._capacity = elements
            self._write_uniforms()

    @cached_property
    def _fills(self) -> Pass | None:
        """The pass behind which a growing buffer is full or has room: no other is drawn, nor compiled, before it fits.

        A driver may compile the passes that read the buffer anew for another size of it.
        """
        grown = self.variant.method.capacity
        counter = grown.counter if isinstance(grown, Grown) else None
        return next((step for step in reversed(self.variant.passes) if counter in step.writes), None)

    def _had_room(self) -> bool:
        """Whether the frame that was drawn had room for everything; else the next has more."""
        grown = self.variant.method.capacity
        if self.plan:
            return self._schedule.had_room(self._shown, self.plan)
        if not isinstance(grown, Grown):
            return True
        wanted = int(self.words(grown.counter)[0])
        if wanted <= self._capacity:
            return True
        self.allocation.check_room(2 * self._capacity, wanted)
        self._set_capacity(2 * self._capacity)
        self.device.check(f"{self.variant.method.id}: growing to {self._capacity} elements")
        return False

    def _settled(self) -> bool:
        """Whether the next frame has the plan of the one that was drawn."""
        if self.plan is None or self.plan.capacity is not None:
            return True
        after = self._schedule.next_plan(self._shown)
        return (after.path, after.capacity) == (self.plan.path, self.plan.capacity)

    def _deepest(self) -> int:
        """Fragments of the deepest pixel, as a frame of a planned method has left them; 0 takes their place."""
        name = self.variant.method.capacity.deepest
        if deepest := int(self.words(name)[0]):
            self.gl.zero(self.allocation.named(name).glo, 4)
        return deepest

    def draw_fitting(self) -> None:
        """Draw until the plan of a frame is that of the next, with room for everything.

        Raises CapacityError where a buffer cannot grow further.
        """
        while not self.draw():
            self.device.check(f"{self.variant.method.id}: planning")

    # --- what a frame left ---

    def image(self) -> np.ndarray:
        """float32 (H, W, 4), premultiplied, row 0 at the bottom."""
        return self.canvas.framebuffer.read()

    def words(self, name: str) -> np.ndarray:
        """uint32 contents of a buffer."""
        return self.allocation.words(name)

    def fill(self, name: str, words: np.ndarray) -> None:
        """Give a buffer uint32 contents."""
        self.allocation.fill(name, words)

    def lost_fragments(self) -> int:
        """Fragments that found no room or never got the lock, since the last call, in all frames together."""
        self._asked_after = self.drawn
        return self.diagnostics.take("lost_fragments")

    def lost_in_a_frame(self) -> int:
        """Fragments that one frame lost: the mean of the frames since the last call, rounded up."""
        frames = max(1, self.drawn - self._asked_after)
        return -(-self.lost_fragments() // frames)

    def probe(self) -> dict[str, int]:
        """Fragments by each counter that the variant's probing passes fill; draws a frame, if there are any."""
        counters = {step.probes for step in self.variant.passes if step.probes}
        if not counters:
            return {}
        for name in counters:
            self.diagnostics.take(name)
        passes = self.geometry_passes
        with self._with_probes():
            self.draw()
        self.geometry_passes = passes
        return {name: self.diagnostics.take(name) for name in counters}

    @contextmanager
    def _with_probes(self) -> Iterator[None]:
        """Within this a frame has its probing passes."""
        self._probing = True
        left_out = {id(step) for step, _ in self._planned_now().left_out}
        self._runners |= {id(step): PassRunner(self, step) for step in self.variant.passes
                          if step.probes and id(step) not in self._runners and id(step) not in left_out}
        try:
            yield
        finally:
            self._probing = False

    def compile_probes(self) -> None:
        """Draw the probing passes alone behind a frame, with which drivers compile them; the counts mean nothing."""
        with self._with_probes():
            for step in self.running:
                if step.probes:
                    self._run(step, 0, None)

    def draw_by(self, runners: Mapping[int, PassRunner]) -> None:
        """Draw a frame in which other runners do the work of its passes, by the identity of the pass."""
        own, self._runners = self._runners, dict(runners)
        try:
            self.draw()
        finally:
            self._runners = own

    def draw_map(self, runners: Mapping[int, PassRunner]) -> np.ndarray:
        """uint32 (H, W): what the runners' programs count for each pixel in one frame, as by `draw_by`."""
        with self.diagnostics.mapped(self.stats.P):
            self.draw_by(runners)
            return self.diagnostics.map().reshape(self.stats.H, self.stats.W).copy()

    def work(self) -> Counter[str]:
        """The counts of counting programs since `reset_work`, by the names of `glsl.counters.WORK`."""
        return self.diagnostics.work()

    def reset_work(self) -> None:
        """Start the counters of work again from 0."""
        self.diagnostics.reset_work()

    def release(self) -> None:
        """Free everything on the device but the scene and the canvas."""
        for runner in self._runners.values():
            runner.release()
        for part in (self.allocation, self.diagnostics, self._schedule, self.uniforms):
            part.release()
        self.gl.delete("Queries", self._query)
