"""Scenes: what a config may say of them (`kinds`, `parameters`), and their generators in numpy; no GL.

Importing this package loads no numpy: a generator is loaded when a scene of its kind is made.
"""

from __future__ import annotations

from dataclasses import replace
from importlib import import_module
from typing import TYPE_CHECKING

from ..effects import PLAIN
from .kinds import kind_of
from .parameters import Scene

if TYPE_CHECKING:
    from .geometry import Geometry


def generate(scene: Scene, frame: int = 0) -> Geometry:
    """The primitives of a scene. In an animation's `frame` quads have another seed; an object is seen from nearer."""
    kind = kind_of(scene)
    made = getattr(kind.module, kind.generator.rpartition(".")[2])(scene, frame)
    made = replace(made, shading=scene.shading) if scene.shading else made
    return made if scene.settings == PLAIN else import_module(f"{__name__}.parts").with_effect(made, scene.settings)


__all__ = ["Scene", "generate"]
