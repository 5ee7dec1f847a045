"""Tests of a device that show what it does right: atomics, side effects, barriers, mutual exclusion, timers.

The tests are small methods, declared and run like the methods under test.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np

from ..errors import MfrError
from ..methods.shared import K
from ..methods.spec import IMAGE, Pass, State, Target
from ..oracle.composite import fragment_counts
from ..plan.forecast import FIRST_ROUNDS
from ..scene import Scene, generate
from ..stats import LONG_ENOUGH_MS
from .capture import capture
from .context import Device
from .probes import ATOMICS, COUNTED, ProbeBench, probe_method
from .rates import rates
from .single import shown
from .timers import GpuTimer, WallTimer
from .trials import TRIALS, Trial, locked, routed

SLANTED_SCENE = Scene(size=(96, 80), depth_complexity=12, slant=0.8)
SCENE = Scene(size=(192, 160), depth_complexity=24, pixel_density=0.9)
WORK = Scene(size=(512, 512), depth_complexity=0)
MOST_ROUNDS = 16384
COMPARED = 3  # sizes of work that are long enough to compare
TIMER_TOLERANCE = 0.15  # of the wall time, on work that takes milliseconds
REPEATS = 3


NEAREST = probe_method(
    "slanted depths",
    Pass("nearest", "geometry", "probe/rasterized.frag", into=("nearest",), clears={"nearest": (1.0,)},
         state=State(depth_test="less")),
    Pass("show", "fullscreen", "probe/show_depth.frag", reads=("nearest",), into=(IMAGE,)),
    targets=(Target("nearest", "depth32f"),))
BUSY = probe_method("work", Pass("work", "fullscreen", "probe/work.frag", into=(IMAGE,)))


@dataclass(frozen=True)
class SelfTestOutcome:
    """Outcome of one self-test: passed True, False, or None where the device lacks what it needs.

    `costs`: what a failure costs; None: any result may be wrong.
    """

    name: str
    passed: bool | None
    detail: str
    costs: str | None = None

    @property
    def harmful(self) -> bool:
        """Whether results of this device may be wrong."""
        return self.passed is False and self.costs is None


def _atomics(bench: ProbeBench) -> tuple[bool, str]:
    frame = bench.frame(ATOMICS)
    frame.draw()
    total = int(frame.words("total")[0])
    frame.release()
    return total == bench.stats.F, f"{total} of {bench.stats.F} increments of one word"


def _counted(bench: ProbeBench, source: str) -> tuple[bool, str]:
    frame = bench.frame(COUNTED)
    frame.draw()
    expected = fragment_counts(bench.scene)
    found = (frame.words("counter").reshape(expected.shape).astype(np.int64) if source == "buffer"
             else frame.image()[..., 0].astype(np.int64))
    frame.release()
    return bool((found == expected).all()), f"{int((found == expected).sum())} of {expected.size} pixels counted right"


def _slanted(device: Device) -> tuple[bool, str]:
    with shown(device, generate(SLANTED_SCENE)) as on:
        fragments = capture(device, on.scene_buffer, on.canvas)
        held = on.render(NEAREST.variant({}))[..., 0].view(np.uint32)
    counts = fragments.counts.ravel()
    first, drawn = np.cumsum(counts) - counts, counts > 0
    alike = int(np.count_nonzero(held.ravel()[drawn] == fragments.depth[first[drawn]]))
    return alike == held.size, f"{alike} of {held.size} pixels whose depth buffer holds a depth that shaders see"


def self_tests(device: Device) -> list[SelfTestOutcome]:
    """Run every test but the timers', and every trial. A test that cannot even compile has failed."""
    with ProbeBench(device, SCENE) as bench:
        findings = [
            _finding("atomics", lambda: _atomics(bench)),
            _finding("side effects under a full draw", lambda: _counted(bench, "buffer")),
            _finding("barriers", lambda: _counted(bench, "image")),
        ]
    findings += [_finding("spin lock", lambda: locked(device, "spin", SCENE)),
                 _finding("slanted depths", lambda: _slanted(device))]
    if "samples_4" in device.features:
        findings.append(_finding("stencil routing", lambda: routed(device, "on")))
    else:
        findings.append(SelfTestOutcome("stencil routing", None, "no targets of 4 samples"))
    return [*findings, *(_tried(device, trial) for trial in TRIALS)]


def _tried(device: Device, trial: Trial) -> SelfTestOutcome:
    if trial.feature and trial.feature not in device.offered:
        return SelfTestOutcome(trial.name, None, f"the driver does not offer {trial.feature}", trial.costs)
    return SelfTestOutcome(trial.name, *trial.outcome(device), trial.costs)


def _finding(name: str, test: Callable[[], tuple[bool, str]]) -> SelfTestOutcome:
    try:
        return SelfTestOutcome(name, *test())
    except (MfrError, MemoryError) as error:
        return SelfTestOutcome(name, False, str(error))


@dataclass(frozen=True)
class Calibration:
    """The timer to trust, and the times on work of known size that show it."""

    timer: str
    wall_ms: tuple[float, ...]
    gpu_ms: tuple[float, ...]
    reason: str
    resolution_ms: dict[str, float | None] = field(default_factory=dict)  # tick of each timer's clock
    rates: dict[str, float] = field(default_factory=dict)  # see `gpu.rates`; empty of a calibration made again


def calibrate(device: Device, again: bool = False) -> Calibration:
    """Time fullscreen work of growing size by both timers; a GPU's count where they agree with the wall clock.

    again: whether this is compared with an earlier one, for which rates are not needed.
    """
    bench = ProbeBench(device, WORK)
    wall, gpu = WallTimer(device), GpuTimer(device)
    wall_ms: list[float] = []
    gpu_ms: list[float] = []
    rounds = FIRST_ROUNDS
    while rounds <= MOST_ROUNDS and sum(w >= LONG_ENOUGH_MS for w in wall_ms) < COMPARED:
        frame = bench.frame(replace(BUSY, fixed=(K.at(rounds),)))
        frame.draw()
        wall_ms.append(min(wall.frame_ms(frame.draw) for _ in range(REPEATS)))
        gpu_ms.append(min(gpu.frame_ms(frame.draw) for _ in range(REPEATS)))
        frame.release()
        rounds *= 2
    bench.release()
    ticks_ms = {timer.name: timer.resolution_ms for timer in (wall, gpu)}
    return Calibration(*_verdict(device.kind, wall_ms, gpu_ms), ticks_ms, {} if again else rates(device))


def _verdict(kind: str, wall_ms: list[float],
             gpu_ms: list[float]) -> tuple[str, tuple[float, ...], tuple[float, ...], str]:
    """The timer, what both showed, and the reason. On zink over lavapipe they agree or not from run to run, by load."""
    compared = [(w, g) for w, g in zip(wall_ms, gpu_ms, strict=True) if w >= LONG_ENOUGH_MS]
    off = [g / w for w, g in compared if abs(g / w - 1) > TIMER_TOLERANCE]
    if kind == "cpu":
        timer, reason = "wall", "the device draws on processors, whose work the wall clock times"
    elif not compared:
        timer, reason = "wall", f"the work took under {LONG_ENOUGH_MS} ms: nothing to compare"
    elif off:
        timer, reason = "wall", f"GPU timers show {min(off):.2g} of the wall time of work of known size"
    else:
        timer, reason = "gpu", f"GPU timers agree with the wall clock within {100 * TIMER_TOLERANCE:.0f} %"
    return timer, tuple(wall_ms), tuple(gpu_ms), reason
