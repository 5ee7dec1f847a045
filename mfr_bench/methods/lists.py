"""Linked lists of fragments: unsorted with a sorting resolve, or kept sorted by the insertion.

Words in addition to those of kplus_2015, Table 1 (3f + 1), by option:
- `allocation: paged`: whole pages of 4 cells per pixel, and one word per pixel for its next cell and the lock.
- `packed: on`, `insert: max64`: 64-bit records for cells and heads, 3f + 2; gpupro5_ch1 has no formula.
- `atomic64: emulated`: a lock per pixel.
- `early_culling: on` and `occupancy` take no cell for what they drop, so less may be allocated than for all fragments.
"""

from __future__ import annotations

from dataclasses import replace
from functools import partial

from .shared import (
    ATOMIC64,
    CULLING_OPACITY,
    EARLY_CULLING,
    OCCUPANCY,
    PAYLOAD,
    RESOLVE_OPTIONS,
    STAGE,
    STOP_OPACITY,
    K,
    buffers_of_64_bits,
    clear,
    expanded,
    occupied,
    resolve,
    resolve_sorted,
)
from .shared.clearing import Expand
from .shared.screen_region import TOUCHED, in_screen_region
from .spec import NEAREST_33, ON_OFF, SPARE_CELLS, Buffer, Grown, Method, Param, Params, Pass, when

ORDER = 3

PAGE = 4  # cells (Crassin 2010; gpupro5_ch1 §1.2)
PAGED = {"PAGE": PAGE}

GROWN = Grown(start="P", counter="cell_counter")
GROWN_IN_PAGES = replace(GROWN, wanted=f"paged({PAGE})")
GROWN_EITHER_WAY = replace(GROWN, wanted=f"paged({PAGE}) if allocation == 'paged' else F")

COUNTER = Buffer("cell_counter", "1", clear="0u", doc="cells given out, or asked for beyond the capacity")
# One index space for heads and links, so that a walk treats both alike.
NEXT = Buffer("next", "buckets*P + capacity", clear="EMPTY", clear_heads="BUCKETS",
              doc="head of each list, then the link of each cell")
CELLS = Buffer("cells", "2*capacity", type="FRAGMENT", doc="fragments, each in its cell")
PLACE = Buffer("place", "P", clear="0u", coherent=True, doc="next cell of each pixel in its page, and the lock")
COLOURS = Buffer("payload", "capacity", type="PAYLOAD", coherent=True, doc="colour of each cell")

FETCH = "methods/list/fetch.glsl"
FETCH_PACKED = "methods/list/fetch_packed.glsl"

# The one k whose program a driver is known to compile wrongly (docs/drivers.md).
SELECTED_K = replace(K, needs={"33": NEAREST_33}, needs_where=when("sort", "auto", "register"))
PACKED = Param("packed", "off", "depth and link in one 64-bit record", choices=ON_OFF)
INSERT = Param("insert", "cas32", "sorted insertion by 32-bit compare-and-swap or by 64-bit atomic maximum",
               choices=("cas32", "max64"))
ALLOCATION = Param("allocation", "counter", "cells one by one from a counter in storage, or from a dedicated atomic "
                   "counter of the language (gpupro5_ch1 §1.2); or in pages of 4 of a pixel",
                   choices=("counter", "dedicated", "paged"))
MAXIMUM = Param("maximum", "atomic", "how the depth bounds are found: by the device's atomic minimum and maximum, or "
                "by a compare-and-swap in a loop, which emulates them (gpupro5_ch1 §1.6)",
                choices=("atomic", "compare_and_swap"))
BUCKETS = Param("buckets", 4, "lists per pixel, by equal ranges of its depths", low=2, high=32)
RENDERS = Param("renders", 1, "render passes on what one build has left, as slices of a model need (gpupro5_ch1 "
                "§1.1.2); each sorts anew what is not kept sorted", low=1, high=64)
ONE_BY_ONE, ONE_LIST = ALLOCATION.at("counter"), BUCKETS.at(1)


def store(shader: str, *buffers: str, name: str = "store", **more) -> Pass:
    return Pass(name, "geometry", shader, writes=("cell_counter", *buffers), defines=PAGED, expand=_counted, **more)


def _counted(step: Pass, scope: Params) -> tuple[Pass, ...]:
    """The pass with the counter as the shader sees it, by ALLOCATION."""
    atomics = ("cell_counter",) if scope.get("allocation") == "dedicated" else ()
    return (replace(step, atomics=atomics, expand=None),)


def rendered(step: Pass) -> Pass:
    """The pass by the name that gpupro5_ch1 gives it, as often as RENDERS says; each leaves the same image."""
    return replace(step, name="render", expand=partial(_repeated, expand=step.expand))


def _repeated(step: Pass, scope: Params, expand: Expand | None) -> tuple[Pass, ...]:
    passes = expanded(step, scope, expand)
    again = tuple(p for p in passes if p.probes is None)
    return passes + again * (int(scope["renders"]) - 1)


def gpupro(method_id: str, name: str, section: str, summary: str, switch: Param, plain: str, packed: str,
           packed_type: str, unsorted: bool, **more) -> Method:
    """A method of gpupro5_ch1 §1.2: 32-bit cells if `switch` is at its default, otherwise 64-bit records.

    The shader `packed` uses records of `packed_type`.
    """
    other = next(c for c in switch.choices if c != switch.default)
    narrow, broad = when(switch.name, switch.default), when(switch.name, other)
    finish = resolve if unsorted else resolve_sorted
    return Method(
        id=method_id, name=name, family="list", source=f"gpupro5_ch1 {section}", summary=summary,
        guarantee="exact all", words="3*f + 1", ties="kept, in no fixed order",
        beside=f"{SPARE_CELLS}; 64-bit records take 3f + 2, and emulated a lock per pixel",
        buffers=(COUNTER, replace(NEXT, coherent=not unsorted, when=narrow),
                 replace(CELLS, coherent=not unsorted, when=narrow),
                 *buffers_of_64_bits("records", "P + capacity", condition=broad, native_type=packed_type,
                                     clear_heads=True,
                                     doc="head of each list, then each cell: link, and inverted depth"),
                 replace(COLOURS, when=broad), replace(PLACE, when=when("allocation", "paged"))),
        steps=in_screen_region(
            clear("next", "records", "lock64", "place", shared=("cell_counter",)),
            store(plain, "next", "cells", "place", name="build", when=narrow),
            store(packed, "records", "payload", "place", "lock64", name="build", when=broad),
            rendered(finish("next", "cells", when=narrow, fetch=FETCH, texels=("next", "cells"))),
            rendered(finish("records", "payload", when=broad, fetch=FETCH_PACKED, texels=("records", "payload"))),
        ),
        **more,
    )


METHODS = [
    Method(
        id="ab-ll", name="AB_LL", family="list",
        source="Yang et al. 2010; kplus_2015 §2",
        summary="unsorted linked lists, cells from one shared counter; grown and redone on overflow",
        guarantee="exact all", words="3*f + 1", beside=SPARE_CELLS, ties="kept, in no fixed order",
        params=(*RESOLVE_OPTIONS, TOUCHED, PAYLOAD), fixed=(ONE_BY_ONE, ONE_LIST), capacity=GROWN,
        buffers=(COUNTER, NEXT, CELLS),
        steps=in_screen_region(clear("next", shared=("cell_counter",)),
                       store("methods/list/store.frag", "next", "cells"),
                       resolve("next", "cells", fetch=FETCH, texels=("next", "cells"))),
    ),
    Method(
        id="ab-ll-paged", name="LL-Paged", family="list",
        source="Crassin 2010; gpupro5_ch1 §1.2; kplus_2014 (LL-Paged)",
        summary="linked lists of pages of 4 fragments; a lock per pixel only while a page is taken",
        guarantee="exact all", words=f"(2 + 1/{PAGE})*paged({PAGE})/P + 1", ties="kept, in no fixed order",
        beside=f"a link per page in place of one per cell, Crassin's page, counter and lock of a pixel in one word; "
               f"in addition {SPARE_CELLS}",
        params=(*RESOLVE_OPTIONS, TOUCHED, PAYLOAD), fixed=(ALLOCATION.at("paged"), ONE_LIST), capacity=GROWN_IN_PAGES,
        buffers=(COUNTER, PLACE, Buffer("page_link", f"ceil(capacity/{PAGE})",
                                        doc="value of `place` before each page was taken"), CELLS),
        steps=in_screen_region(clear("place", shared=("cell_counter",)),
                       store("methods/list/store_paged.frag", "place", "page_link", "cells"),
                       resolve("place", "page_link", "cells", fetch="methods/list/fetch_paged.glsl",
                               texels=("page_link", "cells"), defines=PAGED)),
    ),
    Method(
        id="ab-ll-bucket", name="AB_LL-BUN", family="list", merges=True,
        source="Vasilakis and Fudos 2013; kplus_2015 §2",
        summary="several linked lists per pixel by depth range, after a pass for the depth bounds; smaller sorts",
        guarantee="exact all", words="3*f + buckets + 2", beside=SPARE_CELLS, ties="kept, in no fixed order",
        params=(BUCKETS, MAXIMUM, *RESOLVE_OPTIONS, TOUCHED, PAYLOAD), fixed=(ONE_BY_ONE,), capacity=GROWN,
        buffers=(COUNTER, Buffer("nearest", "P", clear="EMPTY", doc="nearest depth of each pixel"),
                 Buffer("furthest", "P", clear="0u", doc="furthest depth of each pixel"), NEXT, CELLS),
        steps=in_screen_region(clear("next", "nearest", "furthest", shared=("cell_counter",)),
                       Pass("bounds", "geometry", "methods/list/bounds.frag", writes=("nearest", "furthest")),
                       store("methods/list/store.frag", "next", "cells", reads=("nearest", "furthest")),
                       resolve("next", "cells", fetch="methods/list/fetch_buckets.glsl", texels=("next", "cells"),
                               defines={"LISTS": "buckets"})),
    ),
    gpupro("lin-post", "POST-LIN", "§1.2.1-1.2.2", "unsorted linked lists, sorted when they are rendered",
           PACKED, "methods/list/store.frag", "methods/list/store_packed.frag", "int64_t", unsorted=True,
           params=(PACKED, replace(ATOMIC64, acts=when("packed", "on")), ALLOCATION, RENDERS, *RESOLVE_OPTIONS, TOUCHED,
                   PAYLOAD),
           fixed=(ONE_LIST,), capacity=GROWN_EITHER_WAY),
    gpupro("lin-pre", "PRE-LIN", "§1.2.3",
           "linked lists kept sorted by the insertion, which walks them in global memory",
           INSERT, "methods/list/insert_cas32.frag", "methods/list/insert_max64.frag", "uint64_t",
           unsorted=False,
           cost="each insertion walks the pixel's list in global memory, quadratic in its fragments; early culling "
                "shortens the walk (gpupro5_ch1 §1.1.2, §1.7.2)",
           params=(INSERT, replace(ATOMIC64, acts=when("insert", "max64")), ALLOCATION, EARLY_CULLING, CULLING_OPACITY,
                   RENDERS, STAGE, STOP_OPACITY, TOUCHED, PAYLOAD),
           fixed=(ONE_LIST,), capacity=GROWN_EITHER_WAY),
    Method(
        id="kb-ab-ll", name="KB-AB_LL", family="list",
        source="Yu et al. 2012; kplus_2015 §2, §5",
        summary="unsorted linked lists of all fragments; the resolve picks the k nearest",
        guarantee="exact k nearest", words="3*f + 1", beside=SPARE_CELLS,
        ties="kept, in no fixed order; any of them may win the last place",
        params=(SELECTED_K, OCCUPANCY, *RESOLVE_OPTIONS, TOUCHED, PAYLOAD), fixed=(ONE_BY_ONE, ONE_LIST),
        capacity=GROWN,
        local="k",
        buffers=(COUNTER, NEXT, CELLS),
        steps=in_screen_region(clear("next", shared=("cell_counter",)),
                       *occupied(store("methods/list/store.frag", "next", "cells")),
                       resolve("next", "cells", select=True, fetch=FETCH, texels=("next", "cells"))),
    ),
]
