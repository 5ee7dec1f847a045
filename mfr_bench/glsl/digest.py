"""The hash of a variant's shaders, by which a measured cell knows whether they are still the same."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable
from dataclasses import replace

from ..effects import PLAIN, Settings
from ..methods.spec import Fitted, Pass, SceneStats, Variant
from .includes import StageSource
from .prelude import stages

Stages = tuple[StageSource, ...]  # of one pass
NOMINAL = SceneStats(W=1, H=1, n=2, F=1, primitives=1)  # the scene is in a cell's key of its own


def fitted_nominally(variant: Variant, geometry: str, effect: Settings = PLAIN) -> Fitted:
    """The variant with statistics that stand for any scene of this geometry and this effect."""
    return Fitted(variant, replace(NOMINAL, geometry=geometry, effect=effect))


def stages_by_pass(variant: Variant, geometry: str, effect: Settings = PLAIN) -> list[tuple[Pass, Stages]]:
    """The passes of a variant that have shaders, each with its stages for any scene of this geometry and effect."""
    fitted = fitted_nominally(variant, geometry, effect)
    return [(step, stages(fitted, step)) for step in variant.passes if step.kind != "clear"]


def hash_of(passes: Iterable[tuple[Pass, Stages]]) -> str:
    """Hash of the code of every stage of these passes.

    Comments and blank lines are no code: editing them measures nothing again.
    """
    digest = hashlib.sha256()
    for _, found in passes:
        for stage in found:
            digest.update(stage.code.encode())
    return digest.hexdigest()[:16]


def glsl_hash(variant: Variant, geometry: str, effect: Settings = PLAIN) -> str:
    """Hash of the code of every stage of every pass, for any scene of this geometry and effect; see `hash_of`."""
    return hash_of(stages_by_pass(variant, geometry, effect))
