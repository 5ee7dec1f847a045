"""Multi depth test: a cascade of atomic minima per fragment."""

from __future__ import annotations

from .shared import (
    ATOMIC64,
    BOUND,
    CULLING,
    OCCUPANCY,
    STAGE,
    STOP_OPACITY,
    K,
    buffers_of_64_bits,
    clear,
    occupied,
    resolve_sorted,
)
from .shared.screen_region import TOUCHED, in_screen_region
from .spec import Buffer, Method, Param, Pass, when

ORDER = 6

KEY = Param("key", "float_bits", "what is compared: the bits of the float depth, or the papers' scaled conversion",
            choices=("float_bits", "fixed"), asks={"fixed": "lengthless"},
            weakens={"fixed": "depths that are equal after the conversion collide, and lose all but one colour"})
DEPTH_BITS = Param("depth_bits", 24, "bits of the scaled conversion, whose number the papers do not print",
                   low=8, high=32, acts=when("key", "fixed"))

METHODS = [
    Method(
        id="kb-mdt32", name="KB-MDT_32", family="mdt",
        source="Liu et al. 2010; Maule et al. 2013; kplus_2015 §2",
        summary="32-bit atomic minima sort the k nearest depths, a second geometry pass brings their colours",
        guarantee="exact k nearest", words="2*k",
        ties="collide: one colour is kept, further slots show none", loses_ties=True,
        params=(K, BOUND, KEY, DEPTH_BITS, CULLING, OCCUPANCY, STAGE, STOP_OPACITY, TOUCHED), local="k",
        buffers=(Buffer("depths", "k*P", clear="EMPTY", coherent=True, doc="keys of the k nearest depths, sorted"),
                 Buffer("colours", "k*P", doc="colours of the same fragments")),
        steps=in_screen_region(
            clear("depths"),
            *occupied(
                Pass("store_depth", "geometry", "methods/mdt/store_depth.frag", writes=("depths",)),
                Pass("store", "geometry", "methods/mdt/store_colour.frag", reads=("depths",), writes=("colours",)),
            ),
            resolve_sorted("depths", "colours", fetch="methods/mdt/fetch.glsl", texels=("depths", "colours")),
        ),
    ),
    Method(
        id="kb-mdt64", name="KB-MDT_64", family="mdt",
        source="Kubisch 2014; kplus_2015 §2",
        summary="64-bit atomic minima sort the k nearest fragments, depth and colour at once",
        guarantee="exact k nearest", words="2*k",
        beside="with atomic64: emulated a lock, one word per pixel",
        ties="kept, in order of payload, the k-th place included",
        params=(K, BOUND, ATOMIC64, OCCUPANCY, STAGE, STOP_OPACITY, TOUCHED), local="k",
        buffers=buffers_of_64_bits("nodes", "k*P", word="EMPTY", doc="k nearest fragments, sorted: depth above colour"),
        steps=in_screen_region(
            clear("nodes", "lock64"),
            *occupied(Pass("store", "geometry", "methods/mdt/store64.frag", writes=("nodes", "lock64"))),
            resolve_sorted("nodes", fetch="methods/mdt/fetch64.glsl", texels=("nodes",)),
        ),
    ),
]
