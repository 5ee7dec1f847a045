"""KB-PS: sorted insertion inside pixel synchronization."""

from __future__ import annotations

from .shared import (
    BOUND,
    CULLING,
    OCCUPANCY,
    SEMAPHORE,
    STAGE,
    STOP_OPACITY,
    SYNC,
    TIES_OF_INSERTION,
    K,
    clear,
    occupied,
    resolve_sorted,
)
from .shared.screen_region import TOUCHED, in_screen_region
from .spec import Buffer, Method, Pass

ORDER = 7

METHODS = [
    Method(
        id="kb-ps", name="KB-PS", family="ps",
        source="Salvi 2013; kplus_2015 §2, §5",
        summary="k sorted slots, one fragment of a pixel inserted at a time; an empty slot ends them",
        guarantee="exact k nearest", words="2*k",
        beside="with sync: spin a semaphore, one word per pixel: the authors ran it with theirs (kplus_2015 §5), Table "
               "1 counts what sync: interlock takes",
        ties=f"{TIES_OF_INSERTION}; the last of them loses the k-th place",
        params=(K, BOUND, SYNC, CULLING, OCCUPANCY, STAGE, STOP_OPACITY, TOUCHED), local="k",
        buffers=(SEMAPHORE,
                 Buffer("nodes", "2*k*P", type="uvec2", clear="EMPTY", coherent=True,
                        doc="k nearest fragments of each pixel, sorted")),
        steps=in_screen_region(
            clear("semaphore", "nodes"),
            *occupied(Pass("store", "geometry", "methods/ps/store.frag", writes=("semaphore", "nodes"))),
            resolve_sorted("nodes", fetch="methods/ps/fetch.glsl", texels=("nodes",)),
        ),
    ),
]
