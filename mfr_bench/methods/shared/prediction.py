"""Predicts how many layers a k-buffer should keep, from the frame's depth-complexity histogram (kplus_2015 §4.2)."""

from __future__ import annotations

from collections.abc import Sequence

from ...environment import MIB
from ..spec import Choice

BINS = 1024  # of the histogram, and the largest k (kplus_2015 §4.2)


def largest_k(memory_mb: float, pixels: int, fragment_bytes: int, pixel_bytes: int) -> int:
    """k_b, the most slots of every pixel for which a budget in MiB has room (Eq. 4 and 5); at least 1."""
    return max(1, int(fragments_in(memory_mb, pixels, fragment_bytes, pixel_bytes) / pixels))


def predict_k(counts: Sequence[int], fragments: int, hit_ratio: float, room: float, most: int = BINS) -> Choice:
    """The smallest k that keeps `hit_ratio` of the fragments, or the largest that `room` fragments and `most` allow.

    counts[i]: pixels with i + 1 fragments, in the last place also those with more. `fragments`: of the frame.
    Eq. 6 of kplus_2015 with Eq. 7 as its constraint; at least 1, however little room there is.
    """
    kept, deeper = 0, sum(counts)  # fragments kept by k layers; pixels with more than k fragments
    k = 0
    while deeper and k < most:
        if k and (kept >= hit_ratio * fragments or kept + deeper > room):
            break
        kept += deeper
        deeper -= counts[k] if k < len(counts) else 0
        k += 1
    return Choice(max(1, k), kept)


def fragments_in(memory_mb: float, pixels: int, fragment_bytes: int, pixel_bytes: int) -> float:
    """Fragments for which a budget in MiB has room after what every pixel takes (Eq. 7)."""
    return (memory_mb * MIB - pixel_bytes * pixels) / fragment_bytes
