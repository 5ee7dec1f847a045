"""The samples of a device's pixels: where they lie, and whether it reports those that a fragment covers."""

from __future__ import annotations

import ctypes
from dataclasses import replace

import numpy as np

from ..effects import Settings
from ..methods.spec import Fitted, Pass
from ..oracle.composite import Fragments
from ..oracle.rasterizer.masks import depth_inside, disagreements
from ..scene.parts import in_samples
from ..scene.triangles import Triangles
from . import rawgl
from .capture import capture
from .context import Device
from .frame import Frame
from .probes import COUNTER, probe_method
from .single import shown
from .targets import Framebuffer, Texture

VIEWPORT, TRIANGLES, SEED = (24, 20), 12, 5
COUNTED = probe_method("fragments of samples",
                       Pass("count", "geometry", "common/count.frag", writes=("counter",)), buffers=(COUNTER,))


def places(device: Device, samples: int) -> np.ndarray:
    """float64 (samples, 2): the places of a pixel's samples, from its lower left; a sample is a bit of a mask."""
    texture = Texture(device.gl, "rgba32f", (1, 1), samples)
    framebuffer = Framebuffer(device.gl, [texture])
    found = np.empty((samples, 2), dtype=np.float32)
    try:
        for sample, place in enumerate(found):
            device.gl.glGetMultisamplefv(rawgl.SAMPLE_POSITION, sample,
                                         place.ctypes.data_as(ctypes.POINTER(ctypes.c_float)))
    finally:
        framebuffer.release()
        texture.release()
    return found.astype(np.float64)


def soup(viewport: tuple[int, int] = VIEWPORT, count: int = TRIANGLES, seed: int = SEED) -> Triangles:
    """Random triangles over the viewport and beyond its edges."""
    numbers = np.random.default_rng(seed)
    corners = np.ones((count, 3, 4), dtype=np.float32)
    corners[..., :2] = numbers.uniform(-1.2, 1.2, (count, 3, 2))
    corners[..., 2] = numbers.uniform(-0.9, 0.9, (count, 3))
    rgba = numbers.integers(20, 250, (count, 4), dtype=np.uint8)
    return Triangles(viewport, corners, rgba, 1.0, seed, np.arange(count, dtype=np.int32))


def masks_of(fragments: Fragments) -> np.ndarray:
    """uint8 (n, H, W): the mask of each primitive in each pixel.

    A driver may cut a triangle that reaches beyond the viewport into several, which share the samples of a pixel.
    """
    found = np.zeros((len(fragments.scene), fragments.counts.size), dtype=np.uint8)
    np.bitwise_or.at(found, (fragments.primitive, fragments.of_pixels()), fragments.masks)
    return found.reshape(-1, *fragments.counts.shape)


def tried(device: Device, samples: int) -> tuple[bool, str]:
    """Whether coverage masks are those of the samples' places, and an occlusion query counts fragments.

    Each fragment lets one sample pass, as scene/one_sample.glsl asks.
    """
    scene = in_samples(soup(), replace(Settings(), msaa=samples))
    with shown(device, scene) as on:
        found = capture(device, on.scene_buffer, on.canvas)
        frame = Frame(device, Fitted(COUNTED.variant({}), on.stats), on.scene_buffer, on.canvas)
        counted = device.gl.samples_passed(frame.draw)
        frame.release()
    window = (scene.position[..., :2].astype(np.float64) + 1) / 2 * scene.viewport
    inside = depth_inside(window, scene.viewport, places(device, samples))
    wrong, made = np.count_nonzero(disagreements(masks_of(found), inside)), len(found.depth)
    return wrong == 0 and counted == made, (f"{wrong} coverage masks wrong, {counted} of {made} fragments counted by a "
                                            "query")
