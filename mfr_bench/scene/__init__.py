"""Scene generation in numpy; no GL."""

from .quads import Scene, generate

__all__ = ["Scene", "generate"]
