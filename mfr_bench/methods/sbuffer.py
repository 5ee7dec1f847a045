"""S-buffer and l-buffer: a count pass gives each pixel a contiguous range of exactly its fragments."""

from __future__ import annotations

from dataclasses import replace

from .shared import (
    OCCUPANCY,
    OCCUPIED,
    PAYLOAD,
    RESOLVE_OPTIONS,
    REUSE_COUNT,
    UNOCCUPIED,
    K,
    again,
    clear,
    count,
    occupied,
    once,
    resolve,
)
from .shared.screen_region import TOUCHED, in_screen_region
from .spec import ADD, Buffer, Counted, Method, Param, Params, Pass, State, Target

ORDER = 4

COUNTERS = Param("counters", 30, "shared counters S; the paper's frame rate peaks near 30", low=1, high=65536)
MAPPING = Param("mapping", "inverse", "prefix sum over the shared counters from one end, or from both",
                choices=("forward", "inverse"))
HASH = Param("hash", "column", "which counter a pixel uses: its index modulo S, or its tile",
             choices=("column", "tile"))

COUNTING = Param("counting", "atomic", "how the fragments of a pixel are counted: by atomic increments, or by additive "
                 "blending into a texture of floats, which a full-screen pass turns into whole numbers (sbuffer_2012 "
                 "§3.1 names both)", choices=("atomic", "blended"))
COUNTED = Target("counted", "r32f", doc="fragments of each pixel, as a float that blending adds to")

SHARED_COUNTERS = "the shared counters, one word each, a few dozen per frame"

COUNTER = Buffer("counter", "P", clear="0u", doc="fragments of each pixel")
ADDRESS = Buffer("address", "P", doc="next cell of the range of each pixel")
NODES = Buffer("nodes", "2*capacity", type="FRAGMENT", doc="fragments, the range of one pixel after another")
GROUP_TOTAL = Buffer("group_total", "counters", clear="0u", doc="fragments of each group of pixels")
FETCH = "methods/sbuffer/fetch.glsl"
STORE = Pass("store", "geometry", "methods/sbuffer/store.frag", writes=("address", "nodes"))
RESOLVE = resolve("counter", "address", "nodes", fetch=FETCH, texels=("nodes",))


def referencing(bounded: bool = False) -> tuple[Pass, ...]:
    """The passes that give every non-empty pixel its range; with `bounded`, of at most K fragments."""
    defines = {"BOUNDED": int(bounded)}
    more = ("counter",) if bounded else ()
    return (Pass("referencing", "fullscreen", "methods/sbuffer/address.frag", reads=("counter",),
                 writes=("address", "group_total", *more), defines=defines),
            Pass("referencing", "fullscreen", "methods/sbuffer/offset.frag", reads=("counter", "group_total"),
                 writes=("address", "nodes") if bounded else ("address",), defines=defines))


def rewind(name: str, address: str = "address") -> Pass:
    """The pass that takes addresses back to where STORE found them."""
    return again(name, "methods/sbuffer/rewind.frag", address, reads=("counter",))


def _by_counting(step: Pass, scope: Params) -> tuple[Pass, ...]:
    """The passes that count fragments, by COUNTING."""
    if scope.get(COUNTING.name) != "blended":
        return (replace(step, expand=None),)
    whole = "counting by blending clears a target and reads it whole, as its authors' passes do"
    return (replace(step, shader="methods/sbuffer/count_blended.frag", writes=(), into=(COUNTED.name,), whole=whole,
                    clears={COUNTED.name: (0.0,)}, state=State(blend=ADD), targets=(COUNTED,), expand=None),
            Pass(step.name, "fullscreen", "methods/sbuffer/counted.frag", reads=(COUNTED.name,), writes=("counter",),
                 whole=whole))


PLAIN = (*once(replace(count(), expand=_by_counting), *referencing()), rewind("referencing"), STORE)


def occupied_steps() -> tuple[Pass, ...]:
    """`PLAIN` with OCCUPANCY: count and store see the same fragments, and the groups add up to the capacity."""
    *occupancy, counting, storing = occupied(count(), STORE)
    address, offset = referencing()
    counted = once(counting, replace(address, when=UNOCCUPIED), replace(address, totals="group_total", when=OCCUPIED),
                   offset)
    return (*occupancy, *counted, rewind("referencing"), storing)


def sbuffer(method_id: str, name: str, source: str, summary: str, fill: tuple[Pass, ...] = PLAIN,
            finish: Pass = RESOLVE, **more) -> Method:
    return Method(
        id=method_id, name=name, family="sbuffer", source=source, summary=summary,
        words="2*f + 2", capacity=Counted(),
        buffers=(COUNTER, ADDRESS, GROUP_TOTAL, NODES),
        steps=in_screen_region(
            *once(clear("counter", shared=("group_total",))),
            *fill,
            finish,
        ),
        **{"guarantee": "exact all", "ties": "kept, in no fixed order", "beside": SHARED_COUNTERS, **more},
    )


METHODS = [
    sbuffer("ab-sb", "AB_SB", "sbuffer_2012 §3", "S-buffer: ranges from S shared counters, only for non-empty pixels",
            beside=f"{SHARED_COUNTERS}; with counting: blended a texture, one word per pixel",
            params=(COUNTERS, MAPPING, HASH, COUNTING, *RESOLVE_OPTIONS, TOUCHED, REUSE_COUNT, PAYLOAD)),
    sbuffer("ab-lbuffer", "l-buffer", "Lipowski 2010; sbuffer_2012 §2, §4",
            "ranges from one shared counter, only for non-empty pixels",
            params=(*RESOLVE_OPTIONS, TOUCHED, REUSE_COUNT, PAYLOAD),
            fixed=(COUNTERS.at(1), MAPPING.at("forward"), HASH.at("column"))),
    sbuffer("kb-ab-sb", "KB-AB_SB", "kplus_2015 §2, §5", "S-buffer of all fragments; the resolve picks the k nearest",
            fill=occupied_steps(), finish=resolve("counter", "address", "nodes", fetch=FETCH, texels=("nodes",),
                                                   select=True),
            guarantee="exact k nearest",
            ties="kept, in no fixed order; any of them may win the last place", local="k",
            params=(K, COUNTERS, MAPPING, HASH, OCCUPANCY, *RESOLVE_OPTIONS, TOUCHED, REUSE_COUNT, PAYLOAD)),
]
