"""Cells with their keys. Knows no device: what the keys cover of it is given."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from ..config.settings import Measure
from ..effects import Settings
from ..glsl.digest import glsl_hash
from ..methods.spec import Method, Variant, Variants
from ..plan import Cell, expected_stats
from ..scene import Scene
from ..scene.kinds import kind_of
from ..store.record import canonical, key_with, settings_text

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


def hash_codes(cells: Sequence[Cell], catalog: Mapping[str, Method], codes: dict[Shaders, str]) -> None:
    """Fill `codes` for these cells, which takes most of the time of `jobs` and needs no device."""
    variants = Variants(catalog)
    for cell in cells:
        _code(_shaders(cell, variants), codes)


def _shaders(cell: Cell, variants: Variants) -> Shaders:
    stats = expected_stats(cell.scene)
    return variants.of(cell.method, cell.params), stats.geometry, stats.effect


def _code(shaders: Shaders, codes: dict[Shaders, str]) -> str:
    return codes.get(shaders) or codes.setdefault(shaders, glsl_hash(*shaders))


def jobs(cells: Sequence[Cell], catalog: Mapping[str, Method], device: Mapping[str, str], timer: str,
         codes: dict[Shaders, str] | None = None) -> list[Job]:
    """The cells with their keys, which cover the method with its GLSL and parameters, scene, settings and device.

    Labels are no part: cells that differ in nothing else are one measurement. The code of a package from outside is a
    part, its version is none. `codes` keeps the hashes from call to call.
    """
    codes = {} if codes is None else codes
    variants, texts, found = Variants(catalog), _Texts(), []
    for cell in cells:
        shaders = _shaders(cell, variants)
        packages = {"package": catalog[cell.method].package, "effect_package": shaders[2].effect.package,
                    "scene_package": kind_of(cell.scene).package(cell.scene)}
        code = _code(shaders, codes)
        name = key_with({"method": cell.method, "params": cell.params, "glsl_hash": code, "device": device, **packages},
                        timer, texts[cell.scene], texts[cell.measure])
        found.append(Job(cell, name, code, **packages))
    return found


class _Texts(dict):
    """The texts of scenes and of settings, each made once for all cells that have it, however long that takes."""

    def __missing__(self, part: Scene | Measure) -> str:
        found = part.as_dict()
        self[part] = canonical(found) if isinstance(part, Scene) else settings_text(found)
        return self[part]
