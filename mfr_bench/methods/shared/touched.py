"""`touched`: what the full-screen passes of a method touch.

The host knows the rectangle that bounds the geometry at no cost; which tiles in it have fragments a compute pass finds
after the store. Beside the rectangle no pixel's storage is cleared, nor a target by the pass that draws into it, so
none is read; the image is cleared there. Clears by the driver alone stay whole, as of buffers of no pixel's own.

A listed tile is drawn as a point: along the edge that the two triangles of a square share, pixels are shaded twice. On
llvmpipe the resolve of squares of 16, 32 and 64 pixels takes 1.6, 1.3 and 1.2 to 1.3 times that of one triangle over a
full viewport, of points of any of these stats 1.1, in which the list and the image's clear are counted.

A method takes it where each pixel of a full-screen pass works for itself: passes that go over the storage of all
pixels, such as a prefix sum, and what they read, stay outside `touching`.
"""

from __future__ import annotations

from dataclasses import replace
from functools import partial

from ..spec import IMAGE, LISTED, TILE_COMMAND, TILE_LIST, TILE_POINTS, Buffer, Loop, Param, Params, Pass, State
from . import CLEARED, PIXEL_CLASS, Expand, expanded

BOUNDS = ("what full-screen passes touch: the viewport (off), or the rectangle that bounds the geometry, which the "
          "host knows (bounds); ")
TOUCHED = Param("touched", "off", f"{BOUNDS}or of the resolve, within that, only tiles of {LISTED}x{LISTED} pixels "
                "that have fragments, listed on the device after the store (tiles); the image is cleared beside",
                choices=("off", "bounds", "tiles"), needs={"tiles": TILE_POINTS})
TILES = f"ceil(W/{LISTED})*ceil(H/{LISTED})"
LISTERS = 64  # tiles that a work group of the listing looks at

Step = Pass | Loop


def without_tiles(reason: str) -> Param:
    """TOUCHED for a method whose resolve does not go by tile."""
    return replace(TOUCHED, doc=f"{BOUNDS}the image is cleared beside; no tiles, {reason}", choices=("off", "bounds"),
                   needs={})


def touching(*steps: Step, looped: bool = False) -> tuple[Step, ...]:
    """The steps with TOUCHED as their parameter: in each full-screen pass every pixel works for itself alone.

    Those into the image clear it, but for those in a loop, before which it is cleared whole.
    """
    return tuple(_touching(s, looped) for s in steps)


def _touching(step: Step, looped: bool) -> Step:
    if isinstance(step, Loop):
        return replace(step, passes=touching(*step.passes, looped=True))
    if step.kind == "clear" or (step.kind == "geometry" and not step.clears):
        return step
    if IMAGE in step.into:
        step = replace(step, expand=partial(_into_image, expand=step.expand, clears=not looped))
    return replace(step, expand=partial(_within, expand=step.expand))


def _within(step: Pass, scope: Params, expand: Expand | None) -> tuple[Pass, ...]:
    bounded = scope[TOUCHED.name] != "off"
    return tuple(replace(p, region=p.region or (bounded and p.kind != "clear"))
                 for p in expanded(step, scope, expand))


def _into_image(step: Pass, scope: Params, expand: Expand | None, clears: bool) -> tuple[Pass, ...]:
    made, touched = expanded(step, scope, expand), scope[TOUCHED.name]
    image = {"clears": {IMAGE: CLEARED}, "into": (IMAGE,)} if clears else {}
    if touched == "tiles":
        return (Pass(step.name, "clear", writes=(TILE_COMMAND,), **image), _list_tiles(step), *map(_by_tile, made))
    beside = (Pass(step.name, "clear", region=True, **image),) if clears and touched == "bounds" else ()
    return (*beside, *made)


def _list_tiles(step: Pass) -> Pass:
    """The pass that lists the tiles in which the resolve `step` finds a fragment, for an indirect draw and dispatch."""
    return replace(step, kind="compute", shader="common/list_tiles.comp", resolver=None, into=(), state=State(),
                   buffers=(Buffer(TILE_LIST, TILES), Buffer(TILE_COMMAND, "8")), writes=(TILE_LIST, TILE_COMMAND),
                   groups=f"ceil({TILES}/{LISTERS})", expand=None,
                   defines={**step.defines, "TILE": LISTED, "LISTERS": LISTERS})


def _by_tile(step: Pass) -> Pass:
    """A pass of a resolve that draws, or dispatches a work group for, each listed tile."""
    if step.kind == "geometry":
        return step
    step = replace(step, by_tile=True, defines={**step.defines, "TILE": LISTED})
    if step.kind == "compute":
        return replace(step, reads=(*step.reads, TILE_LIST, TILE_COMMAND))
    classifies = PIXEL_CLASS in step.targets
    return replace(step, vertex="screen/tile.vert", clears={PIXEL_CLASS.name: (1.0,)} if classifies else step.clears)
