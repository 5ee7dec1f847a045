"""The hash of a variant's shaders, by which a measured cell knows whether they are still the same."""

from __future__ import annotations

import hashlib
import re
from collections.abc import Iterable
from dataclasses import replace

from ..effects import PLAIN, Settings
from ..methods.spec import Fitted, Pass, SceneStats, Variant
from .includes import StageSource
from .prelude import define_values, stages

Stages = tuple[StageSource, ...]  # of one pass
PassCode = tuple[Pass, tuple[str, ...], int, int]  # constants that the code names, a digest of the rest, characters
MOST_KEPT = 1024  # variants of which that is kept
DEFINED = re.compile(r"^#define ([A-Z][A-Z0-9_]*) -?[0-9.]+u?$", re.MULTILINE)  # numbers that a program names
_kept: dict[tuple[Variant, str, Settings], list[PassCode]] = {}
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
    """Hash of the code of every stage of every pass, for any scene of this geometry and effect; see `hash_of`.

    What `code_of_programs` tells of the variant is kept: putting the code together takes most of the time of both.
    """
    passes = stages_by_pass(variant, geometry, effect)
    _keep(variant, geometry, effect, passes)
    return hash_of(passes)


def code_of_programs(fitted: Fitted) -> tuple[dict[int, int], dict[int, int]]:
    """The code that a frame of a scene compiles, and that which counts its fragments in the end: characters by digest.

    Scenes whose constants are the same, as far as a program names them, share it. The digests hold in this process
    alone; characters are those of any scene.
    """
    drawn: dict[int, int] = {}
    counted: dict[int, int] = {}
    for step, names, digest, characters in _told(fitted.variant, fitted.stats.geometry, fitted.stats.effect):
        if fitted.needed(step):
            values = define_values(fitted, step)
            (counted if step.probes else drawn)[hash((digest, *map(values.get, names)))] = characters
    return drawn, counted


def _told(variant: Variant, geometry: str, effect: Settings) -> list[PassCode]:
    """The code of a variant's passes in numbers; as it was when its hash was taken, if that is kept."""
    return _kept.get((variant, geometry, effect)) or _keep(
        variant, geometry, effect, stages_by_pass(variant, geometry, effect))


def _keep(variant: Variant, geometry: str, effect: Settings, passes: list[tuple[Pass, Stages]]) -> list[PassCode]:
    found = []
    for step, made in passes:
        code = "".join(stage.code for stage in made)
        plain = DEFINED.sub("", code)
        found.append((step, tuple(sorted(set(DEFINED.findall(code)))), hash(plain), len(made[-1].code)))
    if len(_kept) >= MOST_KEPT:
        _kept.clear()
    _kept[variant, geometry, effect] = found
    return found
