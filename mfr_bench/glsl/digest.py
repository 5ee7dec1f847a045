"""The hash of a variant's shaders, by which a measured cell knows whether they are still the same."""

from __future__ import annotations

import hashlib
from dataclasses import replace

from ..effects import PLAIN, Settings
from ..methods.spec import Fitted, SceneStats, Variant
from .prelude import stages

NOMINAL = SceneStats(W=1, H=1, n=2, F=1, primitives=1)  # the scene is in a cell's key of its own


def fitted_nominally(variant: Variant, geometry: str, effect: Settings = PLAIN) -> Fitted:
    """The variant with statistics that stand for any scene of this geometry and this effect."""
    return Fitted(variant, replace(NOMINAL, geometry=geometry, effect=effect))


def glsl_hash(variant: Variant, geometry: str, effect: Settings = PLAIN) -> str:
    """Hash of the code of every stage of every pass, for any scene of this geometry and effect.

    Comments and blank lines are no code: editing them measures nothing again.
    """
    digest = hashlib.sha256()
    for step in variant.passes:
        for stage in stages(fitted_nominally(variant, geometry, effect), step) if step.kind != "clear" else ():
            digest.update(stage.code.encode())
    return digest.hexdigest()[:16]
