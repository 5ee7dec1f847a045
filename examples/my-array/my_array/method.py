"""An A-buffer with an array of fixed length per pixel, to copy and change."""

from __future__ import annotations

from mfr_bench.methods.shared import PAYLOAD, RESOLVE_OPTIONS, clear, resolve
from mfr_bench.methods.shared.screen_region import TOUCHED, in_screen_region
from mfr_bench.methods.spec import Buffer, Method, Pass

ORDER = 10  # the place of the family in the catalog; it comes last without

METHODS = [
    Method(
        # The reader of a table needs these.
        id="my-array", name="My array", family="my_array",
        source="Crassin 2010", summary="n slots per pixel, given out by an atomic counter",
        guarantee="exact all",  # exact all | exact k nearest | exact k best | approximate | none
        ties="kept, in no fixed order",  # what becomes of fragments of equal depth
        words="2*n + 1",  # the paper's own formula, words per pixel, printed next to what is allocated
        # Options that shared code brings: how to sort, which pixels to leave out, what a fragment holds.
        params=(*RESOLVE_OPTIONS, TOUCHED, PAYLOAD),
        # The memory. A formula may use W, H, P (pixels), n (most fragments in a pixel), F (all fragments),
        # f = F/P, capacity, and the parameters.
        buffers=(Buffer("counter", "P", clear="0u", doc="fragments of each pixel"),
                 Buffer("nodes", "2*n*P", type="FRAGMENT", doc="fragments of each pixel, in order of arrival")),
        # The passes that are timed, in order. A buffer that a pass does not name does not exist in its shader.
        steps=in_screen_region(
            clear("counter"),
            Pass("store", "geometry", "methods/my_array/store.frag", writes=("counter", "nodes")),
            resolve("counter", "nodes", fetch="methods/my_array/fetch.glsl", texels=("nodes",)),
        ),
    ),
]
