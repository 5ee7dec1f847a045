"""A-buffers with an array of fixed length per pixel."""

from __future__ import annotations

from .shared import SORT, clear, resolve
from .spec import Buffer, Method, Pass

ORDER = 2

METHODS = [
    Method(
        id="ab-array", name="AB_Array", family="array",
        source="Crassin 2010; Liu et al. 2010 (FreePipe); kplus_2015 §2",
        summary="n slots per pixel, given out by an atomic counter; needs n beforehand",
        guarantee="exact all", words="2*n + 1", ties="kept, in order of arrival",
        params=(SORT,),
        buffers=(Buffer("counter", "P", clear="0u"), Buffer("nodes", "2*n*P", type="uvec2")),
        steps=(
            clear("counter"),
            Pass("store", "geometry", "methods/array/store.frag", writes=("counter", "nodes")),
            resolve("counter", "nodes", fetch="methods/array/fetch.glsl", defines={"SLOTS": "n"}),
        ),
    ),
]
