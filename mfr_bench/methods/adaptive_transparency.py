"""Adaptive transparency: the visibility function of a pixel in k nodes, then every fragment shaded by it.

The paper counts a depth and a transmittance for each node, 2k words; here both are floats.
"""

from __future__ import annotations

from dataclasses import replace

from .shared import BOUND, LOCK, SEMAPHORE, SYNC, K, clear
from .shared.screen_region import TOUCHED, in_screen_region
from .spec import ADD, IMAGE, Buffer, Method, Pass, State

ORDER = 8

METHODS = [
    Method(
        id="aoit", name="Adaptive transparency", family="visibility",
        source="Salvi et al. 2011",
        summary="k nodes of the visibility function; where one more comes, the one goes that changes its area least; a "
                "second geometry pass shades every fragment by it",
        guarantee="approximate", words="2*k",
        ties="kept, and they do not hide each other: each adds its colour unattenuated by the others",
        failure="a step that was moved hides what lies before its true place, so that colours come out darker; opacity "
                "is right",
        beside=LOCK, mixes=True, exact_where="n <= k",
        params=(replace(K, doc="nodes of a pixel's visibility function"), BOUND, SYNC, TOUCHED), local="k",
        buffers=(SEMAPHORE,
                 Buffer("nodes", "2*k*P", type="uvec2", clear="EMPTY", coherent=True,
                        doc="k nodes of the visibility function, sorted: depth, and factor of the transmittance")),
        steps=in_screen_region(
            clear("semaphore", "nodes"),
            Pass("store", "geometry", "methods/visibility/store.frag", writes=("semaphore", "nodes")),
            Pass("opacity", "fullscreen", "methods/visibility/opacity.frag", reads=("nodes",), texels=("nodes",),
                 into=(IMAGE,), fetch="methods/ps/fetch.glsl"),
            Pass("shade", "geometry", "methods/visibility/shade.frag", reads=("nodes",), texels=("nodes",),
                 into=(IMAGE,), state=State(blend=ADD)),
        ),
    ),
]
