"""Moment-based order-independent transparency: the transmittance along a pixel from power moments of its absorbance.

Power moments in single precision; the paper also has trigonometric moments and 16-bit storage. Words: the moments and
their 0th, and four for the shaded colour, for which the paper takes the image itself.
"""

from __future__ import annotations

from .shared import CLEARED
from .shared.screen_region import TOUCHED_BLENDED, in_screen_region
from .spec import ADD, IMAGE, Method, Param, Pass, State, Target, when

ORDER = 8

MOMENTS = Param("moments", 4, "power moments of absorbance over depth", low=4, high=6, of=(4, 6))
BIAS = "share of a spread-out measure in the moments, against rounding; the paper's for single precision"

METHODS = [
    Method(
        id="mboit", name="MBOIT", family="moments",
        source="Münstermann et al. 2018; Sharpe 2018",
        summary="moments of the absorbance by additive blending; a second geometry pass shades every fragment by the "
                "transmittance reconstructed from them",
        guarantee="approximate", words="moments + 5", ties="kept; no order is ever known",
        failure="transmittance is a guess between bounds; colours are right for one layer, nearly so for at most "
                "moments/2 layers of equal alpha; an opaque fragment still lets 4.5e-5 through",
        mixes=True, exact_where="n <= 1",
        params=(MOMENTS,
                Param("bias", 5e-7, BIAS, real=True, low=0, high=1, acts=when("moments", 4)),
                Param("bias_6", 5e-6, BIAS, real=True, low=0, high=1, acts=when("moments", 6)),
                TOUCHED_BLENDED),
        targets=(Target("absorbance", "r32f", doc="total absorbance"),
                 Target("moments", "rg32f", layers="moments // 2", doc="power moments of the absorbance over depth"),
                 Target("shaded", "rgba32f", doc="sum of the attenuated colours and alphas")),
        steps=in_screen_region(
            Pass("store", "geometry", "methods/moments/store.frag", into=("absorbance", "moments"),
                 clears={"absorbance": CLEARED, "moments": CLEARED}, state=State(blend=ADD)),
            Pass("shade", "geometry", "methods/moments/shade.frag", reads=("absorbance", "moments"),
                 into=("shaded",), clears={"shaded": CLEARED}, state=State(blend=ADD)),
            Pass("resolve", "fullscreen", "methods/moments/resolve.frag", reads=("absorbance", "shaded"),
                 into=(IMAGE,)),
        ),
    ),
]
