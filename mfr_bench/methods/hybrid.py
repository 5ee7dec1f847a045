"""Hybrid transparency: a k-buffer's core, and one average colour for all that lies behind it.

Words: 2k for the core; colour, opacity and number of the tail's fragments, 5.
"""

from __future__ import annotations

from dataclasses import replace

from .shared import BOUND, LOCK, SEMAPHORE, STAGE, SYNC, TIES_OF_INSERTION, K, clear, resolve_sorted
from .shared.screen_region import TOUCHED, in_screen_region
from .spec import Buffer, Method, Pass

ORDER = 8

METHODS = [
    Method(
        id="hybrid", name="Hybrid transparency", family="hybrid",
        source="Maule et al. 2013; the tail as in Bavoil & Myers 2008",
        summary="the k nearest fragments exactly, sorted insertion; those behind as the weighted average of their "
                "colours and opacities",
        guarantee="approximate", words="2*k + 5",
        ties=f"{TIES_OF_INSERTION}; the last of them loses the k-th place",
        failure="the tail knows no order; its opacity is right where its alphas are equal, its colour where its "
                "colours are",
        beside=LOCK, mixes=True, exact_where="n <= k + 1",
        params=(replace(K, doc="fragments of the core"), BOUND, SYNC, STAGE, TOUCHED), local="k",
        buffers=(SEMAPHORE,
                 Buffer("nodes", "2*k*P", type="uvec2", clear="EMPTY", coherent=True,
                        doc="k fragments of the core, sorted"),
                 Buffer("tail", "4*P", type="vec4", clear="0.0", coherent=True,
                        doc="sums of the colours and opacities of the tail"),
                 Buffer("tail_count", "P", clear="0u", coherent=True, doc="fragments of the tail")),
        steps=in_screen_region(
            clear("semaphore", "nodes", "tail", "tail_count"),
            Pass("store", "geometry", "methods/hybrid/store.frag",
                 writes=("semaphore", "nodes", "tail", "tail_count")),
            resolve_sorted("nodes", "tail", "tail_count", fetch="methods/ps/fetch.glsl", texels=("nodes",),
                           resolver="methods/hybrid/resolve.glsl", mixes=True),
        ),
    ),
]
