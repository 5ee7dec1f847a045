"""k+-buffers: the k best fragments, kept unsorted in a bounded structure under mutual exclusion.

Slot 0 of a pixel holds the worst of its k fragments, and is empty until the other slots are taken: the test before
the lock then needs that one slot, and no order between it and a counter. The paper keeps the furthest in slot 0 from
the first fragment on, which is the same set in the end.

`peel-kplus` has no occupancy map: a map of k intervals holds for one iteration, since what lies beyond the k-th depth
is what the next one is for, and two geometry passes to make it anew cost an iteration twice what they could save.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from math import inf

from .sbuffer import ADDRESS, COUNTERS, GROUP_TOTAL, HASH, MAPPING, SHARED_COUNTERS, referencing
from .shared import (
    BOUND,
    CLEAR_IMAGE,
    CULLING,
    OCCUPANCY,
    OCCUPANCY_BOUNDS,
    PAYLOAD,
    PEELED,
    RESOLVE_OPTIONS,
    REUSE_COUNT,
    SEMAPHORE,
    SORT,
    SYNC,
    K,
    again,
    clear,
    count,
    occupied,
    once,
    resolve,
)
from .shared.prediction import BINS, fragments_in, largest_k, predict_k
from .shared.screen_region import TOUCHED, in_screen_region
from .spec import (
    PAYLOAD_WORDS,
    UNDER,
    Buffer,
    Choice,
    Counted,
    Decided,
    Loop,
    Method,
    Param,
    Params,
    Pass,
    State,
    when,
)

ORDER = 7

STRUCTURE = Param("structure", "array", "how the k fragments are kept: max-array, max-heap, or a heap where a pixel "
                  "has at least k > 16 fragments", choices=("array", "heap", "adaptive"))
CRITERION = Param("criterion", "nearest", "which k fragments are the best: nearest, furthest, or most opaque",
                  choices=("nearest", "furthest", "opaque"))
MEMORY_MB = Param("memory_mb", 200.0, "memory budget M_b in MiB; where it is not given, no more than a run allows any "
                  "method", real=True, low=0, high=2**20)
HIT_RATIO = Param("hit_ratio", 0.95, "robustness ratio R_h: share of the fragments that should be kept", real=True,
                  low=0, high=1)

SUMS = Param("sums", "pixel", "where the totals of the groups before a pixel's own are added to its address: once for "
             "each pixel, or for each fragment that is stored, as in the authors' renderer",
             choices=("pixel", "fragment"))

COUNTER = Buffer("counter", "P", clear="0u", coherent=True, doc="slots taken (upper bits) and fragments counted")
NODES = Buffer("nodes", "2*k*P", type="FRAGMENT", clear="EMPTY", clear_heads=True, coherent=True,
               doc="k best fragments of each pixel, the worst first")
RANGES = replace(NODES, words="2*capacity", clear=None, clear_heads=False,
                 doc="best fragments, the range of one pixel after another, the worst of each first")
HISTOGRAM = Buffer("histogram", str(BINS), clear="0u", doc="pixels with 1, 2, … fragments; the last bin also more")

SLOTTED_WORDS = "counter and semaphore are the 2 words; with an interlock only the counter"
RANGED_WORDS = ("the 3 words are address, semaphore, and a counter of both the fragments counted and the slots taken; "
                f"in addition {SHARED_COUNTERS}")
TIES = "kept; for the k-th place the lesser payload stays"
FETCH = "methods/kplus/fetch.glsl"
EXACT_RANGES = {"EXACT_RANGES": 1}
PER_PIXEL = {"EXACT_RANGES": 0}


def store(shader: str = "methods/kplus/store.frag", **more) -> Pass:
    return Pass("store", "geometry", shader, writes=("counter", "semaphore", "nodes"), **more)


def by_sums(step: Pass) -> tuple[Pass, ...]:
    """The pass with the addresses that SUMS gives: whole ones, or places within groups, which need the totals."""
    return (step.only(when(SUMS.name, "pixel")),
            replace(step, reads=(*step.reads, GROUP_TOTAL.name)).only(when(SUMS.name, "fragment")))


def kplus(method_id: str, name: str, section: str, summary: str, *params: Param, fixed: tuple[Param, ...],
          occupancy: Param = OCCUPANCY, **more) -> Method:
    """A k+-buffer of k slots per pixel."""
    shader = more.pop("shader", "methods/kplus/store.frag")
    return Method(
        id=method_id, name=name, family="kplus", source=f"kplus_2015 {section}", summary=summary,
        words="2*k + 2", local="k", fixed=fixed,
        params=(K, BOUND, *params, SYNC, CULLING, occupancy, OCCUPANCY_BOUNDS, *RESOLVE_OPTIONS, TOUCHED, PAYLOAD),
        buffers=(COUNTER, SEMAPHORE, NODES),
        steps=in_screen_region(
            clear("counter", "semaphore", "nodes"),
            *occupied(store(shader, defines=PER_PIXEL)),
            resolve("counter", "nodes", fetch=FETCH, texels=("nodes",), defines=PER_PIXEL),
        ),
        **{"guarantee": "exact k nearest", "ties": TIES, "beside": SLOTTED_WORDS, **more},
    )


def ranged(method_id: str, name: str, section: str, summary: str, counting: tuple[Pass, ...],
           params: tuple[Param, ...], buffers: tuple[Buffer, ...] = (), **more) -> Method:
    """A k+-buffer in contiguous ranges of exactly the fragments that are kept, sized by the passes `counting`."""
    return Method(
        id=method_id, name=name, family="kplus", source=f"kplus_2015 {section}", summary=summary,
        guarantee="exact k nearest", ties=TIES,
        params=(*params, SYNC, CULLING, COUNTERS, HASH.at("tile"), SUMS, OCCUPANCY, *RESOLVE_OPTIONS, TOUCHED,
                REUSE_COUNT, PAYLOAD),
        fixed=(STRUCTURE.at("adaptive"), CRITERION, MAPPING),
        buffers=(COUNTER, ADDRESS, SEMAPHORE, GROUP_TOTAL, RANGES, *buffers),
        steps=in_screen_region(
            *once(clear("counter", "semaphore", shared=("group_total", *(b.name for b in buffers))), *counting,
                  *referencing(bounded=True)),
            *by_sums(again("referencing", "methods/kplus/empty.frag", "counter", "nodes", reads=("address",),
                           defines=EXACT_RANGES)),
            *occupied(*by_sums(store(reads=("address",), defines=EXACT_RANGES))),
            *by_sums(resolve("counter", "address", "nodes", fetch=FETCH, texels=("nodes",), defines=EXACT_RANGES)),
        ),
        **more,
    )


def predicted(counts: Sequence[int], fragments: int, pixels: int, params: Params) -> Choice:
    """k of `kplus-sb-dynamic`: 4 bytes for each word of a fragment, and of a pixel's counter, address and semaphore."""
    pixel_bytes = 12 if params["sync"] == "spin" else 8
    fragment_bytes = 4 * (1 + PAYLOAD_WORDS[str(params["payload"])])
    room = fragments_in(float(params["memory_mb"]), pixels, fragment_bytes, pixel_bytes)
    return predict_k(counts, fragments, float(params["hit_ratio"]), room)


def predicted_slots(counts: Sequence[int], fragments: int, pixels: int, params: Params) -> Choice:
    """k of a k+-buffer of fixed slots: Eq. 6 up to the k_b of Eq. 5, with counter and semaphore in each pixel."""
    pixel_bytes = 8 if params["sync"] == "spin" else 4
    fragment_bytes = 4 * (1 + PAYLOAD_WORDS[str(params["payload"])])
    most = min(BINS, largest_k(float(params["memory_mb"]), pixels, fragment_bytes, pixel_bytes))
    k = predict_k(counts, fragments, float(params["hit_ratio"]), inf, most).k
    return Choice(k, k * pixels)


def slotted_dynamic(method_id: str, name: str, structure: str) -> Method:
    """A k+-buffer of k slots per pixel whose k is predicted within the frame, from a further geometry pass."""
    return Method(
        id=method_id, name=name, family="kplus", source="kplus_2015 §4.2, Eq. 4 to 6",
        summary=f"max-{structure} with k from the depth-complexity histogram, by a memory budget that bounds the slots "
                "of every pixel and a hit ratio",
        guarantee="exact k nearest", ties=TIES, words="2*k + 2", local=f"min(n, {BINS})",
        beside="counter and semaphore are the 2 words; 4 KiB of histogram per frame (§5.2)",
        fixed=(STRUCTURE.at(structure), CRITERION),
        capacity=Decided("histogram", predicted_slots, MEMORY_MB.name, 4 * BINS),
        params=(MEMORY_MB, HIT_RATIO, SYNC, CULLING, OCCUPANCY, *RESOLVE_OPTIONS, TOUCHED, PAYLOAD),
        buffers=(COUNTER, SEMAPHORE, replace(NODES, words="2*capacity"), HISTOGRAM),
        steps=in_screen_region(
            clear("counter", shared=("histogram",)),
            count(),
            HISTOGRAM_PASS,
            clear("counter", "semaphore", "nodes"),
            *occupied(store(defines=PER_PIXEL)),
            resolve("counter", "nodes", fetch=FETCH, texels=("nodes",), defines=PER_PIXEL),
        ),
    )


COUNT = replace(count(), shader="methods/kplus/count.frag")
HISTOGRAM_PASS = Pass("histogram", "fullscreen", "methods/kplus/histogram.frag", reads=("counter",),
                      writes=("histogram",), decides=True)

MULTI_PASS = Method(
    id="peel-kplus", name="multi-pass K+B-Array", family="kplus", source="kplus_2015 §4.3", merges=True,
    summary="each iteration keeps and composites the k nearest fragments beyond the furthest of the last",
    guarantee="exact all", words="2*k + 5",
    beside="no row of Table 1: 2k + 2, and 3 for the boundary between iterations, a fragment and how often it was "
           "composited",
    cost="one geometry pass for every k layers, and all k+ insertions in each",
    ties="kept; across two iterations in order of payload, within one in order of the slots",
    params=(replace(K, doc="fragments peeled per pixel and iteration"), BOUND, SYNC, SORT, PEELED, TOUCHED),
    most_layers="ceil(layers / k) * k",
    fixed=(STRUCTURE, CRITERION, CULLING), local="k",
    buffers=(COUNTER, SEMAPHORE, NODES,
             Buffer("last", "2*P", type="uvec2", clear="0u", doc="furthest fragment composited; EMPTY if all are"),
             Buffer("repeats", "P", clear="0u", doc="fragments equal to the last that were composited")),
    steps=in_screen_region(
        CLEAR_IMAGE,
        clear("counter", "semaphore", "nodes", "last", "repeats"),
        Loop((
            store("methods/kplus/store_beyond.frag", reads=("last", "repeats"), defines=PER_PIXEL),
            resolve("counter", "nodes", fetch=FETCH, texels=("nodes",), defines=PER_PIXEL, state=State(blend=UNDER)),
            Pass("advance", "fullscreen", "methods/kplus/advance.frag",
                 writes=("counter", "nodes", "last", "repeats"), defines=PER_PIXEL, counts=True),
        ), times="min(ceil(n / k), ceil(layers / k) or ceil(n / k))"),
    ),
)

METHODS = [
    kplus("kplus-array", "K+B-Array", "§3, Alg. 1 and 2",
          "max-array: the furthest of the k fragments stands first, the others unsorted", fixed=(STRUCTURE, CRITERION)),
    kplus("kplus-array-r", "K+B-Array-R", "§3.2.1, Alg. 2",
          "max-array whose first k-1 fragments take their slots without the lock", fixed=(STRUCTURE, CRITERION),
          beside=f"{SLOTTED_WORDS}. A direct insertion takes two atomics and a barrier where Alg. 2 has one: the "
                 "second tells slots that are written from those that are taken, without which a search for the worst "
                 "fragment may meet a slot that is not written yet",
          shader="methods/kplus/store_revised.frag"),
    kplus("kplus-heap", "K+B-Heap", "§3, Alg. 1 and 2",
          "max-heap: the furthest of the k fragments stands first; meant for k > 16",
          fixed=(STRUCTURE.at("heap"), CRITERION)),
    kplus("kplus-generic", "generalized K+B", "§3.2.2, Eq. 2",
          "the k best fragments by a criterion, composited by depth", CRITERION, STRUCTURE, fixed=(),
          occupancy=replace(OCCUPANCY, acts=when("criterion", "nearest")),
          guarantee="exact k best",
          ties="kept; for the k-th place the nearer stays, then the lesser payload"),
    ranged("kplus-sb", "K+B-AB_SB", "§4.1, Alg. 3",
           "contiguous ranges of min(f, k) fragments from a bounded count; array or heap for each pixel",
           (COUNT,), (K,), capacity=Counted("bounded(k)"), words="2*f_k + 3", local="k", beside=RANGED_WORDS),
    ranged("kplus-sb-dynamic", "dynamic K+B-AB_SB", "§4.2, Eq. 6 and 7, Alg. 3",
           "the same, with k from the depth-complexity histogram by a memory budget and a hit ratio",
           (count(), HISTOGRAM_PASS), (MEMORY_MB, HIT_RATIO), (HISTOGRAM,),
           capacity=Decided("histogram", predicted, MEMORY_MB.name, 4 * (BINS + COUNTERS.default)),
           words="2*f_k + 3", local=f"min(n, {BINS})",
           beside=f"{RANGED_WORDS}; 4 KiB of histogram per frame (§5.2)"),
    slotted_dynamic("kplus-array-dynamic", "dynamic K+B-Array", "array"),
    slotted_dynamic("kplus-heap-dynamic", "dynamic K+B-Heap", "heap"),
    MULTI_PASS,
]
