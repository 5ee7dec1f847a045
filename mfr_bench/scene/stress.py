"""The changes to a scene by which a config puts methods under stress: depths, opacities and edges at their extremes."""

from __future__ import annotations

import numpy as np

from .kinds.quads import clustered_depths
from .parameters import Scene

ODD_DEPTHS = {"zero": 0.0, "minus_zero": -0.0, "one": 1.0, "below": -(2.0**-24), "beyond": 1.0 + 2.0**-23,
              "far_below": -1e30, "far_beyond": 1e30, "infinity": np.inf, "minus_infinity": -np.inf, "nan": np.nan}


def values(config: Scene, depth: np.ndarray, rgba: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Depths and colours of quads at distinct depths, as the config wants them; quads stay in the same order."""
    rank = np.empty(len(depth), dtype=np.int64)
    rank[np.argsort(depth, kind="stable")] = np.arange(len(depth))
    if config.depth_at is not None:
        depth = np.array(clustered_depths(config), dtype=np.float32)[rank]
    if config.alpha_order != "random":
        sign = -1 if config.alpha_order == "falling" else 1
        rgba = rgba.copy()
        rgba[:, 3] = rgba[np.argsort(sign * rgba[:, 3].astype(np.int64), kind="stable"), 3][rank]
    return _copied(config, depth, rgba, rank)


def _copied(config: Scene, depth: np.ndarray, rgba: np.ndarray,
            rank: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Each depth given to `depth_copies` quads that are neighbours in depth."""
    if config.depth_copies == 1:
        return depth, rgba
    at_rank = np.argsort(rank)
    original = at_rank[rank - rank % config.depth_copies]
    return depth[original], rgba[original] if config.copies == "alike" else rgba


def odd(config: Scene, depth: np.ndarray) -> np.ndarray:
    """The depths in submission order, the first of them odd."""
    if config.odd_depth == "none" or not len(depth):
        return depth
    return np.concatenate([np.array([ODD_DEPTHS[config.odd_depth]], dtype=np.float32), depth[1:]])


def reaching(config: Scene, rect: np.ndarray) -> np.ndarray:
    """The rectangles with the overhang on each side."""
    return rect + np.array([-1, -1, 1, 1], dtype=np.int32) * np.int32(config.overhang)
