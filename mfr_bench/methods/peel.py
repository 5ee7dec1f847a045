"""Depth peeling: memory-bounded, exact, one or more geometry passes per layer.

The papers give no words per pixel for these; `words` counts the textures that the sources describe, at
the float precision that exactness asks of them here.
"""

from __future__ import annotations

from .shared import CLEAR_IMAGE, CLEARED
from .spec import IMAGE, MAX, OVER, UNDER, Loop, Method, Pass, State, Target

ORDER = 1

METHODS = [
    Method(
        id="peel-f2b", name="F2B", family="peel",
        source="Everitt 2001; kplus_2015 §2",
        summary="front-to-back peeling: one layer per geometry pass, until an occlusion query sees none",
        guarantee="exact all", words="6", ties="one of them is kept, the others are lost",
        targets=(Target("layer", "rgba32f"), Target("layer_depth", "depth32f", copies=2)),
        steps=(
            CLEAR_IMAGE,
            Loop((
                Pass("peel", "geometry", "methods/peel/f2b.frag", reads=("layer_depth.previous",),
                     into=("layer", "layer_depth.current"), clears={"layer": CLEARED, "layer_depth.current": (1.0,)},
                     state=State(depth_test="lequal"), counts=True),
                Pass("composite", "fullscreen", "methods/peel/copy.frag", reads=("layer",), into=(IMAGE,),
                     state=State(blend=UNDER)),
            ), times="n + 1"),
        ),
    ),
    Method(
        id="peel-dual", name="DUAL", family="peel",
        source="Bavoil & Myers 2008; kplus_2015 §2",
        summary="dual peeling: the nearest and the furthest layer per geometry pass, by MAX blending",
        guarantee="exact all", words="20", ties="the maximum of each channel is kept",
        targets=(Target("bounds", "rg32f", copies=2), Target("front", "rgba32f", copies=2),
                 Target("behind", "rgba32f"), Target("back", "rgba32f")),
        steps=(
            Pass("bounds", "geometry", "methods/peel/dual_bounds.frag", into=("bounds.previous",),
                 clears={"bounds.previous": (-1.0, -1.0, 0.0, 0.0)}, state=State(blend=MAX)),
            Pass("clear", "clear", into=("front.previous", "back"), clears={"front.previous": CLEARED, "back": CLEARED}),
            Loop((
                Pass("peel", "geometry", "methods/peel/dual.frag", reads=("bounds.previous", "front.previous"),
                     into=("bounds.current", "front.current", "behind"),
                     clears={"bounds.current": (-1.0, -1.0, 0.0, 0.0), "front.current": CLEARED, "behind": CLEARED},
                     state=State(blend=MAX)),
                Pass("blend", "fullscreen", "methods/peel/dual_blend.frag", reads=("behind", "bounds.current"),
                     into=("back",), state=State(blend=OVER), counts=True),
            ), times="n // 2 + 1"),
            Pass("combine", "fullscreen", "methods/peel/dual_combine.frag", reads=("front.previous", "back"),
                 into=(IMAGE,)),
        ),
    ),
]
