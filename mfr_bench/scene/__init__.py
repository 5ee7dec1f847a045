"""Scene generation in numpy; no GL."""

from __future__ import annotations

from ..config.layout import is_flat
from ..config.model import Scene as SceneConfig
from .hairball import hairball
from .needles import needles
from .quads import Scene, flat_quads
from .slanted import slanted
from .strips import Strips
from .temple import temple
from .triangles import Triangles

Geometry = Scene | Strips | Triangles

OBJECTS = {"hairball": hairball, "needles": needles, "temple": temple}


def generate(config: SceneConfig, frame: int = 0) -> Geometry:
    """The scene of a config. In an animation's `frame` quads have another seed; an object is seen from nearer."""
    if config.kind in OBJECTS:
        return OBJECTS[config.kind](config, frame)
    seed = (config.seed + frame) % 2**32
    return flat_quads(config, seed) if is_flat(config) else slanted(config, seed)


__all__ = ["Geometry", "Scene", "Strips", "Triangles", "generate"]
