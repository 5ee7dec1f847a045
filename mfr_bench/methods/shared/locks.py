"""Mutual exclusion per pixel: the semaphore of spin locks, and buffers of 64-bit elements with their emulation."""

from __future__ import annotations

from ..spec import Buffer, When, when
from .options import ATOMIC64

SEMAPHORE = Buffer("semaphore", "P", clear="0u", coherent=True, when=when("sync", "spin"),
                   doc="spin lock of each pixel")


def buffers_of_64_bits(name: str, elements: str, word: str = "0u", condition: When | None = None,
                       native_type: str = "uint64_t", **more) -> tuple[Buffer, ...]:
    """A coherent buffer of 64-bit elements, native or emulated as ATOMIC64 says.

    common/atomic64.glsl uses elements of the `native_type` uint64_t, common/exchange64.glsl elements of int64_t. The
    emulation adds the buffer `lock64`: a pass that clears or writes the buffer has to name it as well. `word` is the
    value that the clear pass gives to both words of an element. An element must be used by the fragments of one pixel
    only, because the emulation has one lock per pixel.
    """
    native, emulated = (when("atomic64", c) & condition if condition else when("atomic64", c) for c in ATOMIC64.choices)
    words = f"2*({elements})"
    shared = {"coherent": True, **more}
    return (Buffer(name, words, type=native_type, clear=f"packUint2x32(uvec2({word}))", when=native, **shared),
            Buffer(name, words, type="uvec2", clear=word, when=emulated, **shared),
            Buffer("lock64", "P", clear="0u", coherent=True, when=emulated,
                   doc="lock of each pixel, for the emulation of 64-bit atomics"))
