"""The variants of a method whose fragments meet in memory in different ways, found by comparing their GLSL."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator, Mapping, Sequence
from itertools import combinations, product

from ..errors import MfrError
from ..methods.spec import Above, Fitted, Method, Param, Value, Variant, When
from ..oracle.composite import stats_of
from ..scene.quads import Quads
from .adapter import frame_of
from .campaign import SMALL_K

# Values of parameters that are numbers: the smallest, a few, and what a small scene makes tight.
NUMBERS: Mapping[str, tuple[Value, ...]] = {
    "k": (1, 3), "occupancy": (32,), "buckets": (2,), "counters": (1, 2), "layers": (1, 2), "samples": (4, 8),
    "passes": (1, 2), "per_pass": (2, 4), "load_factor": (0.3, 0.9), "max_error": (0.1,), "retries": (1,),
    "culling_opacity": (0.5,), "moments": (6,), "hit_ratio": (0.5,), "stop_opacity": (0.9,), "room": (2,),
    "depth_bits": (16,), "spare_memory": (0.0,),
}
# Parameters that change shaders or passes, and nothing in which invocations meet.
SAME_ACCESSES: Mapping[str, str] = {
    "bound": "the bound of a loop is a uniform or a constant",
    "memory_mb": "the same passes run on one part of the screen after the other, which a scene of a few pixels has not",
}
TOGETHER = 2  # parameters that differ from their defaults at once


def base(method: Method) -> dict[str, Value]:
    """The parameters from which configurations differ."""
    return {"k": SMALL_K} if method.param("k") else {}


def acting(method: Method, *params: Param) -> dict[str, Value]:
    """The parameters from which configurations differ, with what lets these parameters act."""
    chosen = base(method)
    for param in params:
        where = param.acts
        while isinstance(where, When):
            chosen.setdefault(where.name, where.values[0])
            where = where.also
    return chosen


def others(param: Param) -> tuple[Value, ...]:
    """Values of a parameter other than its default, by which invocations may meet in other ways."""
    if param.name in SAME_ACCESSES:
        return ()
    if param.choices:
        return tuple(choice for choice in param.choices if choice != param.default)
    return tuple(value for value in NUMBERS.get(param.name, ())
                 if value != param.default and (not param.of or value in param.of))


def configurations(method: Method, scene: Quads, together: int = TOGETHER) -> Iterator[Variant]:
    """The method at its defaults, and with up to `together` parameters at other values.

    Only those of which a pass that runs concurrently, or the plan of the frame, is another than of all before.
    """
    seen: set[str] = set()
    for variant in _variants(method, scene, together):
        key = concurrent_key(variant, scene)
        if key and key not in seen:
            seen.add(key)
            yield variant


def _variants(method: Method, scene: Quads, together: int) -> Iterator[Variant]:
    start = method.variant(base(method))
    yield start
    alone = concurrent_key(start, scene)
    varied = [p for p in method.params if others(p)]
    telling = [p for p in varied if any(concurrent_key(v, scene) != alone for v in _with(method, (p,)))]
    for size in range(1, together + 1):
        for params in combinations(telling, size):
            yield from _with(method, params)


def _with(method: Method, params: Sequence[Param]) -> Iterator[Variant]:
    for values in product(*map(others, params)):
        chosen = acting(method, *params) | dict(zip((p.name for p in params), values, strict=True))
        for above in (p.acts for p in params if isinstance(p.acts, Above)):
            chosen[above.name] = max(chosen[above.name], chosen[above.other] + 1)
        yield method.variant(chosen)


def concurrent_key(variant: Variant, scene: Quads) -> str | None:
    """The hash of all that runs concurrently; None where the machine cannot draw the frame."""
    try:
        frame = frame_of(Fitted(variant, stats_of(scene)), scene.bounds)
    except MfrError:
        return None
    texts = [p.own.text for p in frame.passes if p.sources and p.concurrent]
    order = [frame.passes[s.step].step.name for s in frame.steps if frame.passes[s.step].concurrent]
    return hashlib.sha256("\0".join([*texts, *order]).encode()).hexdigest()
