"""Quads so many and so small that their fragments are listed one by one, instead of by patches of the screen."""

from __future__ import annotations

from dataclasses import dataclass

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
