"""The trial of how a device rasterizes triangles, against an independent rasterizer (docs/accuracy.md)."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from ..oracle.composite import Fragments
from ..oracle.rasterizer.cases import CASES, GRID_BITS, on_grid
from ..oracle.rasterizer.deviation import Deviation, deviation, keys_of
from ..oracle.rasterizer.rules import RULES, covered
from ..scene.triangles import Triangles
from .capture import capture
from .context import Device
from .scene_buffer import SceneBuffer
from .targets import Canvas


def triangles(device: Device) -> tuple[bool, str]:
    """Whether the fragments of all cases are within bounds, and what the device does within them."""
    found = {name: fragments(device, case()) for name, case in CASES.items()}
    off = {name: deviation(fragments, device.subpixel_bits) for name, fragments in found.items()}
    twice, gaps = _of_sheet(found["shared edges"].counts)
    wrong = [f"{name}: {said}" for name, said in off.items() if not said.within]
    if twice or gaps:
        wrong.append(f"shared edges: {gaps} pixels without a fragment, {twice} with several")
    count, bits = sum(d.fragments for d in off.values()), device.subpixel_bits
    right = (f"{count} fragments within bounds; grid of 1/{1 << bits} pixel; {rule_of(found['corners on the grid'])}; "
             f"coverage off by at most {_worst(off.values()):.2g} pixels")
    return not wrong, "; ".join(wrong) or right


def fragments(device: Device, scene: Triangles) -> Fragments:
    """The fragments that the device makes of a scene."""
    scene_buffer, canvas = SceneBuffer(device, scene), Canvas(device, scene.viewport)
    try:
        return capture(device, scene_buffer, canvas)
    finally:
        canvas.release()
        scene_buffer.release()


def rule_of(found: Fragments) -> str:
    """The rule by which the device takes middles on an edge, or by how many fragments it differs from the nearest."""
    differing = {rule: len(np.setxor1d(covered(on_grid(), rule, GRID_BITS), keys_of(found))) for rule in RULES}
    rule = min(differing, key=differing.get)
    return f"middles on edges by the {rule} rule" + (
        f", but for {differing[rule]} fragments" if differing[rule] else "")


def _of_sheet(counts: np.ndarray) -> tuple[int, int]:
    """Pixels of a sheet without gaps that have several fragments, and none."""
    return int((counts > 1).sum()), int((counts == 0).sum())


def _worst(off: Iterable[Deviation]) -> float:
    return max(d.coverage_px for d in off)
