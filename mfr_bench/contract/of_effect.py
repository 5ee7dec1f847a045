"""The contract of an effect: its model against cases that are known and what its entry says, images against its model.

The fragments are recordings of a few pixels with closed objects, so that every effect can be drawn on them.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from ..effects import DEFAULTS, OPERATIONS, Case, Effect, Settings
from ..effects.rays import Rays
from ..effects.word import packed
from ..errors import MfrError
from ..oracle.effects import model_of
from ..oracle.listed import listed
from ..scene import Scene as SceneConfig
from ..scene import generate
from ..scene.recording import Recording
from . import images
from .cases import SLANTED
from .suite import Check

VIEWPORT = (17, 13)
OBJECTS = 5  # closed ones of a recording, each met once by a ray or not at all
LAYERS = 2 * OBJECTS  # of a pixel at most; of slanted primitives too, so that programs are shared
STEPS = 8  # of the depths where fragments share some
ROUNDING = 1e-9  # of a model in float64
OTHER: Mapping[str, tuple[Any, ...]] = {  # values of the keys that effects read, besides their defaults
    "layer": (3,), "absorption": (1.5,), "operation": OPERATIONS[1:]}
EXAMPLE = "Case(((0.25, (255, 0, 0, 128)), ...), (1.0, 0.0, 0.0, 1.0))"


def checks(device, name: str, effect: Effect, folder: Path) -> Sequence[Check]:
    """Every check of an effect by its name, in order; the recordings are written into a folder."""
    scenes, settings = scenes_of(name, effect, folder), Settings(name)
    found = (("the model shows the cases of the entry", lambda: cases(settings)),) if effect.cases else ()
    return (
        ("the entry says what a reader needs", lambda: what_a_reader_needs(effect)),
        *found,
        ("the model gives premultiplied colours, and nothing without fragments", lambda: colours(scenes)),
        ("the model takes each pixel by itself", lambda: by_itself(scenes)),
        ("the model keeps to what the entry says it reads", lambda: as_the_entry_says(scenes, effect)),
        ("methods draw what the model computes", lambda: images.of_every_family(device, drawn(scenes, effect))),
    )


def what_a_reader_needs(effect: Effect) -> Iterator[str]:
    """Check that the entry says on one line what the image shows."""
    if not effect.what.strip() or "\n" in effect.what:
        yield f"the entry says {effect.what!r}; allowed: one line that says what the image shows"


def scenes_of(name: str, effect: Effect, folder: Path) -> dict[str, SceneConfig]:
    """Recordings as scenes with the effect, by what they have."""
    found = {"closed objects": recording(OBJECTS), "nothing": recording(0), "an object": recording(1)}
    if not effect.ordered:
        found["equal depths"] = recording(OBJECTS, STEPS)
    for number, made in enumerate(found.values()):
        (folder / f"{number}.npz").write_bytes(made.packed())
    return {said: SceneConfig(kind="fragments", file=f"{number}.npz", folder=str(folder), size=VIEWPORT, order="file",
                              depth_complexity=0, effect=name) for number, said in enumerate(found)}


def recording(objects: int, steps: int | None = None) -> Recording:
    """Fragments of so many closed objects, each of which a ray enters and leaves once, or misses, at random.

    steps: depths are multiples of its inverse, so that fragments share some; None: no two do.
    """
    rng = np.random.default_rng(objects)
    width, height = VIEWPORT
    pixel = np.stack(np.meshgrid(np.arange(width), np.arange(height)), axis=-1).reshape(-1, 1, 2)
    met = rng.random((width * height, objects)) < 0.6
    ends = np.sort(rng.permuted(np.arange(1, 2 * objects + 1) / (2 * objects + 1.0) + np.zeros((len(met), 1)), axis=1)
                   .reshape(len(met), objects, 2), axis=2)
    depth = (np.round(ends * steps) / steps if steps else ends)[met].ravel()
    of = np.broadcast_to(np.arange(objects), met.shape)[met].repeat(2)
    rgba = rng.integers((0, 0, 0, 26), 256, (len(of), 4))
    order = rng.permutation(len(of))
    return Recording(VIEWPORT, np.broadcast_to(pixel, (*met.shape, 2))[met].repeat(2, axis=0)[order].astype(np.int32),
                     depth[order].astype(np.float32), rgba[order].astype(np.uint8), of[order].astype(np.int32),
                     np.tile([True, False], len(of) // 2)[order])


def drawn(scenes: Mapping[str, SceneConfig], effect: Effect) -> dict[str, SceneConfig]:
    """The scenes that methods draw: each recording, slanted primitives, and one with other values of every key."""
    first = next(iter(scenes.values()))
    found = dict(scenes)
    if effect.needs == "nothing":
        found["slanted"] = replace(SLANTED["crossing"], effect=first.effect, depth_complexity=LAYERS)
    found |= {f"{key} {value}": replace(first, **{key: value}) for key in effect.keys for value in OTHER[key]}
    return found


def rays_of(scene: SceneConfig) -> Rays:
    """The fragments of a scene, as the model reads them."""
    fragments = listed(generate(scene))
    return Rays(fragments.counts.ravel(), fragments.depth.view(np.float32).astype(np.float64), fragments.payloads())


def image_of(rays: Rays, settings: Settings) -> np.ndarray:
    """float64 (pixels, 4), by the model."""
    return model_of(settings)(rays, settings)


def cases(settings: Settings) -> Iterator[str]:
    """Check that the model shows what the entry's cases say."""
    for number, case in enumerate(settings.effect.cases, 1):
        rays = rays_of_case(case, settings.effect, f"case {number}")
        shown = image_of(rays, replace(settings, **case.keys))[0]
        if np.abs(shown - case.shows).max() > 1e-6:
            yield f"case {number}: the model shows {np.round(shown, 6).tolist()}, the case has {list(case.shows)}"


def rays_of_case(case: Case, effect: Effect, where: str) -> Rays:
    """The one pixel of a case. Raises MfrError for fragments that are none."""
    wide = 2 if effect.needs == "nothing" else 4
    unknown = set(case.keys) - set(effect.keys)
    try:
        columns = list(zip(*case.fragments, strict=True)) or [()] * wide
        depth, rgba = np.array(columns[0], np.float64), np.array(columns[1], np.int64).reshape(-1, 4)
        right = (len(columns) == wide and len(case.shows) == 4 and (np.diff(depth) >= 0).all()
                 and ((rgba >= 0) & (rgba <= 255)).all() and ((depth >= 0) & (depth <= 1)).all())
        if right and wide == 4:
            rgba = packed(rgba.astype(np.uint8), np.array(columns[2], np.int64), np.array(columns[3], bool))
    except (TypeError, ValueError):
        right = False
    if not right:
        also = "" if wide == 2 else ", each fragment with object and front behind its colour"
        raise MfrError(f"{where} is {case.fragments!r}; allowed: {EXAMPLE}, the nearest fragment first{also}")
    if unknown:
        raise MfrError(f"{where} has the key {min(unknown)!r}; allowed: {', '.join(effect.keys) or 'none'}")
    return Rays(np.array([len(depth)]), depth, rgba.astype(np.uint8))


def colours(scenes: Mapping[str, SceneConfig]) -> Iterator[str]:
    """Check that colours are from 0 to opacity, opacity is at most 1, and pixels without fragments are transparent."""
    for name, scene in scenes.items():
        rays = rays_of(scene)
        image = image_of(rays, scene.settings)
        beyond = ((image < -ROUNDING) | (image > image[:, 3:] + ROUNDING) | (image > 1 + ROUNDING)).any(axis=1)
        for wrong, said in ((beyond, "a colour below 0, above its opacity, or an opacity above 1"),
                            ((rays.counts == 0) & (image != 0).any(axis=1), "a colour where there is no fragment")):
            if wrong.any():
                yield f"{name}: {said}: {image[np.argmax(wrong)].tolist()}"


def by_itself(scenes: Mapping[str, SceneConfig]) -> Iterator[str]:
    """Check that the image of a pixel is the same with others and without, and each time it is computed."""
    for name, scene in scenes.items():
        rays = rays_of(scene)
        image, ends = image_of(rays, scene.settings), np.cumsum(rays.counts)
        for pixel, (count, end) in enumerate(zip(rays.counts, ends, strict=True)):
            part = slice(end - count, end)
            alone = image_of(Rays(rays.counts[pixel:pixel + 1], rays.depth[part], rays.rgba[part]), scene.settings)[0]
            if np.abs(alone - image[pixel]).max() > ROUNDING:
                yield f"{name}: a pixel shows {alone.tolist()} alone, {image[pixel].tolist()} among others"
                break


def as_the_entry_says(scenes: Mapping[str, SceneConfig], effect: Effect) -> Iterator[str]:
    """Check that order at one depth, lengths and keys count for nothing where the entry does not name them."""
    for name, scene in scenes.items():
        rays = rays_of(scene)
        image = image_of(rays, scene.settings)
        for said, others, settings in _must_not_matter(rays, scene.settings, effect):
            if np.abs(image_of(others, settings) - image).max(initial=0.0) > ROUNDING:
                yield f"{name}: {said}"


def _must_not_matter(rays: Rays, settings: Settings, effect: Effect) -> Iterator[tuple[str, Rays, Settings]]:
    """What the entry leaves out, the fragments with another of it, and the settings."""
    if not effect.ordered:
        turned = np.lexsort((-np.arange(len(rays.depth)), rays.depth, np.repeat(np.arange(rays.counts.size),
                                                                                 rays.counts)))
        yield ("the order of fragments of one depth matters; allowed: with ordered=True in the entry",
               replace(rays, rgba=rays.rgba[turned]), settings)
    if not effect.measures:
        yield ("differences of depth matter; allowed: with measures=True in the entry",
               replace(rays, depth=rays.depth**2), settings)
    for key in sorted(OTHER.keys() - set(effect.keys)):
        yield (f"{key} matters; allowed: with {key!r} in the keys of the entry", rays,
               replace(settings, **{key: next(value for value in OTHER[key] if value != DEFAULTS[key])}))
