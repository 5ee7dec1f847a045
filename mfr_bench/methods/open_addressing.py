"""Open addressing: fragments of all pixels in one hash table, with ages and eviction in place of links.

A cell is the paper's: age in 8 bits, inverted depth in 24, payload in 32. 24 bits of fixed-point depth keep the order
without loss for depths on a grid of 2^-24 but 1 - 2^-24, as the quad scenes' grid of 2^-23 is; a fragment off the
grid counts as lost, so that no order is wrong without notice. More than 32 bits of payload have no place (§1.3).

Words: 2 per cell, and one per pixel for the table A of ages. The table is made for `load_factor`, which takes the
number of fragments as known from the frame before; it has a cell per pixel at least, or ages would not name pixels,
and 256, or probes of a pixel would meet in a cell.
Beside the formula stand 256 probe offsets, which each frame draws anew from those before (§1.3.1), and the counter.
With `atomic64: emulated` a cell is one word, the index of a record of two: 3 words per cell. No lock guards it, since
fragments of many pixels meet in a cell.

A build is interrupted above a load of 10/16 (above `load_factor` where that is more), or where a fragment finds no
place within 255 ages; the table is then doubled. With a load l all over the viewport ages reach about
-n ln(1 - l) / l, so 8 bits end near n = 180 for a load of 0.5 and n = 224 for a quarter; deeper pixels are refused.
Above a load of 0.85 a chain of evictions may take more steps than a loop is allowed, which doubles the table as well.
In these cases more is allocated than declared, and the row's bytes say so.

The table belongs to no single pixel, so that with `touched` its clear stays whole.
"""

from __future__ import annotations

from dataclasses import replace

from .lists import RENDERS, rendered
from .shared import (
    ATOMIC64,
    CULLING_OPACITY,
    EARLY_CULLING,
    RESOLVE_OPTIONS,
    STAGE,
    STOP_OPACITY,
    clear,
    resolve,
    resolve_sorted,
)
from .shared.screen_region import TOUCHED, in_screen_region
from .spec import Buffer, Grown, Method, Param, Pass, when

ORDER = 3

MOST_AGES = 256
DEEPEST = 224  # fragments of a pixel
APART = f"hash3(i, seed, offsets[i]) % (capacity / {MOST_AGES}u) * {MOST_AGES}u + i"  # offsets, no two of them equal

NATIVE, EMULATED = when("atomic64", "native"), when("atomic64", "emulated")
LOAD_FACTOR = Param("load_factor", 0.5, "fragments per cell of the table", low=0, high=1, real=True)
ORDER_KEPT = Param("order", "sorted", "whether the build keeps a pixel's cells sorted", choices=("sorted", "unsorted"))
FETCH = "methods/open/fetch.glsl"


def open_addressing(method_id: str, name: str, section: str, summary: str, order: str, finish: Pass,
                    **more) -> Method:
    return Method(
        id=method_id, name=name, family="open", source=f"gpupro5_ch1 {section}", summary=summary,
        guarantee="exact all", words="2*f/load_factor + 1",
        beside="256 probe offsets and the counter, per frame; a cell per pixel, and 256, at least; emulated 3 words "
               "per cell, an index and a record of two", fixed=(ORDER_KEPT.at(order),), deepest=DEEPEST,
        capacity=Grown(start=f"max(P, {MOST_AGES}, ceil(F/load_factor))", counter="cell_counter"),
        buffers=(Buffer("cell_counter", "1", clear="0u", coherent=True, doc="cells of the table that are occupied"),
                 Buffer("ages", "P", clear="0u", coherent=True, doc="age of the oldest fragment of each pixel"),
                 Buffer("offsets", str(MOST_AGES), clear=APART,
                        doc="offset of the probe sequence for each age"),
                 Buffer("cells", "2*capacity", type="uint64_t", clear="0", coherent=True, when=NATIVE,
                        doc="hash table: age, inverted depth and colour of a fragment; 0 is an empty cell"),
                 Buffer("cells", "capacity", clear="0u", coherent=True, when=EMULATED,
                        doc="hash table: 1 + index of a record; 0 is an empty cell"),
                 Buffer("records", "2*capacity", type="uvec2", coherent=True, when=EMULATED,
                        doc="age, inverted depth and colour of the fragments in the table"),
                 Buffer("record_counter", "1", clear="0u", when=EMULATED, doc="records given out")),
        steps=(
            replace(clear("cell_counter", "ages", "offsets", "cells", "record_counter"),
                    shader="methods/open/clear.frag", whole="the table belongs to no single pixel"),
            Pass("build", "geometry", "methods/open/insert.frag", reads=("offsets",),
                 writes=("cell_counter", "ages", "cells", "records", "record_counter"),
                 defines={"LOAD_LIMIT": "ceil(65536*max(10/16, load_factor))"}),
            *in_screen_region(rendered(finish)),
        ),
        **more,
    )


READS = ("ages", "offsets", "cells", "records")
TABLE = {"fetch": FETCH, "texels": ("cells", "records")}

METHODS = [
    open_addressing("open-post", "POST-OPEN", "§1.3.1-1.3.2",
                    "one hash table for all pixels, evicting younger fragments; sorted when rendered",
                    "unsorted", resolve(*READS, **TABLE), ties="kept, in no fixed order",
                    cost="fragments are evicted and placed anew, with an atomic maximum for each cell tried, which "
                         "emulated is a loop of its own: open addressing is the slower allocation (gpupro5_ch1 §1.8)",
                    params=(LOAD_FACTOR, ATOMIC64, RENDERS, *RESOLVE_OPTIONS, TOUCHED)),
    open_addressing("open-pre", "PRE-OPEN", "§1.3.3",
                    "one hash table for all pixels, evicting younger fragments; kept sorted by the insertion",
                    "sorted", resolve_sorted(*READS, **TABLE), ties="kept, the larger payload as a number first",
                    cost="every fragment traverses its pixel's whole list in global memory by evictions, quadratic in "
                         "its fragments, with an atomic maximum each step: the method that depth complexity hits "
                         "hardest (gpupro5_ch1 §1.7.2, Figure 1.6)",
                    params=(LOAD_FACTOR, ATOMIC64, EARLY_CULLING, CULLING_OPACITY, RENDERS, STAGE,
                            STOP_OPACITY, TOUCHED)),
]
