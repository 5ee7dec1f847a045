"""Trials of what drivers are known to get wrong (docs/drivers.md), each small, with a result that is known.

A feature that a driver claims and that fails its trial counts as missing: methods that need it are unsupported.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial

import numpy as np

from ..errors import MfrError
from ..methods import kplus, lists
from ..methods.shared import ATOMIC64
from ..methods.spec import (
    ADD,
    BEHIND,
    EMPTY,
    FRAMEBUFFER_FETCH,
    IMAGE,
    INVERTED_ALPHA,
    LISTED,
    MAX,
    MSAA_FEATURES,
    NEAREST_33,
    OVER,
    REVEAL,
    SAMPLE_STENCIL,
    SEEN_THROUGH_BOTH,
    TILE_POINTS,
    UNDER,
    Blend,
    Buffer,
    Format,
    Method,
    Pass,
    State,
    Target,
)
from ..oracle.composite import composite
from ..oracle.quality import conformance
from ..oracle.ties import Answer
from ..scene import Scene as SceneConfig
from ..scene import generate
from . import rawgl, samples
from .context import Device
from .frame import Frame
from .probes import COUNTED, LOCKED, ROUTED, ROUTED_SCENE, ProbeBench, probe_method
from .trial_alone import behind_loop, block_length, primitive_numbers, stored_ahead, texture_formats
from .trial_fetch import fetched
from .trial_registers import full_registers
from .trial_triangles import triangles

SCENE = SceneConfig(size=(24, 20), depth_complexity=3)
TILES_SCENE = SceneConfig(size=(3 * LISTED, 2 * LISTED), depth_complexity=5)
TILED = {"touched": "tiles", "k": 8, "sync": "spin", "sort": "insertion"}
SELECTED_SCENE = SceneConfig(size=(9, 6), depth_complexity=32)
SELECTED = {"k": 33, "sort": "register"}
INVOCATIONS = 64
# Formats of targets with how methods blend in them; the image is rgba32f.
BLENDED: tuple[tuple[tuple[Format, ...], State], ...] = (
    *(((format,), State(blend=ADD)) for format in ("rg8", "r16", "r32f", "rg32f", "rgba32f")),
    *(((format,), State(blend=MAX)) for format in ("rg32f", "rgba32f")),
    (("rgba32f",), State(blend=OVER)),
    (("rgba32f",), State(blend=UNDER)),
    (("rgba32f",), State(blend=BEHIND, blend_alpha=SEEN_THROUGH_BOTH)),
    (("rgba32f",), State(blend=("add", "zero", "one"), blend_alpha=INVERTED_ALPHA)),
    (("rgba16f", "r8"), State(blends=(ADD, REVEAL))),
    (("rgba32f", "r32f"), State(blends=(ADD, REVEAL))),
)
STEP = 1 / 255  # of a channel of 8 bits
SOURCE, START = (0.25, 0.5), 0.125  # colour and alpha of each fragment; of the target before

STAGES = {"compute shaders": ("compute", "comp"), "fragment shaders": ("fullscreen", "frag")}
OPERATIONS = {stage: probe_method(
    f"atomic operations in {stage}",
    Pass("apply", kind, f"probe/operations.{ending}", writes=("element", "dedicated", "before"),
         groups="1" if kind == "compute" else None, defines={"INVOCATIONS": INVOCATIONS}, atomics=("dedicated",)),
    buffers=(Buffer("element", "6", coherent=True), Buffer("dedicated", "1"), Buffer("before", f"7*{INVOCATIONS}")),
) for stage, (kind, ending) in STAGES.items()}
OPERATIONS64 = {stage: probe_method(
    f"64-bit atomics in {stage}",
    Pass("apply", kind, f"probe/operations64.{ending}", writes=("words64", "signed64", "before"),
         groups="1" if kind == "compute" else None, defines={"INVOCATIONS": INVOCATIONS}),
    buffers=(Buffer("words64", "4", type="uint64_t", coherent=True),
             Buffer("signed64", "2", type="int64_t", coherent=True),
             Buffer("before", f"6*{INVOCATIONS}", type="uvec2")), params=(ATOMIC64,),
) for stage, (kind, ending) in STAGES.items()}

# A draw that stores, a dispatch, and a draw that stores nothing and shows what it sees in the block `Frame`. The vertex
# shaders read the block as well: otherwise zink takes the dispatch's block, which is the same here.
AFTER_DISPATCH = probe_method(
    "uniform blocks after a dispatch",
    Pass("store", "geometry", "probe/before_dispatch.frag", writes=("drawn",)),
    Pass("dispatch", "compute", "probe/dispatch.comp", writes=("dispatched",), groups="1"),
    Pass("show", "geometry", "probe/after_dispatch.frag", into=(IMAGE,)),
    buffers=(Buffer("drawn", "P"), Buffer("dispatched", "1")))

Outcome = tuple[bool, str]


@dataclass(frozen=True)
class Trial:
    """A check with a known answer, and the feature that methods lose where it fails; None: of all devices.

    `avoided`: no shader depends on it, so that a failure is reported and harms nothing. `spoils`: what alone a failure
    changes.
    """

    name: str
    run: Callable[[Device], Outcome]
    feature: str | None = None
    avoided: bool = False
    spoils: str | None = None

    @property
    def costs(self) -> str | None:
        """The cost of a failure; None: any result may be wrong."""
        if self.avoided:
            return "avoided by all methods"
        if self.spoils:
            return self.spoils
        return f"methods that need {self.feature} are unsupported" if self.feature else None

    def outcome(self, device: Device) -> Outcome:
        """Whether the device passes, and what was seen. A trial that cannot even compile has failed."""
        try:
            return self.run(device)
        except (MfrError, MemoryError) as error:
            return False, str(error)


def operations(device: Device) -> Outcome:
    """Whether each 32-bit atomic operation takes effect once for every invocation, in either kind of shader."""
    return _all({stage: _operations(device, method) for stage, method in OPERATIONS.items()})


def _operations(device: Device, method: Method) -> dict[str, bool]:
    start = np.array([0, 0, EMPTY, 0, 0, 0], dtype=np.uint32)
    with _drawn(device, SCENE, method, element=start, dedicated=np.zeros(1, np.uint32)) as frame:
        after, dedicated = frame.words("element"), int(frame.words("dedicated")[0])
        before = frame.words("before").reshape(7, INVOCATIONS)
    values = np.arange(1, INVOCATIONS + 1)
    first, swapped = int(after[5]), np.sort(before[5])
    return {
        "add": after[0] == INVOCATIONS and set(before[0]) == set(values - 1),
        "max": after[1] == INVOCATIONS and sum(before[1] == 0) == 1 and before[1][-1] < INVOCATIONS,
        "min": after[2] == 1 and sum(before[2] == EMPTY) == 1 and before[2][0] > 1,
        "or": after[3] == EMPTY and sum(before[3] == 0) == 1,
        "exchange": {int(after[4]), *map(int, before[4])} == {0, *range(1, INVOCATIONS + 1)},
        "compare-and-swap": 1 <= first <= INVOCATIONS and swapped[0] == 0 and set(swapped[1:]) == {first},
        "counter": dedicated == INVOCATIONS and set(before[6]) == set(values - 1),
    }


def operations64(device: Device) -> Outcome:
    """Whether each 64-bit operation that methods use compiles, and takes effect once on both words together."""
    return _all({stage: _operations64(device, method) for stage, method in OPERATIONS64.items()})


def _operations64(device: Device, method: Method) -> dict[str, bool]:
    start = np.array([0, 0, EMPTY, EMPTY], dtype=np.uint32)
    with _drawn(device, SCENE, method, words64=start, signed64=np.zeros(2, np.uint32)) as frame:
        words64, after = frame.words("words64").reshape(2, 2), frame.words("signed64")
        before = frame.words("before").reshape(3, INVOCATIONS, 2)
    chain = [tuple(map(int, pair)) for pair in (*before[2], after)]
    return {"max": bool((words64[0] == INVOCATIONS).all()), "min": bool((words64[1] == 1).all()),
            "exchange": sorted(chain) == [(i, i) for i in range(INVOCATIONS + 1)]}


def _all(right: Mapping[str, Mapping[str, bool]]) -> Outcome:
    """The outcome of operations, by kind of shader and name."""
    wrong = [f"{name} in {stage}" for stage, passed in right.items() for name in passed if not passed[name]]
    names = dict.fromkeys(name for passed in right.values() for name in passed)
    return not wrong, f"wrong: {', '.join(wrong)}" if wrong else f"right in {' and '.join(right)}: {', '.join(names)}"


def blending(device: Device) -> Outcome:
    """Whether each way of blending that methods use is right in each format that they use it in."""
    wrong = [_words_of(formats, state) for formats, state in BLENDED if not _blends(device, formats, state)]
    return not wrong, f"wrong: {', '.join(wrong)}" if wrong else f"{len(BLENDED)} of {len(BLENDED)} ways right"


def _words_of(formats: tuple[str, ...], state: State) -> str:
    alpha = f", alpha {' '.join(state.blend_alpha)}" if state.blend_alpha else ""
    return " and ".join(" ".join((format, *blend)) for format, blend
                        in zip(formats, _blends_of(state), strict=True)) + alpha


def _blends_of(state: State) -> tuple[Blend, ...]:
    """The equation of each target, in their order."""
    return (state.blend,) if state.blend else state.blends


def _blends(device: Device, formats: tuple[Format, ...], state: State) -> bool:
    names = ("blended", "beside")[:len(formats)]
    defines = {"BESIDE": len(formats) - 1}
    method = probe_method(
        f"blending {_words_of(formats, state)}",
        Pass("blend", "geometry", "probe/blend.frag", into=names, state=state, defines=defines,
             clears=dict.fromkeys(names, (START,) * 4)),
        Pass("show", "fullscreen", "probe/show_blended.frag", reads=names, into=(IMAGE,), defines=defines),
        targets=tuple(Target(name, format) for name, format in zip(names, formats, strict=True)))
    with _drawn(device, SCENE, method) as frame:
        image = frame.image()
    expected = [_blended(blend, state.blend_alpha) for blend in _blends_of(state)]
    seen = [(image[..., channel], colour) for channel, (colour, _) in enumerate(expected)]
    if formats[0].startswith("rgba"):
        seen.append((image[..., 3], expected[0][1]))
    return all(np.abs(channel - value).max() <= STEP for channel, value in seen)


def _blended(blend: Blend, alpha_factors: tuple[str, str] | None) -> tuple[float, float]:
    """Colour and alpha of a target once every fragment of a pixel was blended into it."""
    colour = alpha = START
    for _ in range(SCENE.depth_complexity):
        colour, alpha = (_applied(blend, SOURCE[0], colour, alpha),
                         _applied((blend[0], *(alpha_factors or blend[1:])), SOURCE[1], alpha, alpha))
    return colour, alpha


def _applied(blend: Blend, source: float, stored: float, stored_alpha: float) -> float:
    """The definition of OpenGL 4.3, section 17.3.8: a maximum has no factors."""
    equation, *factors = blend
    if equation == "max":
        return max(source, stored)
    known = {"zero": 0.0, "one": 1.0, "one_minus_src_alpha": 1 - SOURCE[1], "dst_alpha": stored_alpha,
             "one_minus_dst_alpha": 1 - stored_alpha}
    return source * known[factors[0]] + stored * known[factors[1]]


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
        wrong = conformance(frame.image(), Answer.only(composite(bench.scene)))["wrong_pixels"]
        frame.release()
    return wrong == 0, f"{bench.stats.P - wrong} of {bench.stats.P} pixels with every fragment in a sample of its own"


def uniform_blocks(device: Device) -> Outcome:
    """Whether a draw after a dispatch reads its uniform block, not a buffer of the dispatch."""
    with _drawn(device, SCENE, AFTER_DISPATCH) as frame:
        image = frame.image()
    width, height = SCENE.size
    wrong = int((image[..., :3] != (width, height, width * height)).any(axis=-1).sum())
    return wrong == 0, (f"{width * height - wrong} of {width * height} pixels see the block after a dispatch"
                        f"{_flushed(device)}")


def listed_points(device: Device) -> Outcome:
    """Whether points that a dispatch has listed show what an earlier pass stored: a k+-buffer, resolved by tiles."""
    passed, detail = _shown(device, TILES_SCENE, kplus.METHODS[0], **TILED)
    return passed, f"{detail} that points show after a dispatch{_flushed(device)}"


def selected(device: Device) -> Outcome:
    """Whether the nearest 33 of a list, sorted in registers, are all of the 32 that a pixel has.

    This is the method of linked lists that keeps the k nearest: with less in its program, or another k, the fault that
    it shows is gone.
    """
    passed, detail = _shown(device, SELECTED_SCENE, lists.METHODS[-1], **SELECTED)
    return passed, f"{detail} that keep the nearest 33 of a list, sorted in registers"


def _shown(device: Device, config: SceneConfig, method: Method, **params) -> Outcome:
    """Whether the method's image of the scene is that of all its fragments, and in how many pixels."""
    scene = generate(config)
    with _drawn(device, config, method, **params) as frame:
        wrong = conformance(frame.image(), Answer.only(composite(scene)))["wrong_pixels"]
    pixels = scene.viewport[0] * scene.viewport[1]
    return wrong == 0, f"{pixels - wrong} of {pixels} pixels right"


def _flushed(device: Device) -> str:
    return ", behind a flush, which this driver needs there" if device.flushes_dispatches else ""


def dispatches_need_a_flush(device: Device) -> bool:
    """Whether a draw after a dispatch is wrong without a flush between them; of points only where they are wanted."""
    device.flushes_dispatches = False  # while this is found out
    try:
        return not (uniform_blocks(device)[0] and (not device.wants(TILE_POINTS) or listed_points(device)[0]))
    finally:
        del device.flushes_dispatches


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
            frame.draw_fitting()
            yield frame
        finally:
            frame.release()


TRIALS = (
    Trial("atomic operations", operations),
    Trial("blending", blending),
    Trial("queries", queries),
    Trial("full registers", full_registers),
    Trial("block length", block_length, avoided=True),
    Trial("primitive numbers", primitive_numbers, avoided=True),
    Trial("elements behind a loop", behind_loop, avoided=True),
    Trial("local arrays in a loop", stored_ahead, avoided=True),
    Trial("textures of one buffer", texture_formats, avoided=True),
    Trial("64-bit atomics", operations64, "shader_atomic_int64"),
    Trial("interlock", interlock, "fragment_shader_interlock"),
    Trial("framebuffer fetch", fetched, FRAMEBUFFER_FETCH,
          spoils="fragments of shallow pixels are stored in memory where they would be kept in the framebuffer"),
    Trial("uniform blocks after a dispatch", uniform_blocks),
    Trial("points after a dispatch", listed_points, TILE_POINTS),
    Trial("nearest 33 in registers", selected, NEAREST_33),
    *(Trial(f"coverage masks of {count} samples", partial(samples.tried, samples=count), feature)
      for count, feature in MSAA_FEATURES.items()),
    Trial("stencil of each sample", partial(routed, multisampling="off"), SAMPLE_STENCIL),
    Trial("triangles", triangles,
          spoils="meshes have the fragments that this device makes of them, and methods are checked against these"),
)


def failed(device: Device) -> dict[str, str]:
    """The trial that found an offered feature wrong that is wanted, and what it found, by feature."""
    found = {}
    for trial in TRIALS:
        if trial.feature in device.offered and device.wants(trial.feature):
            passed, detail = trial.outcome(device)
            if not passed:
                found[trial.feature] = f"the trial {trial.name!r} ({detail})"
    return found
