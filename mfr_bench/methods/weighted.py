"""Weighted blended order-independent transparency: one geometry pass, two blended targets, no order at all.

The weights are made for depths in units of a scene; `weight` says how ours, which have none, enter them.
"""

from __future__ import annotations

from .shared import CLEARED
from .shared.screen_region import TOUCHED_BLENDED, in_screen_region
from .spec import ADD, IMAGE, REVEAL, Method, Param, Pass, State, Target, when

ORDER = 8

WEIGHT = Param("weight", "eq10", "how a fragment's weight falls with depth, by the paper's equations: eq7 to eq9 of a "
               "distance in 0.1 .. 500, over which window depth is spread; eq10 of window depth itself",
               choices=("eq7", "eq8", "eq9", "eq10"))
PRECISION = Param("precision", "16f", "targets: RGBA16F and R8 as in the paper, or RGBA32F and R32F",
                  choices=("16f", "32f"))
ACCUMULATION, REVEALAGE = "sums of the weighted colours and alphas", "product of 1 - alpha"
HALF, FULL = (when("precision", choice) for choice in PRECISION.choices)

METHODS = [
    Method(
        id="wboit", name="WBOIT", family="weighted",
        source="McGuire & Bavoil 2013 (JCGT 2:2)",
        summary="weighted mean of all colours, weights falling with depth; opacity from the product of 1 - alpha",
        guarantee="approximate", words="2.25 if precision == '16f' else 5", ties="kept; no order is ever known",
        failure="colours are mixed by weight, not by what hides what; exact for one layer and where all colours are "
                "equal, which equal alphas alone do not give; with 16f, sums round to 11 bits, opacity to 8",
        mixes=True, exact_where="n <= 1 and precision == '32f'",
        params=(WEIGHT, PRECISION, TOUCHED_BLENDED),
        targets=(Target("accumulation", "rgba16f", when=HALF, doc=ACCUMULATION),
                 Target("revealage", "r8", when=HALF, doc=REVEALAGE),
                 Target("accumulation", "rgba32f", when=FULL, doc=ACCUMULATION),
                 Target("revealage", "r32f", when=FULL, doc=REVEALAGE)),
        steps=in_screen_region(
            Pass("store", "geometry", "methods/weighted/store.frag", into=("accumulation", "revealage"),
                 clears={"accumulation": CLEARED, "revealage": (1.0, 0.0, 0.0, 0.0)},
                 state=State(blends=(ADD, REVEAL))),
            Pass("resolve", "fullscreen", "methods/weighted/resolve.frag", reads=("accumulation", "revealage"),
                 into=(IMAGE,)),
        ),
    ),
]
