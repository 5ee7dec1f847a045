"""Reads back every fragment that a device makes of a scene, by passes of its own, for the oracle of slanted scenes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..errors import DeviceError
from ..methods.shared import clear
from ..methods.spec import EMPTY, Buffer, Fitted, Method, Pass, SceneStats, State, Target
from ..oracle.composite import Fragments, in_chunks, scene_stats
from ..scene.geometry import Geometry
from .context import Device
from .frame import Frame
from .scene_buffer import SceneBuffer
from .targets import Canvas

CHUNK_BYTES = 64 * 2**20  # of one storage block and read-back
NODE_BYTES = 8

Captured = tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray | None]

FOUND = Buffer("found", "P", clear="0u", coherent=True)


def _capture(name: str, *steps: Pass, buffers: tuple[Buffer, ...], targets: tuple[Target, ...] = ()) -> Method:
    return Method(id=f"capture-{name}", name=name, family="probe", source="oracle", summary="", guarantee="none",
                  words="0", ties="", steps=steps, buffers=buffers, targets=targets)


COUNT = _capture("count", clear("found"), Pass("count", "geometry", "probe/capture_count.frag", writes=("found",)),
                 buffers=(FOUND,))
DEPTH = Target("depth", "depth32f")
COUNT_IN_FRONT = _capture(
    "count-in-front", clear("found"),
    Pass("count", "geometry", "probe/capture_count.frag", writes=("found",), into=(DEPTH.name,), opaque_first=True,
         clears={DEPTH.name: (1.0,)}, state=State(depth_test="lequal", early=True)),
    buffers=(FOUND,), targets=(DEPTH,))
STORE = _capture("store", clear("found"),
                 Pass("store", "geometry", "probe/capture_store.frag", reads=("first",), writes=("found", "nodes")),
                 buffers=(FOUND, Buffer("first", "P"), Buffer("nodes", "2*F", type="uvec2")))
STORE_MASKS = _capture(
    "store-masks", clear("found"),
    Pass("store", "geometry", "probe/capture_masks.frag", reads=("first",), writes=("found", "nodes", "masks")),
    buffers=(*STORE.buffers, Buffer("masks", "F")))


def capture(device: Device, scene_buffer: SceneBuffer, canvas: Canvas) -> Fragments:
    """The fragments of the scene on the device. Raises as `captured` does."""
    return Fragments.of(scene_buffer.scene, *captured(device, scene_buffer, canvas))


def captured(device: Device, scene_buffer: SceneBuffer, canvas: Canvas) -> Captured:
    """The fragments of the scene on the device, pixel by pixel, in any order within a pixel.

    Their counts int64 (H, W), depths uint32 (F,), primitives uint32 (F,), and coverage masks uint8 (F,) or None.
    Raises DeviceError where a pass does not see what the other saw: nothing is lost without notice. MemoryError where
    there is no room.
    """
    stats = _uncounted(scene_buffer.scene)
    counts = count(device, scene_buffer, canvas)
    depth, primitive = (np.empty(int(counts.sum()), dtype=np.uint32) for _ in range(2))
    masks = None if stats.one_sample else np.empty(len(depth), dtype=np.uint8)
    room = min(CHUNK_BYTES, device.max_block_bytes) // NODE_BYTES
    for pixels, part in in_chunks(counts.ravel(), room):
        if part.stop > part.start:
            nodes, found = _stored(device, stats, scene_buffer, canvas, counts.ravel(), pixels)
            depth[part], primitive[part] = nodes[:, 0], nodes[:, 1]
            if masks is not None:
                masks[part] = found
    return counts, depth, primitive, masks


def _uncounted(scene: Geometry) -> SceneStats:
    """The statistics that are known before any fragment is."""
    return scene_stats(scene, np.zeros(1, dtype=np.int64))


def count(device: Device, scene_buffer: SceneBuffer, canvas: Canvas, opaque_first: bool = False) -> np.ndarray:
    """int64 (H, W): the fragments of each pixel, of the scene on the device.

    opaque_first: without those that opaque primitives hide, as a frame finds them that draws these first.
    """
    stats = _uncounted(scene_buffer.scene)
    frame = Frame(device, Fitted((COUNT_IN_FRONT if opaque_first else COUNT).variant({}), stats), scene_buffer, canvas)
    try:
        frame.draw()
        return frame.words("found").astype(np.int64).reshape(stats.H, stats.W)
    finally:
        frame.release()


def _stored(device: Device, stats: SceneStats, scene_buffer: SceneBuffer, canvas: Canvas, counts: np.ndarray,
            pixels: slice) -> tuple[np.ndarray, np.ndarray | None]:
    """The fragments of a range of pixels, pixel by pixel.

    First uint32 (fragments, 2), depth bits and primitive; then uint32 (fragments,), coverage masks, or None where the
    scene is rasterized into one sample a pixel.
    """
    here = counts[pixels]
    first = np.full(len(counts), EMPTY, dtype=np.uint32)
    first[pixels] = np.cumsum(here) - here
    store = STORE if stats.one_sample else STORE_MASKS
    frame = Frame(device, Fitted(store.variant({}), replace(stats, F=int(here.sum()))), scene_buffer, canvas)
    try:
        frame.fill("first", first)
        frame.draw()
        found, lost = frame.words("found")[pixels].astype(np.int64), frame.lost_fragments()
        if lost or (found != here).any():
            raise DeviceError(f"capture: {int(found.sum())} fragments where {int(here.sum())} were counted, "
                              f"{lost} without room; the device draws one scene in two ways")
        return frame.words("nodes").reshape(-1, 2), None if stats.one_sample else frame.words("masks")
    finally:
        frame.release()
