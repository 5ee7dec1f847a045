"""Compares the fragments that a device made of triangles with what a rasterizer may make of them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..composite import Fragments
from .bounds import Bounds, bounds

ONE, LEAST = (int(np.float32(z).view(np.uint32)) for z in (1.0, 2.0**-24))  # bits that mirrored depths go between


@dataclass(frozen=True)
class Deviation:
    """How far a device's fragments are off.

    fragments: those of the device. missing: certain ones that it does not have. impossible: those it has outside the
    bounds of coverage. repeated: those it has twice or more. deep: those whose depth is outside its bounds.
    open_pixels: (triangle, pixel) pairs that the bounds leave open. coverage_px: the furthest a fragment lies outside
    its triangle, or a middle of a pixel without one lies inside. depth_off: the largest distance from the depth of the
    exact plane.
    """

    fragments: int
    missing: int
    impossible: int
    repeated: int
    deep: int
    open_pixels: int
    coverage_px: float
    depth_off: float

    @property
    def within(self) -> bool:
        """Whether the device stays within every bound."""
        return not (self.missing or self.impossible or self.repeated or self.deep)

    def __str__(self) -> str:
        return (f"{self.fragments} fragments, {self.missing} certain ones missing, {self.impossible} impossible, "
                f"{self.repeated} repeated, {self.deep} with a depth out of bounds; coverage off by at most "
                f"{self.coverage_px:.2g} pixels, depth by {self.depth_off:.2g}")


def keys_of(found: Fragments) -> np.ndarray:
    """int64 (F,): triangle · pixels + pixel of fragments, in their order."""
    pixel = np.repeat(np.arange(found.counts.size), found.counts.ravel())
    return found.primitive.astype(np.int64) * found.counts.size + pixel


def deviation(found: Fragments, subpixel_bits: int) -> Deviation:
    """How the fragments of a scene of triangles, all of which are drawn, differ from what is possible."""
    allowed = bounds(found.scene, subpixel_bits)
    keys, known = keys_of(found), allowed.primitive * found.counts.size + allowed.pixel
    at = np.minimum(np.searchsorted(known, keys), max(len(known) - 1, 0))
    possible = known[at] == keys if len(known) else np.zeros(len(keys), dtype=bool)
    seen = np.isin(known, keys)
    at, depth = at[possible], window_depths(found)[possible]
    off = np.abs(depth - allowed.depth[at])
    return Deviation(
        fragments=len(keys), missing=int((allowed.certain & ~seen).sum()), impossible=int((~possible).sum()),
        repeated=len(keys) - len(np.unique(keys)),
        deep=int(((depth < allowed.low[at]) | (depth > allowed.high[at])).sum()),
        open_pixels=int((~allowed.certain).sum()), coverage_px=_coverage_off(allowed, seen),
        depth_off=float(off.max(initial=0.0)))


def _coverage_off(allowed: Bounds, seen: np.ndarray) -> float:
    """The furthest that a fragment lies outside, or a middle without one inside, in pixels."""
    return float(np.maximum(np.where(seen, -allowed.inside, allowed.inside), 0.0).max(initial=0.0))


def window_depths(found: Fragments) -> np.ndarray:
    """float64 (F,): window depths of fragments, of mirrored ones too (see `scene.triangles.ReversedTriangles`)."""
    bits = found.depth.astype(np.int64)
    if found.scene.geometry == "reversed":
        bits = ONE + LEAST - bits
    return bits.astype(np.uint32).view(np.float32).astype(np.float64)
