"""k+-buffers: the k nearest fragments, kept unsorted in a bounded structure under mutual exclusion.

Measured against Table 1 of kplus_2015 (2k + 2 words): with `sync: interlock` the semaphore, one word, is absent.
"""

from __future__ import annotations

from .shared import CULLING, SORT, SYNC, K, clear, resolve
from .spec import Buffer, Method, Param, Pass, when

ORDER = 7

STRUCTURE = Param("structure", "array", "how the k fragments are kept", choices=("array", "heap"))


def kplus(structure: str, name: str, summary: str) -> Method:
    return Method(
        id=f"kplus-{structure}", name=name, family="kplus",
        source="kplus_2014; kplus_2015 §3, Alg. 1 and 2",
        summary=summary,
        guarantee="exact k nearest", words="2*k + 2", ties="kept; beyond the k-th place the first to arrive stays",
        params=(K, SYNC, CULLING, SORT), fixed=(STRUCTURE.at(structure),), local="k",
        buffers=(Buffer("counter", "P", clear="0u", coherent=True),
                 Buffer("semaphore", "P", clear="0u", coherent=True, when=when("sync", "spin")),
                 Buffer("nodes", "2*k*P", type="uvec2", coherent=True)),
        steps=(
            clear("counter", "semaphore"),
            Pass("store", "geometry", "methods/kplus/store.frag", writes=("counter", "semaphore", "nodes")),
            resolve("counter", "nodes", fetch="methods/array/fetch.glsl", defines={"SLOTS": "k"}),
        ),
    )


METHODS = [
    kplus("array", "K+B-Array", "max-array: the furthest of the k fragments stands first, the others unsorted"),
    kplus("heap", "K+B-Heap", "max-heap: the furthest of the k fragments is the root; meant for k > 16"),
]
