"""Frames of small scenes made by hand, for what is special in a family."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager

import numpy as np
import pytest

from mfr_bench.gpu.frame import Frame
from mfr_bench.gpu.scene_buffer import SceneBuffer
from mfr_bench.gpu.targets import Canvas
from mfr_bench.methods import catalog
from mfr_bench.methods.spec import Fitted
from mfr_bench.oracle.composite import stats_of
from mfr_bench.scene.quads import Quads

SIZE = (7, 5)  # pixels of a stack's viewport


def stack(depths: Sequence[float], rgba: Sequence[Sequence[int]] | None = None, size: tuple[int, int] = SIZE) -> Quads:
    """Quads over the whole viewport, in order of submission, of random colours where none are given.

    Equal depths are allowed.
    """
    rect = np.tile(np.array([0, 0, *size], dtype=np.int32), (len(depths), 1))
    if rgba is None:
        rgba = np.random.default_rng(1).integers(30, 226, (len(depths), 4))
    return Quads(size, rect, np.array(depths, dtype=np.float32), np.array(rgba, dtype=np.uint8), 1.0, 0)


def chosen(scene: Quads, quads) -> Quads:
    """Some quads of a scene, by index or slice, in its order."""
    return Quads(scene.viewport, scene.rect[quads], scene.depth[quads], scene.rgba[quads], 1.0, scene.seed)


def over(rgba: Sequence[Sequence[int]]) -> np.ndarray:
    """Premultiplied RGBA of straight 8-bit layers, nearest first, over transparent black."""
    colour, transmittance = np.zeros(3), 1.0
    for layer in np.asarray(rgba) / 255.0:
        colour, transmittance = colour + transmittance * layer[3] * layer[:3], transmittance * (1 - layer[3])
    return np.append(colour, 1 - transmittance)


@contextmanager
def drawn(device, method: str, scene: Quads, frames: int = 1, **params) -> Iterator[Frame]:
    """A frame of the method, drawn `frames` times; skipped where the device cannot run it."""
    variant = catalog()[method].variant(params)
    missing = set(variant.needs) - device.features
    if missing:
        pytest.skip(f"this device lacks {', '.join(missing)}")
    stats = stats_of(scene)
    quads, canvas = SceneBuffer(device, scene), Canvas(device, (stats.W, stats.H))
    frame = Frame(device, Fitted(variant, stats), quads, canvas)
    try:
        for _ in range(frames):
            frame.draw_fitting()
        yield frame
    finally:
        for thing in (frame, canvas, quads):
            thing.release()


def assert_shows(frame: Frame, rgba: Sequence[Sequence[int]]) -> None:
    """Every pixel shows these layers, nearest first, and nothing was lost."""
    assert frame.lost_fragments() == 0
    np.testing.assert_allclose(frame.image(), np.broadcast_to(over(rgba), (*SIZE[::-1], 4)), rtol=0, atol=1e-5)
