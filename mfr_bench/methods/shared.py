"""Parameters and passes that several families share. Each is one declaration over shared shader code."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from .spec import IMAGE, ON_OFF, Param, Pass

K = Param("k", 8, "fragments kept per pixel, the nearest", low=1, high=1024)
SYNC = Param("sync", "spin", "mutual exclusion per pixel: spin lock with a semaphore, or fragment shader interlock",
             choices=("spin", "interlock"), needs={"interlock": "fragment_shader_interlock"})
CULLING = Param("culling", "on", "refuse fragments beyond the furthest kept before the critical section",
                choices=ON_OFF)
SORT = Param("sort", "hybrid", "sort of the resolve: insertion, shell, or insertion up to 16 fragments and shell above",
             choices=("insertion", "shell", "hybrid"))

CLEARED = (0.0, 0.0, 0.0, 0.0)
CLEAR_IMAGE = Pass("clear", "clear", clears={IMAGE: CLEARED}, into=(IMAGE,))


def clear(*buffers: str, **more) -> Pass:
    """Full-screen pass that gives the buffers their initial values."""
    return Pass("clear", "fullscreen", "common/clear.frag", writes=buffers, **more)


def count() -> Pass:
    """Geometry pass that counts fragments per pixel, and in total by an occlusion query."""
    return Pass("count", "geometry", "common/count.frag", writes=("counter",), counts=True)


def resolve(*reads: str, select: bool = False, defines: Mapping[str, Any] | None = None, **more) -> Pass:
    """Full-screen pass that sorts and composites what the pass's `fetch` reads; with `select` only the LOCAL nearest."""
    return Pass("resolve", "fullscreen", "common/resolve.frag", reads=reads, into=(IMAGE,),
                defines={"SELECT": int(select), **(defines or {})}, **more)


def resolve_sorted(*reads: str, **more) -> Pass:
    """Full-screen pass that composites fragments which the pass's `fetch` already reads nearest first."""
    return Pass("resolve", "fullscreen", "common/resolve_sorted.frag", reads=reads, into=(IMAGE,), **more)
