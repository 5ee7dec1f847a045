"""PreCalc: ranges from a prefix sum of the counters over all pixels, empty ones included.

PreCalc_Fixed needs n beforehand and no count pass: the paper calls it a one-pass scheme, whose referencing is one
full-screen pass. A prefix sum goes over all pixels, so that with `touched` the clear and the scan stay whole.
"""

from __future__ import annotations

from dataclasses import replace

from .sbuffer import ADDRESS, COUNTER, NODES, RESOLVE, STORE, rewind
from .shared import (
    PAYLOAD,
    RESOLVE_OPTIONS,
    REUSE_COUNT,
    clear,
    count,
    once,
    resolve,
)
from .shared.screen_region import TOUCHED, WHOLE_SUM, in_screen_region
from .spec import Buffer, Counted, Loop, Method, Param, Pass, when

ORDER = 5

SCAN = Param("scan", "compute", "prefix sum by full-screen steps (Peeper), or work-efficient in compute shaders",
             choices=("fullscreen", "compute"))
SCAN_LANES, SCAN_RUN = 64, 16  # invocations of a work group, and pixels that each scans by itself
MOST_GROUPS = 65_535  # of a dispatch, by GL's least limit
FULLSCREEN, COMPUTE = when("scan", "fullscreen"), when("scan", "compute")


def scans(block: int, groups: str, defines: dict[str, int]) -> tuple[Pass | Loop, ...]:
    """The steps of the prefix sum: by full-screen steps, or by work groups that scan blocks of so many pixels."""
    return (
        Pass("scan", "fullscreen", "methods/precalc/seed.frag", reads=("counter",), writes=("address.previous",),
             when=FULLSCREEN, whole=WHOLE_SUM),
        Loop((Pass("scan", "fullscreen", "methods/precalc/scan.frag", reads=("address.previous",),
                   writes=("address.current",), when=FULLSCREEN, whole=WHOLE_SUM),),
             times="ceil(log2(P))", until_empty=False),
        Pass("scan", "compute", "methods/precalc/sum_blocks.comp", reads=("counter",), writes=("block_sum",),
             groups=groups, defines=defines, when=COMPUTE, whole=WHOLE_SUM),
        Pass("scan", "compute", "methods/precalc/scan_sums.comp", writes=("block_sum",), groups="1", defines=defines,
             when=COMPUTE, whole=WHOLE_SUM),
        Pass("scan", "compute", "methods/precalc/scan_pixels.comp", reads=("counter", "block_sum"),
             writes=("address",), groups=groups, defines=defines, when=COMPUTE, whole=WHOLE_SUM),
    )


def precalc(lanes: int = SCAN_LANES, run: int = SCAN_RUN, most_groups: int = MOST_GROUPS) -> Method:
    """PreCalc, whose compute scan has work groups of so many lanes, and in each lane a run of so many pixels."""
    block = lanes * run
    return Method(
        id="ab-precalc", name="PreCalc", family="precalc",
        source="Peeper 2008; sbuffer_2012 §2, §4 (PreCalc, PreCalc_OpenCL)",
        summary="count, prefix sum over all pixels, store into exact ranges",
        guarantee="exact all", words="2*f + 2", ties="kept, in no fixed order",
        beside="what the scan works in: a word per 1024 pixels for the compute scan, or a second address word per "
               "pixel where full-screen steps take turns; the memory table of sbuffer_2012 shows the like (§4)",
        params=(SCAN, *RESOLVE_OPTIONS, TOUCHED, REUSE_COUNT, PAYLOAD), capacity=Counted(),
        buffers=(COUNTER, replace(ADDRESS, copies=2, when=FULLSCREEN), replace(ADDRESS, when=COMPUTE), NODES,
                 Buffer("block_sum", f"ceil(P/{block})", when=COMPUTE,
                        doc="fragments of each block of pixels, then of all blocks before it")),
        steps=(
            *once(clear("counter", whole=WHOLE_SUM), count(),
                  *scans(block, f"min({most_groups}, ceil(P/{block}))",
                         {"SCAN_BLOCK": block, "SCAN_LANES": lanes, "SCAN_RUN": run})),
            *in_screen_region(rewind("scan", "address.previous"),
                      replace(STORE, writes=("address.previous", "nodes")),
                      replace(RESOLVE, reads=("counter", "address.previous", "nodes"))),
        ),
    )


METHODS = [
    precalc(),
    Method(
        id="ab-precalc-fixed", name="PreCalc_Fixed", family="precalc",
        source="sbuffer_2012 §4 (PreCalc_Fixed), after Peeper 2008",
        summary="room for n fragments in every pixel: address = pixel * n; needs n beforehand",
        guarantee="exact all", words="2*n + 2", ties="kept, in no fixed order",
        params=(*RESOLVE_OPTIONS, TOUCHED, PAYLOAD),
        buffers=(COUNTER, ADDRESS, replace(NODES, words="2*n*P", doc="n fragments of each pixel, in order of arrival")),
        steps=in_screen_region(
            clear("counter"),
            Pass("scan", "fullscreen", "methods/precalc/address_fixed.frag", writes=("address",)),
            Pass("store", "geometry", "methods/precalc/store_fixed.frag", reads=("address",),
                 writes=("counter", "nodes")),
            resolve("counter", "address", "nodes", fetch="methods/precalc/fetch_fixed.glsl", texels=("nodes",)),
        ),
    ),
]
