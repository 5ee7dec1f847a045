"""Dynamic fragment buffer: exact ranges like PreCalc's, from a hierarchical sum.

It differs from `ab-precalc` in the prefix sum, which climbs a tree of sums and comes down again in fragment shaders,
two full-screen passes per level and a total work in proportion to the pixels. PreCalc's full-screen steps are one per
doubling and each touches every pixel; its compute scan adds up blocks of pixels, then scans the sums and the blocks in
work groups, in three dispatches. Count, store and resolve are the same. The sum goes over all pixels, so that with
`touched` the clear and the scan stay whole.

Maule et al. 2014 is not among the papers at hand: the branching of 16 is a choice made here.
"""

from __future__ import annotations

from .sbuffer import ADDRESS, COUNTER, NODES, RESOLVE, STORE, rewind
from .shared import PAYLOAD, RESOLVE_OPTIONS, REUSE_COUNT, clear, count, once
from .shared.screen_region import TOUCHED, WHOLE_SUM, in_screen_region
from .spec import Buffer, Counted, Loop, Method, Pass

ORDER = 5

FAN_BITS = 4
LEVELS = f"max(1, ceil(log2(P)/{FAN_BITS}))"
TREE = {"FAN": 1 << FAN_BITS, "LEVELS": LEVELS}
SUMS_WORDS = " + ".join(f"ceil(P/{1 << FAN_BITS * level})" for level in range(1, 9))  # each level has at least one

METHODS = [
    Method(
        id="ab-dfb", name="DFB", family="dfb",
        source="Maule et al. 2014; kplus_2015 §2 [31]",
        summary="dynamic fragment buffer: count, hierarchical sum over all pixels, store into exact ranges",
        guarantee="exact all", words="2*f + 2",
        beside="the tree of sums above the pixels, a fifteenth of a word per pixel", ties="kept, in no fixed order",
        params=(*RESOLVE_OPTIONS, TOUCHED, REUSE_COUNT, PAYLOAD), capacity=Counted(),
        buffers=(COUNTER, ADDRESS, NODES, Buffer("sums", SUMS_WORDS, doc="levels 1, 2, … of the hierarchical sum")),
        steps=(
            *once(
                clear("counter", whole=WHOLE_SUM),
                count(),
                Loop((Pass("scan", "fullscreen", "methods/dfb/sum_up.frag", reads=("counter",), writes=("sums",),
                           defines=TREE, whole=WHOLE_SUM),), times=LEVELS, until_empty=False),
                Loop((Pass("scan", "fullscreen", "methods/dfb/sum_down.frag", reads=("counter",),
                           writes=("sums", "address"), defines=TREE, whole=WHOLE_SUM),),
                     times=LEVELS, until_empty=False),
            ),
            *in_screen_region(rewind("scan"), STORE, RESOLVE),
        ),
    ),
]
