"""Quads so many and so small that their fragments are listed one by one, instead of by patches of the screen."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from .quads import Quads


@dataclass(frozen=True)
class Pieces(Quads):
    """Small quads in submission order.

    object: int32 (n,) or None, the part of a recorded scene that a quad belongs to. front:
    bool (n,) or None, whether its front was seen.
    """

    object: np.ndarray | None = None
    front: np.ndarray | None = None


@dataclass(frozen=True)
class MaskedPieces(Pieces):
    """Small quads that cover those samples of their pixels that their masks say, whatever a device rasterizes.

    coverage: uint8 (n,), a bit for each sample.
    """

    coverage: np.ndarray = field(kw_only=True)
