"""Linked lists of fragments: unsorted with a sorting resolve, or kept sorted by the insertion."""

from __future__ import annotations

from dataclasses import replace

from .shared import K, SORT, clear, resolve, resolve_sorted
from .spec import ON_OFF, Buffer, Grown, Method, Param, Pass, When, when

ORDER = 3

GROWN = Grown(start="P", counter="cell_counter")
COUNTER = Buffer("cell_counter", "1", clear="0u")

# One index space for heads (below P) and links (above), so that a walk treats both alike.
NEXT = Buffer("next", "P + capacity", clear="EMPTY", clear_heads=True)
CELLS = Buffer("cells", "2*capacity", type="uvec2")

RECORDS = Buffer("records", "2*(P + capacity)", type="uint64_t", clear="0", clear_heads=True)
PAYLOAD = Buffer("payload", "capacity")

FETCH = "methods/list/fetch.glsl"
FETCH_PACKED = "methods/list/fetch_packed.glsl"

PACKED = Param("packed", "off", "depth and link in one 64-bit record", choices=ON_OFF,
               needs={"on": "shader_atomic_int64"})
INSERT = Param("insert", "cas32", "sorted insertion by 32-bit compare-and-swap or by 64-bit atomic maximum",
               choices=("cas32", "max64"), needs={"max64": "shader_atomic_int64"})


def only(buffer: Buffer, condition: When) -> Buffer:
    return replace(buffer, when=condition)


def store(shader: str, *buffers: str, **more) -> Pass:
    return Pass("store", "geometry", shader, writes=("cell_counter", *buffers), **more)


def gpupro(method_id: str, name: str, section: str, summary: str, switch: Param, plain: str, wide: str,
           unsorted: bool) -> Method:
    """A method of gpupro5_ch1 §1.2: 32-bit cells where `switch` is at its default, else 64-bit records."""
    other = next(c for c in switch.choices if c != switch.default)
    narrow, broad = when(switch.name, switch.default), when(switch.name, other)
    finish = resolve if unsorted else resolve_sorted
    return Method(
        id=method_id, name=name, family="list", source=f"gpupro5_ch1 {section}", summary=summary,
        guarantee="exact all", words="3*f + 1", ties="kept, in no fixed order",
        params=(switch, SORT) if unsorted else (switch,),
        capacity=GROWN,
        buffers=(COUNTER, only(replace(NEXT, coherent=not unsorted), narrow),
                 only(replace(CELLS, coherent=not unsorted), narrow),
                 only(replace(RECORDS, coherent=not unsorted), broad), only(PAYLOAD, broad)),
        steps=(
            clear("cell_counter", "next", when=narrow),
            clear("cell_counter", "records", when=broad),
            replace(store(plain, "next", "cells", when=narrow), name="build"),
            replace(store(wide, "records", "payload", when=broad), name="build"),
            replace(finish("next", "cells", when=narrow), name="render", fetch=FETCH),
            replace(finish("records", "payload", when=broad), name="render", fetch=FETCH_PACKED),
        ),
    )


METHODS = [
    Method(
        id="ab-ll", name="AB_LL", family="list",
        source="Yang et al. 2010; kplus_2015 §2",
        summary="unsorted linked lists, cells from one shared counter; grown and redone on overflow",
        guarantee="exact all", words="3*f + 1", ties="kept, in order of the links",
        params=(SORT,), capacity=GROWN,
        buffers=(COUNTER, NEXT, CELLS),
        steps=(clear("cell_counter", "next"), store("methods/list/store.frag", "next", "cells"),
               resolve("next", "cells", fetch=FETCH)),
    ),
    gpupro("lin-post", "POST-LIN", "§1.2.1-1.2.2", "unsorted linked lists, sorted when they are rendered",
           PACKED, "methods/list/store.frag", "methods/list/store_packed.frag", unsorted=True),
    gpupro("lin-pre", "PRE-LIN", "§1.2.3", "linked lists kept sorted by the insertion",
           INSERT, "methods/list/insert_cas32.frag", "methods/list/insert_max64.frag", unsorted=False),
    Method(
        id="kb-ab-ll", name="KB-AB_LL", family="list",
        source="Yu et al. 2012; kplus_2015 §2, §5",
        summary="unsorted linked lists of all fragments; the resolve picks the k nearest",
        guarantee="exact k nearest", words="3*f + 1", ties="kept, the first in the list wins the last place",
        params=(K, SORT), capacity=GROWN, local="k",
        buffers=(COUNTER, NEXT, CELLS),
        steps=(clear("cell_counter", "next"), store("methods/list/store.frag", "next", "cells"),
               resolve("next", "cells", select=True, fetch=FETCH)),
    ),
]
