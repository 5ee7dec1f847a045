"""Makes the scenes of `kind: quads` (kplus_2015 §5.1, gpupro5_ch1 §1.7.2), bit for bit the same for a seed."""

from __future__ import annotations

import numpy as np

from ..hashing import hash3
from . import stress
from .colours import rgba
from .kinds.quads import KIND, is_flat
from .layouts import depths, rectangles
from .parameters import Scene
from .quads import Quads
from .slanted import slanted
from .streams import ORDER
from .strips import Strips


def quads(config: Scene, frame: int) -> Quads | Strips:
    """The quads of a config, each of one depth or tilted. Every frame of an animation has a seed of its own."""
    seed = (config.seed + frame) % 2**32
    return flat_quads(config, seed) if is_flat(config) else slanted(config, seed)


def flat_quads(config: Scene, seed: int) -> Quads:
    """The quads of a layout, each of one depth."""
    rect = rectangles(config, seed)
    index = np.arange(len(rect), dtype=np.uint64)
    depth, colours = stress.values(config, depths(index, seed), rgba(config, index, seed))
    order = submission(config.order, depth, index, seed)
    rect, depth = stress.reaching(config, rect[order]), stress.odd(config, depth[order])
    return Quads(tuple(config.size), rect, depth, colours[order], config.fragment_probability, seed,
                 KIND.least_layers(config))


def submission(order: str, depth: np.ndarray, index: np.ndarray, seed: int) -> np.ndarray:
    """Indices of the quads at these depths in an order of submission."""
    if order == "front_to_back":
        return np.argsort(depth, kind="stable")
    if order == "back_to_front":
        return np.argsort(-depth, kind="stable")
    return np.argsort(hash3(index, ORDER, seed), kind="stable")
