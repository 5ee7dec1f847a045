"""Trials of what drivers are known to get wrong (docs/drivers.md), each small, with a result that is known.

A feature that a driver claims and that fails its trial counts as missing: methods that need it are unsupported.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial

import numpy as np

from .. import glsl
from ..config.model import Scene as SceneConfig
from ..errors import MfrError
from ..methods import kplus
from ..methods.shared import ATOMIC64
from ..methods.spec import (
    ADD,
    EMPTY,
    IMAGE,
    LISTED,
    MAX,
    SAMPLE_STENCIL,
    TILE_POINTS,
    Blend,
    Buffer,
    Method,
    Pass,
    State,
    Target,
)
from ..oracle.composite import composite
from ..oracle.quality import conformance
from ..scene import generate
from . import rawgl
from .context import Device
from .frame import Frame
from .probes import COUNTED, LOCKED, ROUTED, ROUTED_SCENE, ProbeBench, probe_method
from .targets import Framebuffer, Texture

SCENE = SceneConfig(size=(24, 20), depth_complexity=3)
TILES_SCENE = SceneConfig(size=(3 * LISTED, 2 * LISTED), depth_complexity=5)
TILED = {"touched": "tiles", "k": 8, "sync": "spin"}
INVOCATIONS = 64
BLENDED = ("r8", "rg8", "rgba8", "r16", "rgba16f", "r32f", "rg32f", "rgba32f")
STEP = 1 / 255  # of a channel of 8 bits
LENGTH_SIZE = (24, 20)  # pixels
SECOND_WORDS = 1000  # of the block whose length is asked for

OPERATIONS = probe_method(
    "atomic operations", Pass("apply", "compute", "probe/operations.comp", writes=("element", "before"), groups="1",
                              defines={"INVOCATIONS": INVOCATIONS}),
    buffers=(Buffer("element", "6", coherent=True), Buffer("before", f"6*{INVOCATIONS}")))
OPERATIONS64 = probe_method(
    "64-bit atomics", Pass("apply", "compute", "probe/operations64.comp", groups="1",
                           writes=("wide", "signed_wide", "before"), defines={"INVOCATIONS": INVOCATIONS}),
    buffers=(Buffer("wide", "4", type="uint64_t", coherent=True),
             Buffer("signed_wide", "2", type="int64_t", coherent=True),
             Buffer("before", f"6*{INVOCATIONS}", type="uvec2")), params=(ATOMIC64,))

Outcome = tuple[bool, str]


@dataclass(frozen=True)
class Trial:
    """A check with a known answer, and the feature that methods lose where it fails; None: of all devices.

    `avoided`: no shader depends on it, so that a failure is reported and harms nothing.
    """

    name: str
    run: Callable[[Device], Outcome]
    feature: str | None = None
    avoided: bool = False

    @property
    def costs(self) -> str | None:
        """What a failure costs; None: any result may be wrong."""
        if self.avoided:
            return "avoided by all methods"
        return f"methods that need {self.feature} are unsupported" if self.feature else None

    def outcome(self, device: Device) -> Outcome:
        """Whether the device passes, and what was seen. A trial that cannot even compile has failed."""
        try:
            return self.run(device)
        except (MfrError, MemoryError) as error:
            return False, str(error)


def block_length(device: Device) -> Outcome:
    """Whether `.length()` is the same in every lane behind a loop that lanes leave at different times."""
    ctx, (width, height) = device.ctx, LENGTH_SIZE
    words = (8 * width * height + 5, SECOND_WORDS, width * height)
    program = ctx.program(vertex_shader=f"{glsl.prelude.VERSION}\n{glsl.includes.read('screen/triangle.vert')}",
                          fragment_shader=f"{glsl.prelude.VERSION}\n{glsl.includes.read('probe/block_length.frag')}")
    program["columns"], program["pixels"] = width, width * height
    buffers, texture, array = [ctx.buffer(bytes(4 * n)) for n in words], Texture(device.gl, "rgba8", LENGTH_SIZE), None
    framebuffer = Framebuffer(device.gl, [texture])
    try:
        for binding, buffer in enumerate(buffers):
            buffer.bind_to_storage_buffer(binding)
        framebuffer.use(colour=True, depth=False)
        array = ctx.vertex_array(program, [])
        array.render(mode=4, vertices=3)  # GL_TRIANGLES
        device.gl.glMemoryBarrier(rawgl.BARRIERS["buffer_update"])
        filled, seen = (np.frombuffer(buffer.read(), dtype=np.uint32) for buffer in buffers[1:])
    finally:
        for made in (array, framebuffer, texture, *buffers, program):
            if made is not None:
                made.release()
    wrong, missed = int((seen != SECOND_WORDS).sum()), int((filled != 2).sum())
    return wrong == missed == 0, (f"{wrong} of {len(seen)} invocations see another length, {missed} of {len(filled)} "
                                  "words are skipped; no method asks for it")


def operations(device: Device) -> Outcome:
    """Whether each 32-bit atomic operation takes effect once for every invocation."""
    start = np.array([0, 0, EMPTY, 0, 0, 0], dtype=np.uint32)
    with _drawn(device, SCENE, OPERATIONS, element=start) as frame:
        after, before = frame.words("element"), frame.words("before").reshape(6, INVOCATIONS)
    values = np.arange(1, INVOCATIONS + 1)
    first, swapped = int(after[5]), np.sort(before[5])
    right = {
        "add": after[0] == INVOCATIONS and set(before[0]) == set(values - 1),
        "max": after[1] == INVOCATIONS and before[1].max() < INVOCATIONS,
        "min": after[2] == 1 and before[2].max() == EMPTY,
        "or": after[3] == EMPTY and before[3].min() == 0,
        "exchange": {int(after[4]), *map(int, before[4])} == {0, *range(1, INVOCATIONS + 1)},
        "compare-and-swap": 1 <= first <= INVOCATIONS and swapped[0] == 0 and set(swapped[1:]) == {first},
    }
    return _all(right)


def operations64(device: Device) -> Outcome:
    """Whether each 64-bit operation that methods use compiles, and takes effect once on both words together."""
    start = np.array([0, 0, EMPTY, EMPTY], dtype=np.uint32)
    with _drawn(device, SCENE, OPERATIONS64, wide=start, signed_wide=np.zeros(2, np.uint32)) as frame:
        wide, after = frame.words("wide").reshape(2, 2), frame.words("signed_wide")
        before = frame.words("before").reshape(3, INVOCATIONS, 2)
    chain = [tuple(map(int, pair)) for pair in (*before[2], after)]
    right = {"max": (wide[0] == INVOCATIONS).all(), "min": (wide[1] == 1).all(),
             "exchange": sorted(chain) == [(i, i) for i in range(INVOCATIONS + 1)]}
    return _all(right)


def _all(right: Mapping[str, object]) -> Outcome:
    wrong = [name for name, passed in right.items() if not passed]
    return not wrong, f"wrong: {', '.join(wrong)}" if wrong else f"right: {', '.join(right)}"


def blending(device: Device) -> Outcome:
    """Whether sums and maxima are right in every format that methods blend in."""
    wrong = [f"{format} {equation[0]}" for format in BLENDED for equation, value in ((ADD, 0.75), (MAX, 0.25))
             if not _blends(device, format, equation, value)]
    return not wrong, f"wrong: {', '.join(wrong)}" if wrong else f"sum and maximum right in {', '.join(BLENDED)}"


def _blends(device: Device, format: str, equation: Blend, value: float) -> bool:
    method = probe_method(
        f"blending {format}", Pass("blend", "geometry", "probe/quarter.frag", into=("blended",),
                                   clears={"blended": (0.0,) * 4}, state=State(blend=equation)),
        Pass("show", "fullscreen", "probe/show_blended.frag", reads=("blended",), into=(IMAGE,)),
        targets=(Target("blended", format),))
    with _drawn(device, SCENE, method) as frame:
        return bool(np.abs(frame.image()[..., 0] - value).max() <= STEP)


def queries(device: Device) -> Outcome:
    """Whether samples that pass are counted right, and whether timestamps grow."""
    gl = device.gl
    with ProbeBench(device, SCENE) as bench:
        frame = bench.frame(COUNTED)
        samples, before, after = (gl.generate("Queries") for _ in range(3))
        gl.glQueryCounter(before, rawgl.TIMESTAMP)
        gl.glBeginQuery(rawgl.SAMPLES_PASSED, samples)
        frame.draw()
        gl.glEndQuery(rawgl.SAMPLES_PASSED)
        gl.glQueryCounter(after, rawgl.TIMESTAMP)
        counted, grown = gl.query_result(samples), gl.query_result(after) >= gl.query_result(before)
        for query in (samples, before, after):
            gl.delete("Queries", query)
        frame.release()
        expected = bench.stats.F + 2 * bench.stats.P  # the count, the clear before it and the picture behind it
    return counted == expected and grown, (f"{counted} of {expected} samples counted, timestamps "
                                           f"{'grow' if grown else 'run backwards'}")


def interlock(device: Device) -> Outcome:
    """Whether plain increments under the fragment shader interlock lose nothing."""
    return locked(device, "interlock")


def locked(device: Device, sync: str, config: SceneConfig = SCENE) -> Outcome:
    """Whether plain increments under a lock lose nothing."""
    with ProbeBench(device, config) as bench:
        frame = bench.frame(LOCKED, sync=sync)
        frame.draw()
        total = int(frame.words("counter").sum())
        frame.release()
    return total == bench.stats.F, f"{total} of {bench.stats.F} plain increments under the lock"


def routed(device: Device, multisampling: str) -> Outcome:
    """Whether stencil routing brings every fragment into a sample of its own."""
    with ProbeBench(device, ROUTED_SCENE) as bench:
        frame = bench.frame(ROUTED, multisampling=multisampling)
        frame.draw()
        wrong = conformance(frame.image(), composite(bench.scene))["wrong_pixels"]
        frame.release()
    return wrong == 0, f"{bench.stats.P - wrong} of {bench.stats.P} pixels with every fragment in a sample of its own"


def listed_points(device: Device) -> Outcome:
    """Whether points that a dispatch has listed show what an earlier pass stored, behind a flush where one helps."""
    if device.flushes_points:
        passed, detail = _listed_points(device, flush=True)
        return passed, f"{detail}, behind a flush; without it they are wrong"
    return _listed_points(device, flush=False)


def points_need_a_flush(device: Device) -> bool:
    """Whether the same points are wrong without a flush between the dispatch and the draw."""
    return not _listed_points(device, flush=False)[0]


def _listed_points(device: Device, flush: bool) -> Outcome:
    """A k+-buffer whose k is more than a pixel has, resolved by tiles: a short shader does not show the fault."""
    former = device.__dict__.get("flushes_points")
    device.flushes_points = flush
    try:
        scene = generate(TILES_SCENE)
        with _drawn(device, TILES_SCENE, kplus.METHODS[0], **TILED) as frame:
            wrong = conformance(frame.image(), composite(scene))["wrong_pixels"]
    finally:
        del device.flushes_points
        if former is not None:
            device.flushes_points = former
    pixels = scene.viewport[0] * scene.viewport[1]
    return wrong == 0, f"{pixels - wrong} of {pixels} pixels right that points show after a dispatch"


@contextmanager
def _drawn(device: Device, config: SceneConfig, method: Method, **more) -> Iterator[Frame]:
    """A frame of the scene, once it was drawn; arrays fill the buffers of their name before, others are parameters."""
    arrays = {name: value for name, value in more.items() if isinstance(value, np.ndarray)}
    params = {name: value for name, value in more.items() if name not in arrays}
    with ProbeBench(device, config) as bench:
        frame = bench.frame(method, **params)
        try:
            for name, words in arrays.items():
                frame.fill(name, words)
            device.finish()  # what is asked for before hides some faults
            frame.draw()
            yield frame
        finally:
            frame.release()


TRIALS = (
    Trial("atomic operations", operations),
    Trial("blending", blending),
    Trial("queries", queries),
    Trial("block length", block_length, avoided=True),
    Trial("64-bit atomics", operations64, "shader_atomic_int64"),
    Trial("interlock", interlock, "fragment_shader_interlock"),
    Trial("points after a dispatch", listed_points, TILE_POINTS),
    Trial("stencil of each sample", partial(routed, multisampling="off"), SAMPLE_STENCIL),
)


def failed(device: Device) -> dict[str, str]:
    """The trial that found an offered feature wrong, and what it found, by feature."""
    found = {}
    for trial in TRIALS:
        if trial.feature in device.offered:
            passed, detail = trial.outcome(device)
            if not passed:
                found[trial.feature] = f"the trial {trial.name!r} ({detail})"
    return found
