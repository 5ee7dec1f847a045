"""KB-LL: a linked list in order of depth, built directly.

3f + 6 words per pixel: a cell is depth, colour and link, and so is each of the two sentinels of a list.
"""

from __future__ import annotations

from functools import partial

from .shared import BOUND, OCCUPANCY, STAGE, STOP_OPACITY, K, occupied, resolve_sorted, zeroed_apart
from .shared.screen_region import TOUCHED, in_screen_region
from .spec import SPARE_CELLS, Buffer, Grown, Method, Param, Pass

ORDER = 6

RETRIES = Param("retries", 200, "failed swaps after which a fragment is lost; the papers bound them without a number",
                low=1, high=60000)

METHODS = [
    Method(
        id="kb-ll", name="KB-LL", family="ll",
        source="Yu et al. 2012; kplus_2015 §2, §5",
        summary="depth-ordered linked lists by compare-and-swap; a fragment behind k nearer ones is not linked",
        counts_losses=True, guarantee="approximate",
        failure="a fragment whose swap fails `retries` times is lost, and counted; exact where none is",
        words="3*f + 6", beside=SPARE_CELLS,
        ties="kept, in order of arrival; the first to arrive has the k-th place",
        params=(K, BOUND, RETRIES, OCCUPANCY, STAGE, STOP_OPACITY, TOUCHED), local="k",
        capacity=Grown(start="P", counter="cell_counter"),
        buffers=(Buffer("cell_counter", "1", doc="cells given out"),
                 Buffer("next", "2*P + capacity", coherent=True, doc="link of each node: heads, tails, then cells"),
                 Buffer("cells", "2*(2*P + capacity)", type="uvec2", coherent=True,
                        doc="depth and colour of each node: heads, tails, then cells")),
        steps=in_screen_region(
            Pass("clear", "fullscreen", "methods/ll/clear.frag", writes=("cell_counter", "next", "cells"),
                 expand=partial(zeroed_apart, shared=("cell_counter",))),
            *occupied(Pass("store", "geometry", "methods/ll/store.frag", writes=("cell_counter", "next", "cells"),
                           defines={"ALLOCATION_PAGED": 0})),
            resolve_sorted("next", "cells", fetch="methods/ll/fetch.glsl", texels=("next", "cells"), hazards=True),
        ),
    ),
]
