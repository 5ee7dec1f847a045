"""The parameter `touched`: full-screen passes are limited to the part of the screen that has geometry.

`bounds` limits them to the rectangle that bounds the geometry, which the host knows at no cost. `tiles` limits the
resolve further, to the tiles of this rectangle that have fragments; a compute pass lists them after the store. Outside
the rectangle no pixel's storage is cleared, and no target by the pass that draws into it, because none is read there;
only the image is cleared. A clear by the driver still covers the whole buffer, and so does the clear of a buffer that
belongs to no pixel.

A listed tile is drawn as a point, because a square of two triangles would shade the pixels along their common edge
twice. On llvmpipe, relative to one triangle over a full viewport, the resolve takes 1.6, 1.3 and 1.2 to 1.3 times as
long with squares of 16, 32 and 64 pixels, and 1.1 times with points of any of these sizes, the listing and the clear
of the image included.

A method can have this parameter if each pixel of its full-screen passes works for itself. Passes over the storage of
all pixels, such as a prefix sum, and the passes whose results they read, stay outside `in_screen_region`.
"""

from __future__ import annotations

from dataclasses import replace
from functools import partial

from ..spec import IMAGE, LISTED, TILE_COMMAND, TILE_LIST, TILE_POINTS, Buffer, Loop, Param, Params, Pass, State
from .clearing import CLEARED, Expand, expanded
from .resolving import PIXEL_CLASS

BOUNDS = ("what full-screen passes touch: the viewport (off), or the rectangle that bounds the geometry, which the "
          "host knows (bounds); ")
TOUCHED = Param("touched", "off", f"{BOUNDS}or of the resolve, within that, only tiles of {LISTED}x{LISTED} pixels "
                "that have fragments, listed on the device after the store (tiles); the image is cleared beside",
                choices=("off", "bounds", "tiles"), needs={"tiles": TILE_POINTS})
TILES = f"ceil(W/{LISTED})*ceil(H/{LISTED})"
WHOLE_SUM = "the sum goes over all pixels"  # why a prefix sum is not limited
LISTERS = 64  # tiles that a work group of the listing looks at

Step = Pass | Loop


def without_tiles(reason: str) -> Param:
    """TOUCHED for a method whose resolve cannot be limited to tiles, for the given reason."""
    return replace(TOUCHED, doc=f"{BOUNDS}the image is cleared beside; no tiles, {reason}", choices=("off", "bounds"),
                   needs={})


# For methods that blend sums and resolve them.
TOUCHED_BLENDED = without_tiles("since a look for fragments costs as much as the resolve")


def in_screen_region(*steps: Step, looped: bool = False) -> tuple[Step, ...]:
    """The steps with TOUCHED as their parameter. In each of their full-screen passes every pixel works for itself.

    A pass that draws into the image clears it outside the region. Passes in a loop do not: the image is cleared as a
    whole before the loop.
    """
    return tuple(_in_screen_region(s, looped) for s in steps)


def _in_screen_region(step: Step, looped: bool) -> Step:
    if isinstance(step, Loop):
        return replace(step, passes=in_screen_region(*step.passes, looped=True))
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
                   buffers=(Buffer(TILE_LIST, TILES, doc="numbers of the tiles that have fragments"),
                            Buffer(TILE_COMMAND, "8", doc="indirect draw and dispatch of a point or group per tile")),
                   writes=(TILE_LIST, TILE_COMMAND),
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
