"""Multi depth test: a cascade of atomic minima per fragment."""

from __future__ import annotations

from .shared import CULLING, K, clear, resolve_sorted
from .spec import Buffer, Method, Pass

ORDER = 6

METHODS = [
    Method(
        id="kb-mdt32", name="KB-MDT_32", family="mdt",
        source="Liu et al. 2010; Maule et al. 2013; kplus_2015 §2",
        summary="32-bit atomic minima sort the k nearest depths, a second geometry pass brings their colours; "
                "keys are the bits of the float depth, which keep its order without loss",
        guarantee="exact k nearest", words="2*k", ties="collide: one colour is kept, further slots show none",
        params=(K, CULLING),
        buffers=(Buffer("depths", "k*P", clear="EMPTY", coherent=True), Buffer("colours", "k*P", clear="0u")),
        steps=(
            clear("depths", "colours"),
            Pass("store_depth", "geometry", "methods/mdt/store_depth.frag", writes=("depths",)),
            Pass("store", "geometry", "methods/mdt/store_colour.frag", reads=("depths",), writes=("colours",)),
            resolve_sorted("depths", "colours", fetch="methods/mdt/fetch.glsl"),
        ),
    ),
]
