"""The oracle of the scene on the device, of whichever kind; the images of methods are checked against it."""

from __future__ import annotations

from dataclasses import replace

from ..methods.spec import SceneStats
from ..oracle import truth
from ..oracle.composite import Fragments, scene_stats
from .capture import capture, count
from .context import Device
from .scene_buffer import SceneBuffer
from .targets import Canvas


def true_stats(device: Device, scene_buffer: SceneBuffer, canvas: Canvas) -> SceneStats:
    """The statistics of the scene on the device: of flat quads by the oracle, else as the device counts."""
    scene = scene_buffer.scene
    if known := truth.known_stats(scene):
        return known
    stats = scene_stats(scene, count(device, scene_buffer, canvas))
    if not (stats.draws_in_parts and stats.forward):
        return stats
    in_front = count(device, scene_buffer, canvas, opaque_first=True)
    return replace(stats, in_front=(int(in_front.sum()), max(1, int(in_front.max()))))


class Truth(truth.SceneTruth):
    """The images of one scene in float64. It must be the scene on the device when they are first asked for."""

    def __init__(self, device: Device, scene_buffer: SceneBuffer, canvas: Canvas):
        super().__init__(scene_buffer.scene)
        self._device, self._scene_buffer, self._canvas = device, scene_buffer, canvas

    def _of_device(self) -> Fragments:
        if self._scene_buffer.scene is not self.scene:
            raise ValueError("another scene is on the device")
        return capture(self._device, self._scene_buffer, self._canvas)
