"""S-buffer and l-buffer: a count pass gives each pixel a contiguous range of exactly its fragments.

Beside the 2f + 2 words of kplus_2015, Table 1, stand the shared counters: one word each, a few dozen per frame.
"""

from __future__ import annotations

from .shared import SORT, clear, count, resolve
from .spec import Buffer, Counted, Method, Param, Pass

ORDER = 4

COUNTERS = Param("counters", 30, "shared counters S; the paper's frame rate peaks near 30", low=1, high=65536)
MAPPING = Param("mapping", "inverse", "prefix sum over the shared counters from one end, or from both",
                choices=("forward", "inverse"))
HASH = Param("hash", "column", "which counter a pixel uses: its index modulo S, or its tile",
             choices=("column", "tile"))

COUNTER = Buffer("counter", "P", clear="0u")
ADDRESS = Buffer("address", "P")
NODES = Buffer("nodes", "2*capacity", type="uvec2")
FETCH = "methods/sbuffer/fetch.glsl"
STORE = Pass("store", "geometry", "methods/sbuffer/store.frag", writes=("address", "nodes"))
RESOLVE = resolve("counter", "address", "nodes", fetch=FETCH)


def sbuffer(method_id: str, name: str, source: str, summary: str, **parameters) -> Method:
    return Method(
        id=method_id, name=name, family="sbuffer", source=source, summary=summary,
        guarantee="exact all", words="2*f + 2", ties="kept, in order of arrival", capacity=Counted(),
        buffers=(COUNTER, ADDRESS, Buffer("group_total", "counters", clear="0u"), NODES),
        steps=(
            clear("counter", "group_total"),
            count(),
            Pass("referencing", "fullscreen", "methods/sbuffer/address.frag", reads=("counter",),
                 writes=("address", "group_total")),
            Pass("referencing", "fullscreen", "methods/sbuffer/offset.frag", reads=("counter", "group_total"),
                 writes=("address",)),
            STORE,
            RESOLVE,
        ),
        **parameters,
    )


METHODS = [
    sbuffer("ab-sb", "AB_SB", "sbuffer_2012 §3", "S-buffer: ranges from S shared counters, only for non-empty pixels",
            params=(COUNTERS, MAPPING, HASH, SORT)),
    sbuffer("ab-lbuffer", "l-buffer", "Lipowski 2010; sbuffer_2012 §2, §4",
            "ranges from one shared counter, only for non-empty pixels",
            params=(SORT,), fixed=(COUNTERS.at(1), MAPPING.at("forward"), HASH.at("column"))),
]
