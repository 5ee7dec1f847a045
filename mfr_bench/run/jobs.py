"""Cells with their keys. Knows no device: what the keys cover of it is given."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from ..glsl.digest import glsl_hash
from ..methods.spec import Method, Variant
from ..plan import Cell, expected_stats
from ..store import key

Shaders = tuple[Variant, str]  # the geometry, which has a vertex shader of its own
GUARDS = ("hard_limit_s", "hard_limit_mb")  # settings that end a cell, and change no number of one that ends well


@dataclass(frozen=True)
class Job:
    """A cell with its key: what to measure, and under which name it is kept. Plain values, which pickle."""

    cell: Cell
    key: str
    glsl_hash: str
    package: Mapping[str, str | None] | None = None  # name, version and hash of what brings the method from outside


def jobs(cells: Sequence[Cell], catalog: Mapping[str, Method], device: Mapping[str, str], timer: str,
         codes: dict[Shaders, str] | None = None) -> list[Job]:
    """The cells with their keys, which cover the method with its GLSL and parameters, scene, settings and device.

    Labels are no part: cells that differ in nothing else are one measurement. The code of a package from outside is a
    part, its version is none. `codes` keeps the hashes from call
    to call.
    """
    codes = {} if codes is None else codes
    found = []
    for cell in cells:
        method = catalog[cell.method]
        shaders = method.variant(cell.params), expected_stats(cell.scene).geometry
        code = codes.get(shaders) or codes.setdefault(shaders, glsl_hash(*shaders))
        settings = {name: value for name, value in cell.measure.as_dict().items() if name not in GUARDS}
        outside = {"package": [method.package["name"], method.package["hash"]]} if method.package else {}
        name = key({**outside, "method": cell.method, "params": dict(cell.params), "glsl": code,
                    "scene": cell.scene.as_dict(), "measure": settings,
                    "renderer": device["renderer"], "version": device["version"], "timer": timer})
        found.append(Job(cell, name, code, method.package))
    return found
