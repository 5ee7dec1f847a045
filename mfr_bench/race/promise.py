"""The promise of a variant about its image in a scene, as the race machine can check it."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

from ..methods.spec import Fitted, SceneStats, Variant
from ..oracle import twochannel
from ..oracle.ties import Answer, answer_of_quads
from ..scene.quads import Quads


class Kind(Enum):
    """The way in which an image is judged."""

    EXACT = "the image that it promises"
    WITHIN = "an image within the bound that it promises"
    IN_ORDER = "an image that some order of the fragments, one after the other, gives as well"
    NONE = "nothing: hazards are counted"


@dataclass(frozen=True)
class Promised:
    """The kind of promise, and the error that it allows of a channel in addition to rounding."""

    kind: Kind
    error: float = 0.0
    counted: bool = False  # fragments may be lost that are counted


def promised(variant: Variant, stats: SceneStats) -> Promised:
    """The promise about the variant's image that holds whatever the schedule."""
    method = variant.method
    if variant.scope.get("sync") == "none":
        return Promised(Kind.NONE)
    counted = variant.counts_losses
    if (error := variant.weakened_error) is not None:
        return Promised(Kind.WITHIN, error, counted)
    if variant.weaknesses or method.mixes or method.guarantee == "none":
        return Promised(Kind.IN_ORDER, counted=counted)
    if Fitted(variant, stats).exact():
        return Promised(Kind.EXACT)
    return Promised(Kind.EXACT, counted=True) if counted else Promised(Kind.NONE)


def expected(variant: Variant, stats: SceneStats, scene: Quads) -> Answer:
    """The images that the variant aims at."""
    aim = Fitted(variant, stats).promise()
    payload = twochannel.straight(scene.rgba) if variant.two_channel else None
    return answer_of_quads(scene, aim.layers, aim.criterion, payload)
