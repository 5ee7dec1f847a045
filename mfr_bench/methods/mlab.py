"""Multi-layer alpha blending: a k-buffer that merges what it has no room for.

The paper counts a depth and a colour for each layer, 2k words; `payload: rgba16f` takes a word more.
"""

from __future__ import annotations

from dataclasses import replace

from .shared import BOUND, LOCK, PAYLOAD, SEMAPHORE, STAGE, SYNC, TIES_OF_INSERTION, K, clear, resolve_sorted
from .shared.screen_region import TOUCHED, in_screen_region
from .spec import Buffer, Method, Param, Pass

ORDER = 8

ANY_COLOUR = replace(PAYLOAD, doc="stored colour, straight: 8 bits a channel, or 16-bit floats in two words",
                     choices=("rgba8", "rgba16f"), weakens={})

STORES = Param("stores", "moved", "layers that an insertion writes: those that move, or all, as in the source, which "
               "keeps them in one structure", choices=("moved", "all"))

METHODS = [
    Method(
        id="mlab", name="MLAB", family="mlab",
        source="Salvi & Vaidyanathan 2014",
        summary="k layers per pixel in order of depth; where a fragment finds no room, the two furthest layers are "
                "merged",
        guarantee="approximate", words="2*k", ties=TIES_OF_INSERTION,
        failure="a fragment that comes late may belong in front of what was merged; each merge rounds to the payload",
        beside=LOCK, mixes=True, exact_where="n <= k",
        params=(replace(K, doc="layers per pixel"), BOUND, STORES, SYNC, STAGE, TOUCHED, ANY_COLOUR), local="k",
        buffers=(SEMAPHORE,
                 Buffer("nodes", "2*k*P", type="FRAGMENT", clear="EMPTY", coherent=True, doc="k layers, sorted")),
        steps=in_screen_region(
            clear("semaphore", "nodes"),
            Pass("store", "geometry", "methods/mlab/store.frag", writes=("semaphore", "nodes")),
            resolve_sorted("nodes", fetch="methods/ps/fetch.glsl", texels=("nodes",), mixes=True),
        ),
    ),
]
