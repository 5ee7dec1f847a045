"""The few fragments of shallow pixels, sorted in the framebuffer while they are drawn: no counter, no cells, no sort.

Framebuffer fetch lets a shader read the pixel that its fragment is drawn into, as the fragment before has left it.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from ..spec import EMPTY, IMAGE, PAYLOAD_WORDS, Known, Param, Params, Pass, Plan, Target, when
from .clearing import CLEARED
from .counting import STORED
from .opaque_first import whole_and_in_front
from .options import PAYLOAD

KEPT = "kept"  # the plan of such frames
LAYERS = (2, 4, 6, 7, 8)  # of targets for a fragment each; a framebuffer has room for eight, or for seven and the image
MOST = LAYERS[-1]
NAMES = tuple(f"kept_{i}" for i in range(MOST))
WIDE = 1 / 8  # of the viewport: for less geometry, to clear targets of its size costs as much as they save

SHALLOW = Param("shallow", "framebuffer", f"pixels of up to {MOST} fragments: sorted in the framebuffer as they are "
                "drawn, where the device lets a shader read the pixel that it draws into, or stored as others (memory)",
                choices=("framebuffer", "memory"))
IS_KEPT = when(SHALLOW.name, "framebuffer") & when(PAYLOAD.name, "rgba8", "two_channel")
TARGETS = tuple(Target(name, "rg32ui", when=IS_KEPT, on_demand=True,
                       doc=f"depth and payload of a pixel's fragment {i}, counted from the nearest")
                for i, name in enumerate(NAMES))


def payload_words(params: Params) -> int:
    """Words of the payload of a fragment."""
    return PAYLOAD_WORDS[str(params.get(PAYLOAD.name, PAYLOAD.default))]


def kept(known: Known, params: Params, most_cells: float) -> Plan | None:
    """The plan for as many layers as the geometry can have or the frame before had; None where it cannot be.

    The targets are as large as the viewport, and have at most `most_cells` places together.
    """
    certain = known.layers <= MOST or known.deepest is None
    needed = known.layers if certain else known.deepest
    layers = next((layers for layers in LAYERS if needed <= layers), None)
    in_framebuffer = params.get(SHALLOW.name, SHALLOW.default) == "framebuffer" and payload_words(params) == 1
    if not (layers and in_framebuffer and known.fetches) or known.room is not None:
        return None
    if known.area < WIDE * known.pixels or layers * known.pixels > most_cells:
        return None
    return Plan(KEPT, replace(known, layers=layers), 0, guessed=layers < known.layers)


def beside_image(plan: Plan) -> bool:
    """Whether the image finds room in the framebuffer beside the targets of the plan."""
    return plan.known.layers < MOST


def passes() -> Iterator[Pass]:
    """For each number of layers the pass that keeps fragments, those that make the image, and one that counts them."""
    for layers in LAYERS:
        yield from _passes(layers)


def _passes(layers: int) -> Iterator[Pass]:
    targets = NAMES[:layers]
    read, image = (targets, (IMAGE,)) if layers < MOST else (targets[:-1], ())
    defines = {"LAYERS": layers}

    def runs_in(plan: Plan) -> bool:
        return plan.path == KEPT and plan.known.layers == layers

    yield from whole_and_in_front(
        Pass("store", "geometry", "methods/adaptive/keep.frag", into=(*targets, *image), fetched=targets, keeps=image,
             clears=dict.fromkeys(targets, (EMPTY, 0)) | dict.fromkeys(image, CLEARED), defines=defines,
             runs_in=runs_in, when=IS_KEPT))
    resolve = Pass("resolve", "fullscreen", "methods/adaptive/kept.frag", region=True, reads=targets[len(read):],
                   into=(*read, IMAGE), fetched=read, keeps=read, defines={**defines, "ASKS": 0}, when=IS_KEPT,
                   runs_in=lambda plan: runs_in(plan) and not plan.guessed)
    yield resolve
    yield replace(resolve, writes=("deepest",), defines={**defines, "ASKS": 1},
                  runs_in=lambda plan: runs_in(plan) and plan.guessed)
    yield replace(resolve, shader="methods/adaptive/kept_count.frag", keeps=(*read, IMAGE), defines=defines,
                  runs_in=lambda plan: runs_in(plan) and not plan.in_front, probes=STORED)
