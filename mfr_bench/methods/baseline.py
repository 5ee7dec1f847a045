"""Baselines: what the hardware does without any multi-fragment method.

Each is one geometry pass, so that there is nothing that `touched` could limit.
"""

from __future__ import annotations

from .shared import CLEARED
from .spec import IMAGE, OVER, Method, Param, Pass, State, Target

ORDER = 0

UNTOUCHED = "one geometry pass"

METHODS = [
    Method(
        id="floor", name="Blending floor", family="baseline",
        source="GL fixed function",
        summary="the geometry blended in submission order: the least time any method can take, not an image to compare",
        guarantee="none", words="0", ties="blended in submission order", untouched=UNTOUCHED,
        steps=(Pass("blend", "geometry", "methods/baseline/floor.frag", into=(IMAGE,), clears={IMAGE: CLEARED},
                    state=State(blend=OVER)),),
    ),
    Method(
        id="zbuffer", name="Z-buffer", family="baseline",
        source="Catmull 1974; kplus_2015 §4.3",
        summary="the nearest fragment by the hardware depth test",
        guarantee="exact k nearest", words="1", ties="the last submitted is kept", untouched=UNTOUCHED,
        fixed=(Param("k", 1, "fragments kept per pixel"),),
        targets=(Target("depth", "depth32f", doc="nearest depth so far"),),
        steps=(Pass("draw", "geometry", "methods/baseline/zbuffer.frag", into=(IMAGE, "depth"),
                    clears={IMAGE: CLEARED, "depth": (1.0,)}, state=State(depth_test="lequal")),),
    ),
]
