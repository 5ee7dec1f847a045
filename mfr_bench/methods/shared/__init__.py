"""Parameters and passes that several families share. Each is one declaration over shared shader code."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import partial
from typing import Any

from ..spec import (
    EMPTY,
    IMAGE,
    MAX,
    ON_OFF,
    SAMPLE_STENCIL,
    Buffer,
    Loop,
    Param,
    Params,
    Pass,
    State,
    Stencil,
    Target,
    When,
    when,
)

K = Param("k", 8, "fragments kept per pixel, the nearest", low=1, high=1024)
SYNC = Param("sync", "spin", "mutual exclusion per pixel: spin lock with a semaphore; fragment shader interlock in any "
             "order, or in that of submission, as GL_INTEL_fragment_shader_ordering always has it; or none, to see "
             "what it is there for", choices=("spin", "interlock", "ordered", "none"),
             needs=dict.fromkeys(("interlock", "ordered"), "fragment_shader_interlock"),
             weakens={"none": "fragments of a pixel in flight at once lose each other's changes"})
LOCK = "with sync: spin a semaphore, one word per pixel"
CULLING = Param("culling", "on", "refuse fragments beyond the furthest kept before the critical section",
                choices=ON_OFF)
SORT = Param("sort", "hybrid", "sort of the resolve; hybrid: insertion up to 16 fragments, shell above; lplus: batches "
             "of the nearest 32; register: blocks of at most 32 in registers, merged",
             choices=("insertion", "shell", "hybrid", "bubble", "lplus", "register"))
LOCAL_ARRAY = Param("local_array", 0, "fragments that the resolve's local array holds; 0: as many as a pixel may need, "
                    "with lplus 32; a pixel with more loses them, counted", low=0, high=4096)
BMA = Param("bma", "off", "backwards memory allocation: one resolve for each power of two of fragments, so that a "
            "shallow pixel does not pay for the deepest one's local array", choices=ON_OFF)
STAGE = Param("resolve", "fragment", "the resolve as a full-screen draw, or as a compute shader that writes the image",
              choices=("fragment", "compute"))
STOP_OPACITY = Param("stop_opacity", 1.0, "opacity at which a pixel's compositing, or its peeling, ends; 1: never",
                     real=True, low=0, high=1, closed=True,
                     weakens={"0-0.999999": "fragments behind an opacity of `stop_opacity` may be missing, an error of "
                              "up to 1 - stop_opacity"})
ACCUMULATE = Param(
    "accumulate", "float32", "the colour that fragments are added to, front to back: 32-bit floats; the same with what "
    "each addition rounds away carried along; rounded after each fragment to 16-bit floats, or to 8 bits",
    choices=("float32", "compensated", "float16", "unorm8"),
    weakens={"float16": "rounded to 11 bits after each fragment: a layer behind an opacity of 0.9995 is lost",
             "unorm8": "rounded to 8 bits after each fragment, an error of up to n/510"})
# Of `resolve`; a method may offer some or all.
RESOLVE_OPTIONS = (SORT, LOCAL_ARRAY, BMA, STAGE, ACCUMULATE, STOP_OPACITY)
REUSE_COUNT = Param("reuse_count", "off", "fragments are counted, and ranges made, in every frame (off), or in the "
                    "first frame of a scene for all that follow until it changes (on): frames of a still scene are "
                    "then timed without their count", choices=ON_OFF)
ATOMIC64 = Param("atomic64", "native", "64-bit atomics: the device's own, or emulated by 32-bit ones",
                 choices=("native", "emulated"), needs={"native": "shader_atomic_int64"})
EARLY_CULLING = Param("early_culling", "off", "drop fragments behind an accumulated opacity of `culling_opacity`",
                      choices=ON_OFF,
                      weakens={"on": "fragments behind an opacity of `culling_opacity` may be missing, an error of up "
                                     "to 1 - culling_opacity"})
CULLING_OPACITY = Param("culling_opacity", 0.95, "opacity behind which early culling drops fragments; 0.95 in "
                        "gpupro5_ch1", real=True, low=0, high=1, closed=True, acts=when("early_culling", "on"))
PEELED = Param("layers", 0, "layers peeled at most; 0: all of them", low=0, high=4096)
PAYLOAD = Param("payload", "rgba8", "stored colour, straight: 8 bits a channel; 16-bit floats in two words, in "
                "units of 1/255, which hold an 8-bit colour without error; or two channels, luminance and a blend of "
                "the scene's two base colours, with alpha 24 bits in a word",
                choices=("rgba8", "rgba16f", "two_channel"),
                weakens={"two_channel": "hues come from one plane through the scene's colours; luminance is kept"})

MULTISAMPLING = Param(
    "multisampling", "on", "while fragments are routed. off, as in the source: a fragment covers all samples, whose "
    "stencils GL lets a device test by one of them; on: it covers those that it covers, with depths of any "
    "place in the pixel, right where primitives are flat and meet no pixel but at its edges", choices=ON_OFF,
    needs={"off": SAMPLE_STENCIL}, asks={"on": "flat"})
OCCUPANCY = Param("occupancy", 0, "intervals of the occupancy map, by which fragments beyond the k-th are discarded "
                  "before the store, by early z where the store has no depth or stencil test of its own; 0: none",
                  of=(0, 32, 64, 128), low=0, high=128)

OCCUPANCY_BOUNDS = Param("occupancy_bounds", "geometry", "the depths between which the intervals lie: those of the "
                         "pixel's fragments, for a further geometry pass, or those of a box around the scene, whose "
                         "rectangle is drawn, as in the source", choices=("geometry", "box"),
                         acts=when("occupancy", *(d for d in OCCUPANCY.of if d)))

Expand = Callable[[Pass, Params], tuple[Pass, ...]]

CLEARED = (0.0, 0.0, 0.0, 0.0)
CLEAR_IMAGE = Pass("clear", "clear", clears={IMAGE: CLEARED}, into=(IMAGE,))


def clear(*buffers: str, shared: tuple[str, ...] = (), **more) -> Pass:
    """Full-screen pass that gives the buffers their initial values: each pixel its own, of `shared` every P-th word."""
    step = Pass("clear", "fullscreen", "common/clear.frag", writes=(*shared, *buffers), **more)
    return replace(step, expand=partial(zeroed_apart, shared=shared)) if shared else step


def zeroed_apart(step: Pass, scope: Params, shared: tuple[str, ...]) -> tuple[Pass, ...]:
    """A full-screen clear, and where `touched` leaves pixels out of it, one by the driver of the buffers `shared`."""
    whole = scope.get("touched", "off") == "off"
    own = tuple(name for name in step.writes if whole or name not in shared)
    driver = () if whole else (Pass(step.name, "clear", writes=shared),)
    return (*driver, replace(step, writes=own, defines={**step.defines, "WHOLE": int(whole)}, expand=None))


def expanded(step: Pass, scope: Params, expand: Expand | None) -> tuple[Pass, ...]:
    """What `expand`, the step's own before it was wrapped, makes of it."""
    return expand(step, scope) if expand else (replace(step, expand=None),)


def once(*steps: Pass | Loop) -> tuple[Pass | Loop, ...]:
    """The steps with REUSE_COUNT as their parameter: what they leave must stand, or be restored by `again`."""
    return tuple(replace(s, passes=once(*s.passes)) if isinstance(s, Loop)
                 else replace(s, expand=partial(_once, expand=s.expand)) for s in steps)


def _once(step: Pass, scope: Params, expand: Expand | None) -> tuple[Pass, ...]:
    still = False if scope.get("reuse_count") == "on" else None
    return tuple(replace(p, static=still) for p in expanded(step, scope, expand))


def again(name: str, shader: str, *writes: str, **more) -> Pass:
    """The pass that restores what the frame before has changed of what `once` has made."""
    return Pass(name, "fullscreen", shader, writes=writes, static=True, when=when("reuse_count", "on"), **more)


def wide_buffers(name: str, elements: str, word: str = "0u", condition: When | None = None,
                 native_type: str = "uint64_t", **more) -> tuple[Buffer, ...]:
    """A coherent buffer of 64-bit elements, by ATOMIC64, and the emulation's `wide_lock`.

    common/atomic64.glsl takes elements of the `native_type` uint64_t, common/exchange64.glsl of int64_t.
    `word` is what the clear pass gives to both words of an element. Clear and write `wide_lock` with the buffer.
    An element must be used by the fragments of one pixel only, because the emulation has one lock per pixel.
    """
    native, emulated = (when("atomic64", c) & condition if condition else when("atomic64", c) for c in ATOMIC64.choices)
    words = f"2*({elements})"
    shared = {"coherent": True, **more}
    return (Buffer(name, words, type=native_type, clear=f"packUint2x32(uvec2({word}))", when=native, **shared),
            Buffer(name, words, type="uvec2", clear=word, when=emulated, **shared),
            Buffer("wide_lock", "P", clear="0u", coherent=True, when=emulated))


def routed_targets(samples: str) -> tuple[Target, ...]:
    """Multisample targets for stencil routing: per sample a fragment, 2 words, and depth and stencil, 1 word."""
    return (Target("depths", "r32ui", samples=samples), Target("colours", "r32ui", samples=samples),
            Target("routing", "depth24_stencil8", samples=samples))


def route(samples: str, *more_targets: str, reads: tuple[str, ...] = ()) -> tuple[Pass, ...]:
    """Passes that send the fragments of a pixel to its samples one by one, in order of arrival."""
    into = ("depths", "colours", *more_targets)
    store = Pass("store", "geometry", "methods/routing/store.frag", reads=reads, into=(*into, "routing"),
                 clears=dict.fromkeys(into, (EMPTY,)), defines={"MULTI_PASS": int(bool(more_targets))})
    return (Pass("route", "fullscreen", "methods/routing/start.frag", into=("routing",), clears={"routing": (1.0, 1)},
                 state=State(stencil=Stencil("always", "increment")), vertex="screen/triangles.vert",
                 instances=samples),
            *(replace(store, state=State(stencil=Stencil("equal", "decrement", 2), multisample=choice == "on"),
                      when=when("multisampling", choice)) for choice in MULTISAMPLING.choices))


def count() -> Pass:
    """Geometry pass that counts fragments per pixel, and in total by an occlusion query."""
    return Pass("count", "geometry", "common/count.frag", writes=("counter",), counts=True)


SHADED, STORED = "shaded_fragments", "stored_fragments"  # what `Pass.probes` may count


def count_stored(step: Pass, hazards: bool, room: str = "keep") -> Pass:
    """The pass that counts what the resolve `step` finds of the fragments, at most `room` of a list.

    With `hazards` it asks for each generated fragment whether its pixel holds it, which tells what is doubled or torn.
    """
    kind, shader = ("geometry", "common/found.frag") if hazards else ("fullscreen", "common/stored.frag")
    return replace(step, kind=kind, shader=shader, resolver=None, into=(), state=State(), probes=STORED, expand=None,
                   defines={**step.defines, "HOLDS": room})


def resolve(*reads: str, select: bool = False, hazards: bool = False, defines: Mapping[str, Any] | None = None,
            **more) -> Pass:
    """Pass that sorts and composites what its `fetch` reads; with `select` only the k nearest.

    Its parameters are RESOLVE_OPTIONS. `hazards`: as for `count_stored`.
    """
    return Pass("resolve", "fullscreen", "common/resolve.frag", reads=reads, into=(IMAGE,),
                defines={"SELECT": int(select), "LISTS": 1, **(defines or {})},
                expand=partial(_resolve_passes, hazards=hazards), **more)


def resolve_sorted(*reads: str, resolver: str = "common/resolve_sorted.glsl", hazards: bool = False,
                   mixes: bool = False, **more) -> Pass:
    """Pass that composites fragments which its `fetch` already reads nearest first. Its parameters are STAGE and
    STOP_OPACITY.

    `hazards`: as for `count_stored`. With `mixes` the slots hold more than single fragments, which nobody counts.
    """
    def expand(step: Pass, scope: Params) -> tuple[Pass, ...]:
        return (*(() if mixes else (count_stored(step, hazards),)), *_staged(step, scope))

    return Pass("resolve", "fullscreen", "common/resolve.frag", reads=reads, into=(IMAGE,), resolver=resolver,
                defines={"LISTS": 1}, expand=expand, **more)


def peeling(step: Pass, scope: Params) -> tuple[Pass, ...]:
    """The geometry pass of a peeling that leaves pixels alone once the image has the opacity to stop at."""
    stops = float(scope["stop_opacity"]) < 1
    return (replace(step, reads=step.reads + ((IMAGE,) if stops else ()), expand=None,
                    defines={**step.defines, "STOPS": int(stops)}),)


KTH_DEPTH = Target("kth_depth", "depth32f")
NO_BOUNDS = (-1.0, -1.0, 0.0, 0.0)  # of (-z, z), by MAX blending


OCCUPIED, UNOCCUPIED = when("occupancy", *(d for d in OCCUPANCY.of if d)), when("occupancy", 0)


def occupied(*stores: Pass) -> tuple[Pass, ...]:
    """The store passes of a k-buffer, culled, with what OCCUPANCY puts before them (occupancy_2015); both need K."""
    return (*occupancy_map(), *map(culled, stores))


def occupancy_map() -> tuple[Pass, ...]:
    """The passes that find a depth of each pixel beyond which none of its K nearest fragments is.

    Beside the method's words stand 3 per pixel for the depth bounds and the k-th depth, and a bit per interval.
    """
    on = OCCUPIED
    mask = Buffer("occupied", "occupancy / 32 * P", clear="0u")
    return (
        Pass("occupancy", "fullscreen", "common/clear.frag", writes=("occupied",), buffers=(mask,), when=on),
        Pass("occupancy", "geometry", "common/depth_bounds.frag", into=("bounds",), clears={"bounds": NO_BOUNDS},
             state=State(blend=MAX), targets=(Target("bounds", "rg32f"), KTH_DEPTH), when=on, expand=_bounded),
        Pass("occupancy", "geometry", "common/occupancy/mark.frag", reads=("bounds",), writes=("occupied",), when=on),
        Pass("occupancy", "fullscreen", "common/occupancy/cull.frag", reads=("bounds", "occupied"),
             into=(KTH_DEPTH.name,), state=State(depth_test="always"), when=on),
        _before_kth(Pass("occupancy", "geometry", "common/occupancy/shaded.frag", probes=SHADED, when=on)),
    )


def _bounded(step: Pass, scope: Params) -> tuple[Pass, ...]:
    """The pass that finds the depth bounds of pixels, by OCCUPANCY_BOUNDS from the geometry or from a box around it."""
    if scope.get(OCCUPANCY_BOUNDS.name) != "box":
        return (replace(step, expand=None),)
    return (replace(step, kind="fullscreen", shader="common/occupancy/box.frag", state=State(), region=True,
                    expand=None),)


def culled(store: Pass) -> Pass:
    """A geometry pass that with OCCUPANCY sees no fragment beyond the k-th depth.

    Early z sees to it, except where the depth or stencil test is the pass's own: then its shader does. A stencil
    test comes before the depth test, so that a fragment that early z culls would still take its turn.
    """
    own = store.state.depth_test or store.state.stencil
    restrict = _from_shader if own else _before_kth
    return replace(store, expand=lambda step, scope: (
        (restrict if scope.get("occupancy") else replace)(replace(step, expand=None)),))


def _from_shader(step: Pass) -> Pass:
    """The pass with fragments beyond the k-th depth rejected by its shader."""
    return replace(step, reads=(*step.reads, KTH_DEPTH.name), defines={**step.defines, "CULLS": 1})


def _before_kth(step: Pass) -> Pass:
    """The pass with fragments beyond the k-th depth discarded before its shader.

    An occlusion query would then count fragments that the shader rejects as well, so it gives way to `Pass.totals`.
    """
    return replace(step, into=(*step.into, KTH_DEPTH.name), counts=False,
                   state=replace(step.state, depth_test="lequal", depth_write=False, early=True))


RESOLVERS = {"lplus": "common/resolve_lplus.glsl", "register": "common/resolve_register.glsl"}
RESOLVER = "common/resolve_local.glsl"  # every other sort works in one local array
LPLUS = 32  # l of the l+-depth-sorting (kplus_2015 §4.4)
NARROWEST, WIDEST = 8, 32  # fragments of the smallest and the largest sorting network
TILE = 8  # pixels, side of the square that a work group of the compute resolve shades

# Classes of backwards memory allocation: class i has at most 8 * 2**i fragments; the last has no bound.
CLASS_BOUNDS = tuple(8 << i for i in range(8))
PIXEL_CLASS = Target("pixel_class", "depth32f")  # class / 16 as depth; 1 for an empty pixel


def _resolve_passes(step: Pass, scope: Params, hazards: bool) -> tuple[Pass, ...]:
    sort = scope.get("sort", SORT.default)
    length = str(scope.get("local_array") or ("keep" if sort != "lplus" else f"min({LPLUS}, keep)"))
    counting = count_stored(step, hazards, "keep" if sort == "lplus" else f"min(keep, {length})")
    step = replace(step, resolver=RESOLVERS.get(str(sort), RESOLVER))
    if sort == "register":
        length = f"ceil({length}/{_network(length)})*{_network(length)}"
    if scope.get("bma") != "on":
        return (counting, *_staged(_with_local(step, length), scope))
    return (counting, _classify(step, length), *(p for i in range(len(CLASS_BOUNDS))
                                       for p in _staged(_of_class(step, i, length), scope)))


def _network(length: str) -> str:
    """Fragments that a sorting network for a local array of this length takes at once: 8, 16 or 32."""
    return f"min({WIDEST}, doubled({NARROWEST}, {length}))"


def _with_local(step: Pass, length: str) -> Pass:
    return replace(step, defines={**step.defines, "LOCAL": length, "NETWORK": _network(length)})


def _classify(step: Pass, length: str) -> Pass:
    """Pass that writes every pixel's class as its depth, and clears the image for those without fragments."""
    last = f"min({len(CLASS_BOUNDS) - 1}, ceil(log2(max({CLASS_BOUNDS[0]}, {length}))) - 3)"
    return replace(step, shader="common/classify.frag", resolver=None, into=(IMAGE, PIXEL_CLASS.name),
                   targets=(PIXEL_CLASS,), defines={**step.defines, "LAST_CLASS": last},
                   state=State(depth_test="always"), expand=None)


def _of_class(step: Pass, index: int, length: str) -> Pass:
    """The resolve of one class: the depth test passes its pixels, the local array is as long as they need."""
    last = index == len(CLASS_BOUNDS) - 1
    step = _with_local(step, length if last else f"min({CLASS_BOUNDS[index]}, {length})")
    return replace(step, into=(IMAGE, PIXEL_CLASS.name), defines={**step.defines, "CLASS": index},
                   vertex="screen/triangle_of_class.vert",
                   needed=f"{CLASS_BOUNDS[index - 1]} < {length}" if index else None,
                   state=State(depth_test="equal", depth_write=False, early=True))


def _staged(step: Pass, scope: Params) -> tuple[Pass, ...]:
    """The resolve in the stage that `resolve` asks for."""
    if scope.get("resolve") != "compute":
        return (replace(step, expand=None),)
    classed = PIXEL_CLASS.name in step.into
    return (replace(step, kind="compute", shader="common/resolve.comp", into=(IMAGE,), state=State(), vertex=None,
                    reads=step.reads + ((PIXEL_CLASS.name,) if classed else ()),
                    defines={**step.defines, "TILE": TILE, "CLASSED": int(classed)}, expand=None,
                    groups=f"min(65535, ceil(W/{TILE})*ceil(H/{TILE}))"),)
