"""Passes that turn the stored fragments of a pixel into its colour: sorted, in classes, by draw or by dispatch."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import partial
from typing import Any

from ..spec import IMAGE, Params, Pass, State, Target
from .counting import count_stored
from .options import SORT

RESOLVERS = {"lplus": "common/resolve_lplus.glsl", "register": "common/resolve_register.glsl",
             "bubble_block": "common/resolve_bubble.glsl"}
RESOLVER = "common/resolve_local.glsl"  # every other sort works in one local array
BLOCKS = ("register", "bubble_block")  # sorts of whole blocks in registers
# The ways of a sort by the length of the local array. `auto`: the fastest exact one, measured on llvmpipe
# (docs/fairness.md). `bubble`: the same steps in registers, for as many fragments as compilers unroll its loops for.
REGISTERS_UP_TO, BUBBLES_UP_TO = 512, 16  # fragments
WAYS = {"auto": (("register", f"{{}} <= {REGISTERS_UP_TO}"), ("hybrid", f"{{}} > {REGISTERS_UP_TO}")),
        "bubble": (("bubble_block", f"{{}} <= {BUBBLES_UP_TO}"), ("bubble", f"{{}} > {BUBBLES_UP_TO}"))}
LPLUS = 32  # l of the l+-depth-sorting (kplus_2015 §4.4)
NARROWEST, WIDEST = 8, 32  # fragments of the smallest and the largest sorting network
TILE = 8  # pixels, side of the square that a work group of the compute resolve shades

# Classes of backwards memory allocation: class i has at most 8 * 2**i fragments; the last has no bound.
CLASS_BOUNDS = tuple(8 << i for i in range(8))
PIXEL_CLASS = Target("pixel_class", "depth32f", doc="class of the pixel by its number of fragments, as depth")


def resolve(*reads: str, select: bool = False, hazards: bool = False, defines: Mapping[str, Any] | None = None,
            **more) -> Pass:
    """The pass that sorts and composites the fragments that its `fetch` reads; with `select` only the k nearest.

    Its parameters are RESOLVE_OPTIONS. `hazards`: as for `count_stored`.
    """
    return Pass("resolve", "fullscreen", "common/resolve.frag", reads=reads, into=(IMAGE,),
                defines={"SELECT": int(select), "LISTS": 1, **(defines or {})},
                expand=partial(_resolve_passes, hazards=hazards), **more)


def resolve_sorted(*reads: str, resolver: str = "common/resolve_sorted.glsl", hazards: bool = False,
                   mixes: bool = False, defines: Mapping[str, Any] | None = None, **more) -> Pass:
    """The pass that composites fragments which its `fetch` already reads nearest first.

    Its parameters are STAGE and STOP_OPACITY. `hazards`: as for `count_stored`. With `mixes` a slot may stand for
    several fragments, so that stored fragments cannot be counted.
    """
    return Pass("resolve", "fullscreen", "common/resolve.frag", reads=reads, into=(IMAGE,), resolver=resolver,
                defines={"LISTS": 1, **(defines or {})},
                expand=partial(_sorted_passes, hazards=hazards, mixes=mixes), **more)


def _sorted_passes(step: Pass, scope: Params, hazards: bool, mixes: bool) -> tuple[Pass, ...]:
    return (*(() if mixes else (count_stored(step, hazards),)), *_staged(step, scope))


def peeling(step: Pass, scope: Params) -> tuple[Pass, ...]:
    """The geometry pass of a peeling, which skips pixels whose image has reached the opacity STOP_OPACITY."""
    stops = float(scope["stop_opacity"]) < 1
    return (replace(step, reads=step.reads + ((IMAGE,) if stops else ()), expand=None,
                    defines={**step.defines, "STOPS": int(stops)}),)


def _resolve_passes(step: Pass, scope: Params, hazards: bool) -> tuple[Pass, ...]:
    sort = str(scope.get("sort", SORT.default))
    length = str(scope.get("local_array") or ("keep" if sort != "lplus" else f"min({LPLUS}, keep)"))
    counting = count_stored(step, hazards, "keep" if sort == "lplus" else f"min(keep, {length})")
    if scope.get("bma") != "on":
        return (counting, *_sorted(step, scope, sort, length))
    bounds = [f"min({bound}, {length})" for bound in CLASS_BOUNDS[:-1]] + [length]
    return (counting, _classify(step, length),
            *(p for i, bound in enumerate(bounds) for p in _sorted(_of_class(step, i, length), scope, sort, bound)))


def _sorted(step: Pass, scope: Params, sort: str, length: str) -> tuple[Pass, ...]:
    """The resolve by a sort of so many fragments, in the way of WAYS that is for them.

    A bubble sort whose local array has a length that the user gives stays in it.
    """
    if sort not in WAYS or (sort == "bubble" and scope.get("local_array")):
        return _by(step, scope, sort, length)
    return tuple(p for way, where in WAYS[sort]
                 for p in _by(_where(step, where.format(length)), scope, way, length))


def _by(step: Pass, scope: Params, sort: str, length: str) -> tuple[Pass, ...]:
    """The resolve in one way, whose local array has this length, or that of whole blocks."""
    if sort in BLOCKS:
        length = f"ceil({length}/{_network(length)})*{_network(length)}"
    defines = {**step.defines, "LOCAL": length, "NETWORK": _network(length), f"SORT_{sort.upper()}": 1}
    return _staged(replace(step, resolver=RESOLVERS.get(sort, RESOLVER), defines=defines), scope)


def _where(step: Pass, condition: str) -> Pass:
    """The pass, left out where the condition does not hold either."""
    return replace(step, needed=f"({step.needed}) and ({condition})" if step.needed else condition)


def _network(length: str) -> str:
    """The formula of the fragments that a sorting network for a local array of this length sorts: 8, 16 or 32."""
    return f"min({WIDEST}, doubled({NARROWEST}, {length}))"


def _classify(step: Pass, length: str) -> Pass:
    """The pass that writes every pixel's class as its depth, and clears the image for pixels without fragments."""
    last = f"min({len(CLASS_BOUNDS) - 1}, ceil(log2(max({CLASS_BOUNDS[0]}, {length}))) - 3)"
    return replace(step, shader="common/classify.frag", resolver=None, into=(IMAGE, PIXEL_CLASS.name),
                   targets=(PIXEL_CLASS,), defines={**step.defines, "LAST_CLASS": last},
                   state=State(depth_test="always"), expand=None)


def _of_class(step: Pass, index: int, length: str) -> Pass:
    """The resolve of one class, whose pixels the depth test selects."""
    return replace(step, into=(IMAGE, PIXEL_CLASS.name), defines={**step.defines, "CLASS": index},
                   vertex="screen/triangle_of_class.vert",
                   needed=f"{CLASS_BOUNDS[index - 1]} < {length}" if index else None,
                   state=State(depth_test="equal", depth_write=False, early=True))


def _staged(step: Pass, scope: Params) -> tuple[Pass, ...]:
    """The resolve as a full-screen draw or as a compute dispatch, as the parameter `resolve` says."""
    if scope.get("resolve") != "compute":
        return (replace(step, expand=None),)
    classed = PIXEL_CLASS.name in step.into
    return (replace(step, kind="compute", shader="common/resolve.comp", into=(IMAGE,), state=State(), vertex=None,
                    reads=step.reads + ((PIXEL_CLASS.name,) if classed else ()),
                    defines={**step.defines, "TILE": TILE, "CLASSED": int(classed)}, expand=None,
                    groups=f"min(65535, ceil(W/{TILE})*ceil(H/{TILE}))"),)
