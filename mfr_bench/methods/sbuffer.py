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
from .spec import Buffer, Counted, Method, Param, Pass

ORDER = 4

COUNTERS = Param("counters", 30, "shared counters S; the paper's frame rate peaks near 30", low=1, high=65536)
MAPPING = Param("mapping", "inverse", "prefix sum over the shared counters from one end, or from both",
                choices=("forward", "inverse"))
HASH = Param("hash", "column", "which counter a pixel uses: its index modulo S, or its tile",
             choices=("column", "tile"))

SHARED_COUNTERS = "the shared counters, one word each, a few dozen per frame"

COUNTER = Buffer("counter", "P", clear="0u", doc="fragments of each pixel")
ADDRESS = Buffer("address", "P", doc="next cell of the range of each pixel")
NODES = Buffer("nodes", "2*capacity", type="FRAGMENT", doc="fragments, the range of one pixel after another")
GROUP_TOTAL = Buffer("group_total", "counters", clear="0u", doc="fragments of each group of pixels")
FETCH = "methods/sbuffer/fetch.glsl"
STORE = Pass("store", "geometry", "methods/sbuffer/store.frag", writes=("address", "nodes"))
RESOLVE = resolve("counter", "address", "nodes", fetch=FETCH)


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


PLAIN = (*once(count(), *referencing()), rewind("referencing"), STORE)


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
        words="2*f + 2", beside=SHARED_COUNTERS, capacity=Counted(),
        buffers=(COUNTER, ADDRESS, GROUP_TOTAL, NODES),
        steps=in_screen_region(
            *once(clear("counter", shared=("group_total",))),
            *fill,
            finish,
        ),
        **{"guarantee": "exact all", "ties": "kept, in no fixed order", **more},
    )


METHODS = [
    sbuffer("ab-sb", "AB_SB", "sbuffer_2012 §3", "S-buffer: ranges from S shared counters, only for non-empty pixels",
            params=(COUNTERS, MAPPING, HASH, *RESOLVE_OPTIONS, TOUCHED, REUSE_COUNT, PAYLOAD)),
    sbuffer("ab-lbuffer", "l-buffer", "Lipowski 2010; sbuffer_2012 §2, §4",
            "ranges from one shared counter, only for non-empty pixels",
            params=(*RESOLVE_OPTIONS, TOUCHED, REUSE_COUNT, PAYLOAD),
            fixed=(COUNTERS.at(1), MAPPING.at("forward"), HASH.at("column"))),
    sbuffer("kb-ab-sb", "KB-AB_SB", "kplus_2015 §2, §5", "S-buffer of all fragments; the resolve picks the k nearest",
            fill=occupied_steps(), finish=resolve("counter", "address", "nodes", fetch=FETCH, select=True),
            guarantee="exact k nearest",
            ties="kept; the first to arrive wins the last place", local="k",
            params=(K, COUNTERS, MAPPING, HASH, OCCUPANCY, *RESOLVE_OPTIONS, TOUCHED, REUSE_COUNT, PAYLOAD)),
]
