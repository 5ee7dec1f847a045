"""OCCUPANCY: a map of occupied depth intervals, by which fragments beyond the k-th are discarded (occupancy_2015)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial

from ..spec import MAX, Buffer, Params, Pass, State, Target, when
from .counting import SHADED
from .options import OCCUPANCY, OCCUPANCY_BOUNDS

KTH_DEPTH = Target("kth_depth", "depth32f", doc="depth that none of the k nearest fragments is beyond")
BOUNDS = Target("bounds", "rg32f", doc="(-nearest, furthest) depth of the pixel")
NO_BOUNDS = (-1.0, -1.0, 0.0, 0.0)  # of (-z, z), by MAX blending


OCCUPIED, UNOCCUPIED = when("occupancy", *(d for d in OCCUPANCY.of if d)), when("occupancy", 0)


def occupied(*stores: Pass) -> tuple[Pass, ...]:
    """The store passes of a k-buffer with OCCUPANCY: the passes of the map, then the stores, culled. They need K."""
    return (*occupancy_map(), *map(culled, stores))


def occupancy_map() -> tuple[Pass, ...]:
    """The passes that find, for each pixel, a depth beyond which none of its K nearest fragments lies (occupancy_2015).

    They add 3 words per pixel for the depth bounds and the k-th depth, and one bit per interval.
    """
    on = OCCUPIED
    mask = Buffer("occupied", "occupancy / 32 * P", clear="0u",
                  doc="a bit for each interval of the pixel's depth range that contains fragments")
    return (
        Pass("occupancy", "fullscreen", "common/clear.frag", writes=("occupied",), buffers=(mask,), when=on),
        Pass("occupancy", "geometry", "common/depth_bounds.frag", into=("bounds",), clears={"bounds": NO_BOUNDS},
             state=State(blend=MAX), targets=(BOUNDS, KTH_DEPTH), when=on, expand=_bounded),
        Pass("occupancy", "geometry", "common/occupancy/mark.frag", reads=("bounds",), writes=("occupied",), when=on),
        Pass("occupancy", "fullscreen", "common/occupancy/cull.frag", reads=("bounds", "occupied"),
             into=(KTH_DEPTH.name,), state=State(depth_test="always"), when=on),
        _before_kth(Pass("occupancy", "geometry", "common/occupancy/shaded.frag", probes=SHADED, when=on)),
    )


def _bounded(step: Pass, scope: Params) -> tuple[Pass, ...]:
    """The pass that finds the depth bounds of pixels, from the geometry or from a box around it (OCCUPANCY_BOUNDS)."""
    if scope.get(OCCUPANCY_BOUNDS.name) != "box":
        return (replace(step, expand=None),)
    return (replace(step, kind="fullscreen", shader="common/occupancy/box.frag", state=State(), region=True,
                    expand=None),)


def culled(store: Pass) -> Pass:
    """A geometry pass that with OCCUPANCY processes no fragment beyond the k-th depth.

    Early z discards them, or the shader if the pass has a depth or stencil test of its own. The stencil test precedes
    the depth test, so that a fragment discarded by early z would still change the stencil.
    """
    own = store.state.depth_test or store.state.stencil
    return replace(store, expand=partial(_culled, restrict=_from_shader if own else _before_kth))


def _culled(step: Pass, scope: Params, restrict: Callable[[Pass], Pass]) -> tuple[Pass, ...]:
    """The pass, restricted where OCCUPANCY is on."""
    plain = replace(step, expand=None)
    return (restrict(plain) if scope.get("occupancy") else plain,)


def _from_shader(step: Pass) -> Pass:
    """The pass whose shader rejects fragments beyond the k-th depth."""
    return replace(step, reads=(*step.reads, KTH_DEPTH.name), defines={**step.defines, "CULLS": 1})


def _before_kth(step: Pass) -> Pass:
    """The pass for which early z discards fragments beyond the k-th depth, before the shader runs.

    An occlusion query would then count fragments that the shader rejects, so the pass has none; `Pass.totals` gives the
    capacity instead.
    """
    return replace(step, into=(*step.into, KTH_DEPTH.name), counts=False,
                   state=replace(step.state, depth_test="lequal", depth_write=False, early=True))
