"""What a device does right, found by trying: atomics, side effects, barriers, mutual exclusion, timers.

The tests are small methods, declared and run like the methods under test.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np

from ..config.model import Scene as SceneConfig
from ..errors import MfrError
from ..methods.shared import MULTISAMPLING, SYNC, K, clear, resolve, route, routed_targets
from ..methods.spec import IMAGE, Buffer, Fitted, Method, Pass, State, Target, when
from ..oracle.composite import composite, fragment_counts, stats_of
from ..oracle.quality import conformance
from ..plan.forecast import FIRST_ROUNDS
from ..scene import generate
from .capture import capture
from .device import Device
from .frame import Frame
from .rates import rates
from .scene_buffer import SceneBuffer
from .single import shown
from .targets import Canvas
from .timers import GpuTimer, WallTimer

ROUTED_SCENE = SceneConfig(size=(16, 16), depth_complexity=4)
SLANTED_SCENE = SceneConfig(size=(96, 80), depth_complexity=12, slant=0.8)
SCENE = SceneConfig(size=(192, 160), depth_complexity=24, pixel_density=0.9)
WORK = SceneConfig(size=(512, 512), depth_complexity=0)
MOST_ROUNDS = 16384
COMPARED = 3  # sizes of work that are long enough to compare
TIMER_TOLERANCE = 0.15  # of the wall time, on work that takes milliseconds
WORTH_COMPARING_MS = 2.0  # below this the wall clock sees mostly the round trip to the device
REPEATS = 3


def _probe(name: str, *steps: Pass, buffers: tuple[Buffer, ...] = (), **more) -> Method:
    return Method(id=f"probe-{name}", name=name, family="probe", source="self-test", summary="", guarantee="none",
                  words="0", ties="", steps=steps, buffers=buffers, **more)


COUNTER = Buffer("counter", "P", clear="0u", coherent=True)
SHOW = Pass("show", "fullscreen", "probe/show_count.frag", reads=("counter",), into=(IMAGE,))
COUNT = Pass("count", "geometry", "common/count.frag", writes=("counter",))

ATOMICS = _probe("atomics", clear("total"), Pass("count", "geometry", "probe/total.frag", writes=("total",)),
                 buffers=(Buffer("total", "1", clear="0u"),))
COUNTED = _probe("side effects", clear("counter"), COUNT, SHOW, buffers=(COUNTER,))
LOCKED = _probe("lock", clear("counter", "semaphore"),
                Pass("count", "geometry", "probe/locked_count.frag", writes=("counter", "semaphore")), SHOW,
                buffers=(COUNTER, Buffer("semaphore", "P", clear="0u", coherent=True, when=when("sync", "spin"))),
                params=(SYNC,))
ROUTED = _probe("stencil routing", *route("k"), resolve("depths", "colours", fetch="methods/routing/fetch.glsl"),
                targets=routed_targets("k"), params=(MULTISAMPLING,), fixed=(K.at(4),), local="k")
NEAREST = _probe("slanted depths",
                 Pass("nearest", "geometry", "probe/rasterized.frag", into=("nearest",), clears={"nearest": (1.0,)},
                      state=State(depth_test="less")),
                 Pass("show", "fullscreen", "probe/show_depth.frag", reads=("nearest",), into=(IMAGE,)),
                 targets=(Target("nearest", "depth32f"),))
BUSY = _probe("work", Pass("work", "fullscreen", "probe/work.frag", into=(IMAGE,)))


@dataclass(frozen=True)
class Finding:
    """Outcome of one self-test: passed True, False, or None where the device lacks what it needs."""

    name: str
    passed: bool | None
    detail: str


class _Bench:
    """One scene on the device, on which probes run."""

    def __init__(self, device: Device, config: SceneConfig):
        self.device = device
        self.scene = generate(config)
        self.stats = stats_of(self.scene)
        self.scene_buffer = SceneBuffer(device, self.scene)
        self.canvas = Canvas(device, (self.stats.W, self.stats.H))

    def frame(self, method: Method, **params) -> Frame:
        return Frame(self.device, Fitted(method.variant(params), self.stats), self.scene_buffer, self.canvas)

    def release(self) -> None:
        self.scene_buffer.release()
        self.canvas.release()


def _atomics(bench: _Bench) -> tuple[bool, str]:
    frame = bench.frame(ATOMICS)
    frame.draw()
    total = int(frame.words("total")[0])
    frame.release()
    return total == bench.stats.F, f"{total} of {bench.stats.F} increments of one word"


def _counted(bench: _Bench, source: str) -> tuple[bool, str]:
    frame = bench.frame(COUNTED)
    frame.draw()
    expected = fragment_counts(bench.scene)
    found = (frame.words("counter").reshape(expected.shape).astype(np.int64) if source == "buffer"
             else frame.image()[..., 0].astype(np.int64))
    frame.release()
    return bool((found == expected).all()), f"{int((found == expected).sum())} of {expected.size} pixels counted right"


def _locked(bench: _Bench, sync: str) -> tuple[bool, str]:
    frame = bench.frame(LOCKED, sync=sync)
    frame.draw()
    total = int(frame.words("counter").sum())
    frame.release()
    return total == bench.stats.F, f"{total} of {bench.stats.F} plain increments under the lock"


def _routed(device: Device, multisampling: str) -> tuple[bool, str]:
    bench = _Bench(device, ROUTED_SCENE)
    try:
        frame = bench.frame(ROUTED, multisampling=multisampling)
        frame.draw()
        wrong = conformance(frame.image(), composite(bench.scene))["wrong_pixels"]
        frame.release()
    finally:
        bench.release()
    return wrong == 0, f"{bench.stats.P - wrong} of {bench.stats.P} pixels with every fragment in a sample of its own"


def _slanted(device: Device) -> tuple[bool, str]:
    with shown(device, generate(SLANTED_SCENE)) as on:
        fragments = capture(device, on.scene_buffer, on.canvas)
        held = on.render(NEAREST.variant({}))[..., 0].view(np.uint32)
    first = np.cumsum(fragments.counts.ravel()) - fragments.counts.ravel()
    alike = int(np.count_nonzero(held.ravel() == fragments.depth[first]))
    return alike == held.size, f"{alike} of {held.size} pixels whose depth buffer holds a depth that shaders see"


def tests_each_sample(device: Device) -> bool:
    """Whether the stencil of each sample is tested with multisampling off; GL lets a device test one for all."""
    return bool(_finding("", lambda: _routed(device, "off")).passed)


def self_tests(device: Device) -> list[Finding]:
    """Run every test but the timers'. A test that cannot even compile has failed."""
    bench = _Bench(device, SCENE)
    findings = [
        _finding("atomics", lambda: _atomics(bench)),
        _finding("side effects under a full draw", lambda: _counted(bench, "buffer")),
        _finding("barriers", lambda: _counted(bench, "image")),
        _finding("spin lock", lambda: _locked(bench, "spin")),
    ]
    findings.append(_finding("slanted depths", lambda: _slanted(device)))
    if "fragment_shader_interlock" in device.features:
        findings.append(_finding("interlock", lambda: _locked(bench, "interlock")))
    else:
        findings.append(Finding("interlock", None, "no fragment shader interlock extension"))
    if "samples_4" in device.features:
        findings.append(_finding("stencil routing", lambda: _routed(device, "on")))
    else:
        findings.append(Finding("stencil routing", None, "no targets of 4 samples"))
    bench.release()
    return findings


def _finding(name: str, test: Callable[[], tuple[bool, str]]) -> Finding:
    try:
        return Finding(name, *test())
    except (MfrError, MemoryError) as error:
        return Finding(name, False, str(error))


@dataclass(frozen=True)
class Calibration:
    """Which timer to trust, and the times on work of known size that say so."""

    timer: str
    wall_ms: tuple[float, ...]
    gpu_ms: tuple[float, ...]
    reason: str
    resolution_ms: dict[str, float | None] = field(default_factory=dict)  # tick of each timer's clock
    rates: dict[str, float] = field(default_factory=dict)  # see `gpu.rates`


def calibrate(device: Device) -> Calibration:
    """Time fullscreen work of growing size by both timers; GPU timers count where they agree with the wall clock."""
    bench = _Bench(device, WORK)
    wall, gpu = WallTimer(device), GpuTimer(device)
    wall_ms: list[float] = []
    gpu_ms: list[float] = []
    rounds = FIRST_ROUNDS
    while rounds <= MOST_ROUNDS and sum(w >= WORTH_COMPARING_MS for w in wall_ms) < COMPARED:
        frame = bench.frame(replace(BUSY, steps=(replace(BUSY.steps[0], defines={"ROUNDS": rounds}),)))
        frame.draw()
        wall_ms.append(min(wall.frame_ms(frame.draw) for _ in range(REPEATS)))
        gpu_ms.append(min(gpu.frame_ms(frame.draw) for _ in range(REPEATS)))
        frame.release()
        rounds *= 2
    bench.release()
    return Calibration(*_verdict(wall_ms, gpu_ms), {timer.name: timer.resolution_ms for timer in (wall, gpu)},
                       rates(device))


def _verdict(wall_ms: list[float], gpu_ms: list[float]) -> tuple[str, tuple[float, ...], tuple[float, ...], str]:
    compared = [(w, g) for w, g in zip(wall_ms, gpu_ms, strict=True) if w >= WORTH_COMPARING_MS]
    off = [g / w for w, g in compared if abs(g / w - 1) > TIMER_TOLERANCE]
    if not compared:
        timer, reason = "wall", f"the work took under {WORTH_COMPARING_MS} ms: nothing to compare"
    elif off:
        timer, reason = "wall", f"GPU timers show {min(off):.2g} of the wall time of work of known size"
    else:
        timer, reason = "gpu", f"GPU timers agree with the wall clock within {TIMER_TOLERANCE:.0%}"
    return timer, tuple(wall_ms), tuple(gpu_ms), reason
