"""Cells with their keys. Knows no device: what the keys cover of it is given."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from ..effects import Settings
from ..glsl.digest import glsl_hash
from ..methods.spec import Method, Variant
from ..plan import Cell, expected_stats
from ..scene.kinds import kind_of
from ..store.record import cell_key

Shaders = tuple[Variant, str, Settings]  # the geometry has a vertex shader of its own, the effect a file in resolves


@dataclass(frozen=True)
class Job:
    """A cell with its key: what to measure, and under which name it is kept. Plain values, which pickle."""

    cell: Cell
    key: str
    glsl_hash: str
    # Name, version and hash of what brings the method from outside, the effect, and the scene.
    package: Mapping[str, str | None] | None = None
    effect_package: Mapping[str, str | None] | None = None
    scene_package: Mapping[str, str | None] | None = None


def jobs(cells: Sequence[Cell], catalog: Mapping[str, Method], device: Mapping[str, str], timer: str,
         codes: dict[Shaders, str] | None = None) -> list[Job]:
    """The cells with their keys, which cover the method with its GLSL and parameters, scene, settings and device.

    Labels are no part: cells that differ in nothing else are one measurement. The code of a package from outside is a
    part, its version is none. `codes` keeps the hashes from call to call.
    """
    codes = {} if codes is None else codes
    found = []
    for cell in cells:
        method = catalog[cell.method]
        stats = expected_stats(cell.scene)
        shaders = method.variant(cell.params), stats.geometry, stats.effect
        packages = {"package": method.package, "effect_package": stats.effect.effect.package,
                    "scene_package": kind_of(cell.scene).package(cell.scene)}
        code = codes.get(shaders) or codes.setdefault(shaders, glsl_hash(*shaders))
        name = cell_key({"method": cell.method, "params": dict(cell.params), "glsl_hash": code,
                         "scene": cell.scene.as_dict(), "measure": cell.measure.as_dict(), "device": device,
                         **packages}, timer)
        found.append(Job(cell, name, code, **packages))
    return found
