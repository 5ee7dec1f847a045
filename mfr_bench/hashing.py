"""The counter-based integer hash that plans, scenes and shaders/common/hash.glsl share, bit for bit.

A hash of counters needs no state: any element of a scene can be made alone, in any order, on the CPU and on the
GPU. Arguments are whole numbers below 2**32, or uint64 arrays of such numbers; arrays broadcast.
"""

from __future__ import annotations

from typing import TypeVar

Counter = TypeVar("Counter")

WORD = 0xFFFFFFFF


def mix(x: Counter) -> Counter:
    """A bijection of 32-bit words that spreads every input bit: the `lowbias32` finalizer (C. Wellons, 2018)."""
    x = (x ^ (x >> 16)) * 0x7FEB352D & WORD
    x = (x ^ (x >> 15)) * 0x846CA68B & WORD
    return x ^ (x >> 16)


def hash3(a: Counter, b: Counter, c: Counter) -> Counter:
    """32-bit hash of three counters."""
    return mix(a ^ mix(b ^ mix(c)))
