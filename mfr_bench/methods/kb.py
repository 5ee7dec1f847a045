"""k-buffers with read-modify-write hazards, from before shaders could exclude one another, and their repairs.

They aim at the k nearest fragments and are right where the fragments of a pixel come one by one; what the hazards
cost is measured, not promised. Words are those of Table 1 of kplus_2015 without attribute packing, `beside` says
where more is stored.

The original stores a pixel's slots in render targets that the shader reads and writes at once, at most 8 of them,
or 16 packed; here they are storage buffers, with the same lack of exclusion, kept to the same 16. A greater k
in one pass needs features that no GL device is known to offer: 16 draw buffers, targets of 64 samples.

With `per_pass` the geometry is drawn again for what a pass has no room for, as the sources do (kplus_2015 §2,
sbuffer_2012 §4). Each pass of KB keeps the nearest fragments beyond the furthest of the pass before and composites them
behind its image. Each pass of KB-SR takes the next fragments to arrive, as peel-srab does; all are sorted at the end.
"""

from __future__ import annotations

from dataclasses import replace

from .shared import (
    ARRIVALS,
    BOUND,
    CLEAR_IMAGE,
    COLLECTED,
    IN_ORDER,
    MULTISAMPLING,
    OCCUPANCY,
    RESOLVE_OPTIONS,
    RESUME,
    STAGE,
    STOP_OPACITY,
    TIES_OF_INSERTION,
    K,
    clear,
    collected,
    culled,
    occupancy_map,
    occupied,
    resolve,
    resolve_collected,
    resolve_sorted,
    route,
    routed_targets,
)
from .shared.screen_region import TOUCHED, in_screen_region
from .spec import SAMPLE_FEATURES, UNDER, Above, Buffer, Loop, Method, Param, Pass, State, Target, When, when

ORDER = 6

K16 = replace(K, needs={"17-1024": "draw_buffers_16"})
K32 = replace(K, doc="fragments kept per pixel, the first to arrive",
              needs={"1-4": "samples_4", "5-8": "samples_8", "9-16": "samples_16", "17-32": "samples_32",
                     "33-1024": "samples_64"})
AT_ONCE, IN_PASSES = when("per_pass", 0), when("per_pass", *range(1, 33))
PER_PASS = Param("per_pass", 0, "fragments that a geometry pass keeps, 8 in the sources; where k is more, further "
                 "passes keep those beyond, until there are k, rounded up to whole passes; 0: all k in one pass",
                 of=(0, 2, 4, 8, 16), low=0, high=16, acts=Above("k", "per_pass"))
SAMPLES_PER_PASS = replace(PER_PASS, doc="samples of a pixel, fragments that a geometry pass takes; where k is more, "
                           "further passes take the next to arrive, until there are k; 0: all k in one pass",
                           of=(0, *SAMPLE_FEATURES.values()), high=32,
                           needs={str(count): feature for feature, count in SAMPLE_FEATURES.items()})
IN_A_PASS = "per_pass or k"  # fragments that a pass keeps
SLOTS, SAMPLES = f"({IN_A_PASS})", f"doubled(4, {IN_A_PASS})"
PASSES = Param("passes", 16, "most geometry passes; as many as k repair every hazard, 1 repairs the nearest layer")

NODES = Buffer("nodes", "2*k*P", type="uvec2", clear="uvec2(EMPTY, 0u)", coherent=True,
               doc="k nearest fragments of each pixel, sorted unless hazards occur")
FIRST_DEPTH = Buffer("first_depth", "P", clear="0u", when=IN_PASSES,
                     doc="least depth of the fragments that no pass has composited yet; EMPTY where there are none")
HAZARD = "fragments of a pixel in flight at once lose each other's changes: fragments go missing or stand twice"


def only(where: When, *steps: Pass) -> tuple[Pass, ...]:
    """The passes, which run only if this condition holds as well."""
    return tuple(step.only(where) for step in steps)


def kept_sorted(**more) -> Pass:
    """The resolve of the sorted slots of a pixel."""
    return resolve_sorted("nodes", fetch="methods/ps/fetch.glsl", texels=("nodes",), hazards=True, **more)


METHODS = [
    Method(
        id="kb", name="KB", family="kb",
        source="Callahan et al. 2005; Bavoil et al. 2007; kplus_2015 §2",
        summary="k slots per pixel, sorted insertion without exclusion",
        guarantee="approximate", words="2*k",
        ties=f"{TIES_OF_INSERTION}; with several passes, those that find no slot beside their equals are lost",
        failure=f"{HAZARD}; right where a device shades the fragments of a pixel one by one",
        params=(replace(K16, needs_where=AT_ONCE), BOUND, PER_PASS,
                *(replace(option, acts=AT_ONCE) for option in (OCCUPANCY, STAGE, STOP_OPACITY)), TOUCHED),
        local=SLOTS, most_layers=f"ceil(k / {SLOTS}) * {SLOTS}",
        beside="with per_pass the slots of one pass, and a word per pixel for the depth at which the next one begins",
        buffers=(replace(NODES, words=f"2*{SLOTS}*P"), FIRST_DEPTH),
        steps=in_screen_region(
            *only(AT_ONCE, clear("nodes"),
                  *occupied(Pass("store", "geometry", "methods/kb/store.frag", writes=("nodes",))), kept_sorted()),
            *only(IN_PASSES, CLEAR_IMAGE, clear("nodes", "first_depth")),
            Loop(only(
                IN_PASSES,
                Pass("store", "geometry", "methods/kb/store_beyond.frag", reads=("first_depth",), writes=("nodes",),
                     defines={"K": SLOTS}),
                kept_sorted(state=State(blend=UNDER), defines={"K": SLOTS}),
                Pass("advance", "fullscreen", "methods/kb/advance.frag", writes=("nodes", "first_depth"),
                     defines={"K": SLOTS}, counts=True),
            ), times=f"ceil(min(n, k) / {SLOTS})"),
        ),
    ),
    Method(
        id="kb-multi", name="KB-Multi", family="kb",
        source="Liu et al. 2009; kplus_2015 §2, Table 1",
        summary="k-buffer repaired by further geometry passes: what is missing is inserted again, its nearest by the "
                "depth test, until an occlusion query finds nothing missing",
        guarantee="approximate", words="2*k", loses_ties=True, spoils_ties=True,
        ties="one of them is kept; each pass takes another for missing, so that hazards may tear what lies behind",
        failure="with fewer passes than k, fragments that hazards lost may still be missing behind the nearest "
                "`passes`; right with k passes, and wherever a pass finds nothing missing",
        exact_where="passes >= min(k, n)",
        params=(K16, BOUND, PASSES, OCCUPANCY, STAGE, STOP_OPACITY, TOUCHED), local="k",
        beside="2 words per pixel: depth and colour of the nearest fragment that was missing, which the hardware finds "
               "for certain",
        buffers=(NODES,),
        targets=(Target("layer", "r32ui", doc="colour of the nearest missing fragment"),
                 Target("layer_depth", "depth32f", doc="depth of the nearest missing fragment")),
        steps=in_screen_region(
            clear("nodes"),
            *occupancy_map(),
            Loop((
                culled(Pass("store", "geometry", "methods/kb/repair.frag", writes=("nodes",),
                            into=("layer", "layer_depth"), clears={"layer": (0,), "layer_depth": (1.0,)},
                            state=State(depth_test="lequal"), counts=True)),
                Pass("tidy", "fullscreen", "methods/kb/tidy.frag", reads=("layer", "layer_depth"), writes=("nodes",),
                     defines={"LOCAL": "k + 1"}),
            ), times="min(passes, k)"),
            kept_sorted(),
        ),
    ),
    Method(
        id="kb-sr", name="KB-SR", family="kb",
        source="Bavoil & Myers 2008; kplus_2015 §2, Table 1",
        summary="stencil routing into the samples of multisample targets: the first k fragments to arrive",
        guarantee="approximate", words="3*k", ties="kept, in no fixed order",
        failure="keeps the first k fragments to arrive, not the nearest (with occupancy, the first of those that are "
                "not culled); right where f <= k or the scene is sorted "
                "front to back",
        exact_where="n <= k",
        params=(replace(K32, needs_where=AT_ONCE), SAMPLES_PER_PASS, MULTISAMPLING, replace(OCCUPANCY, acts=AT_ONCE),
                *RESOLVE_OPTIONS, TOUCHED), local="k",
        beside="3 words for each sample that k leaves unused: samples come in powers of two from 4. With per_pass the "
               "samples of one pass, and what peel-srab has: a word for each of them, an array of k fragments, and "
               "for each pixel where the next pass resumes and how many fragments it has",
        targets=(*routed_targets(SAMPLES), replace(ARRIVALS, samples=SAMPLES, when=IN_PASSES)),
        buffers=tuple(replace(b, words=words, when=IN_PASSES) for b, words in (
            (COLLECTED, "P"), (RESUME, "P"), (IN_ORDER, "2*min(n, k)*P"))),
        steps=in_screen_region(
            *only(AT_ONCE, *occupancy_map(),
                  *(culled(p) if p.kind == "geometry" else p for p in route(SAMPLES)),
                  resolve("depths", "colours", fetch="methods/routing/fetch.glsl", hazards=True)),
            *only(IN_PASSES, clear("counter", "resume")),
            Loop(only(IN_PASSES, *collected(SAMPLES, "min(n, k)")), times=f"ceil(min(n, k) / {SLOTS})"),
            *only(IN_PASSES, resolve_collected("min(n, k)")),
        ),
    ),
    Method(
        id="kb-mha", name="KB-MHA (reconstruction)", family="kb",
        source="Zhang 2014; kplus_2015 §2, Table 1; the code of the depths is not public",
        summary="k-buffer whose slots carry a code of depth and colour; a slot torn by a hazard is detected by it and "
                "counts as empty",
        guarantee="approximate", words="2*k", ties="kept, in no fixed order",
        failure=f"{HAZARD}, and one torn slot in four passes for whole; right where a device shades the fragments of "
                "a pixel one by one",
        params=(K16, BOUND, OCCUPANCY, *RESOLVE_OPTIONS, TOUCHED), local="k",
        buffers=(Buffer("depths", "k*P", clear="EMPTY", coherent=True,
                        doc="depths of the k slots, with a code of depth and colour in two bits"),
                 Buffer("colours", "k*P", coherent=True, doc="colours of the k slots")),
        steps=in_screen_region(
            clear("depths"),
            *occupied(Pass("store", "geometry", "methods/kb/store_coded.frag", writes=("depths", "colours"))),
            resolve("depths", "colours", fetch="methods/kb/fetch_coded.glsl", texels=("depths", "colours"),
                    hazards=True),
        ),
    ),
]
