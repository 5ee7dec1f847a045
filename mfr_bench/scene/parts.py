"""The payloads of scenes whose effect is on objects: a face's object and side beside its colour."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..effects import Settings, coverage
from ..effects.word import OBJECTS, packed
from ..errors import UsageError
from .geometry import Geometry
from .meshes.view import facing
from .pieces import MaskedPieces
from .triangles import Triangles

DARKEST = 0.3  # of the light on a face, seen from its edge


def with_effect(made: Geometry, settings: Settings) -> Geometry:
    """The scene with the effect, and with payloads that have what it needs. Raises UsageError where they cannot."""
    if settings.msaa > 1:
        return in_samples(made, settings)
    if settings.effect.needs == "nothing":
        return replace(made, effect=settings)
    objects, front = _parts_of(made, settings)
    if settings.effect.needs == "objects" and objects.max(initial=0) >= OBJECTS:
        raise UsageError(f"scene.effect: {settings.name} of {objects.max() + 1} objects; allowed: at most {OBJECTS}")
    return replace(made, effect=settings, rgba=packed(_coloured(made, objects, settings), objects, front))


def in_samples(made: Geometry, settings: Settings) -> Geometry:
    """The scene in several samples a pixel, with payloads that have room for coverage masks, or have them already.

    Raises UsageError for a scene whose opaque triangles are drawn into a depth buffer, which has one sample a pixel.
    """
    if made.occluded:
        raise UsageError(f"scene.msaa: {settings.msaa} with opaque triangles in a depth buffer of one sample a pixel; "
                         "allowed: with opaque store")
    masks = made.coverage if isinstance(made, MaskedPieces) else coverage.ALL_SAMPLES
    return replace(made, effect=settings, rgba=coverage.packed(made.rgba, masks))


def _parts_of(made: Geometry, settings: Settings) -> tuple[np.ndarray, np.ndarray]:
    """Object int32 (n,) and front bool (n,) of each primitive."""
    if isinstance(made, Triangles):
        return made.object, facing(made.position.astype(np.float64)) >= 0
    objects, front = getattr(made, "object", None), getattr(made, "front", None)
    if objects is None or front is None:
        raise UsageError(f"scene.effect: {settings.name} needs objects and the sides that are seen; allowed: a mesh, "
                         "or a recording with object and front")
    return objects, front


def _coloured(made: Geometry, objects: np.ndarray, settings: Settings) -> np.ndarray:
    """uint8 (n, 4): colours as the effect wants them: of one medium in each object, or lit from the eye."""
    if settings.name == "translucency":
        _, which = np.unique(objects, return_inverse=True)
        faces = np.maximum(np.bincount(which), 1)
        mean = np.stack([np.bincount(which, weights=channel) / faces for channel in made.rgba.T], axis=-1)
        return np.rint(mean[which]).astype(np.uint8)
    if settings.name == "csg" and isinstance(made, Triangles):
        light = DARKEST + (1.0 - DARKEST) * _towards_the_eye(made)
        return np.concatenate([np.rint(made.rgba[:, :3] * light[:, None]).astype(np.uint8), made.rgba[:, 3:]], axis=1)
    return made.rgba


def _towards_the_eye(made: Triangles) -> np.ndarray:
    """float64 (n,): from 0 for a face that is seen from its edge to 1 for one across the view, in clip space."""
    corners = made.position.astype(np.float64)
    place = corners[..., :3] / np.where(corners[..., 3:] > 0, corners[..., 3:], np.inf)
    normal = np.cross(place[:, 1] - place[:, 0], place[:, 2] - place[:, 0])
    length = np.sqrt((normal ** 2).sum(axis=-1))
    return np.abs(normal[:, 2]) / np.where(length > 0, length, 1.0)
