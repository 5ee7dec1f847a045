"""An A-buffer whose pixels share the order of their tile, since neighbours have nearly the same fragments.

Of each tile one pixel's slots are sorted. The other pixels composite their fragments in that order of slots, mended in
a small window. Where the window is too narrow a pixel is sorted by itself, so that the image is exact in any case.
"""

from __future__ import annotations

from dataclasses import replace

from .shared import ACCUMULATE, PAYLOAD, SORT, STAGE, STOP_OPACITY, TILE, clear, resolve
from .shared.clearing import expanded
from .shared.screen_region import in_screen_region, without_tiles
from .spec import Buffer, Method, Param, Params, Pass, when

ORDER = 2.5

WINDOW = Param("window", 4, "fragments of the window in which a pixel mends the order of its tile", low=1, high=16)
TOUCHED = without_tiles("since an order is that of a tile of its own size")

MOST_ORDERED = 1024  # fragments of the pixel that leads a tile: with them 8 KiB of shared memory
ORDERED = f"min(n, {MOST_ORDERED})"
COLUMNS = f"ceil(W/{TILE})"
TILES = f"{COLUMNS}*ceil(H/{TILE})"
ORDERERS = 64  # tiles that a work group orders, one for each invocation

SLOTS = {"SLOTS": "n"}
ALONE = resolve("counter", "nodes", fetch="methods/array/fetch.glsl", texels=("nodes",), defines=SLOTS)
IN_ORDER = {"TILE": TILE, "TILE_COLUMNS": COLUMNS, "TILE_COUNT": TILES, "ORDERED": ORDERED}
ORDER_TILES = Pass("order", "compute", "methods/coherent/order.comp", reads=("counter", "nodes"), texels=("nodes",),
                   writes=("tile_order",), groups=f"min(65535, ceil({TILES}/{ORDERERS}))",
                   defines={**IN_ORDER, "LOCAL": ORDERED, "ORDERERS": ORDERERS,
                            "SORT_INSERTION": 0, "SORT_SHELL": 0, "SORT_BUBBLE": 0},
                   when=when("resolve", "fragment"))


def _in_order(step: Pass, scope: Params) -> tuple[Pass, ...]:
    """The passes by which each pixel would be sorted by itself, which try the order of its tile first."""
    return tuple(p if p.probes else _trying(p) for p in expanded(step, scope, ALONE.expand))


def _trying(step: Pass) -> Pass:
    by_tile = step.kind == "compute"
    return replace(step, shader=f"methods/coherent/resolve.{'comp' if by_tile else 'frag'}",
                   reads=step.reads if by_tile else (*step.reads, "tile_order"), defines={**step.defines, **IN_ORDER})


METHODS = [
    Method(
        id="ab-coherent", name="AB_Array, tile's order", family="coherent",
        source="a tile's order for its pixels: Jakubowski 2024 (LucidRaster); storage: Crassin 2010",
        summary="n slots per pixel; of each tile one pixel is sorted, whose order the others take and mend in a window",
        guarantee="exact all", words="2*n + 1", ties="kept, in no fixed order",
        beside=f"with resolve: fragment the order of each tile of {TILE} x {TILE} pixels, n + 1 words, up to "
               f"{MOST_ORDERED + 1}",
        params=(WINDOW, SORT, STAGE, ACCUMULATE, STOP_OPACITY, TOUCHED, PAYLOAD),
        buffers=(Buffer("counter", "P", clear="0u", doc="fragments of each pixel"),
                 Buffer("nodes", "2*n*P", type="FRAGMENT", doc="fragments of each pixel, in order of arrival"),
                 Buffer("tile_order", f"{TILES}*(1 + {ORDERED})", when=when("resolve", "fragment"),
                        doc="number of ordered slots of each tile, then these slots, nearest first")),
        steps=in_screen_region(
            clear("counter"),
            Pass("store", "geometry", "methods/array/store.frag", writes=("counter", "nodes"), defines=SLOTS),
            ORDER_TILES,
            replace(ALONE, expand=_in_order),
        ),
    ),
]
