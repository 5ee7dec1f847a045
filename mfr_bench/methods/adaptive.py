"""The method of this project: only the work that a scene needs, without a k, an n or a size from its user.

Before a frame the host knows its geometry: how many primitives can meet in a pixel, the rectangle that they lie in, and
how many fragments the frame before had, in all and in its deepest pixel. From these it plans the frame:

- `direct`: no pixel can have two fragments. They are blended, and nothing is stored.
- `nearest`: all primitives are opaque. A depth test leaves the nearest fragment of each pixel, and nothing is stored.
- `ordered`: each primitive has one fragment in every pixel of the rectangle, and one depth: the order of one pixel is
  that of all. It is found once, and the primitives are blended in it, the furthest first.
- `planes`: the same geometry, stored after all, as the parameter `flat` may say: the number of a primitive tells the
  cell, so that nothing is counted at all.
- `kept`: no pixel can have more than eight fragments by the geometry, or none had in the frame before, and the device
  lets a shader read the pixel that it draws into. Targets of the framebuffer hold the fragments of a pixel, in which
  each one takes its place by depth as it is drawn. That none had more is a guess, which the frame checks.
- `dense`: cells for every layer of every pixel of the rectangle take at most SPARE more memory than exact ranges would.
  Nothing is counted beforehand; the cells of neighbours lie side by side. The same with as many layers as the frame
  before had, where these take at most `spare_memory` more: a guess, which the frame checks. Where a pixel is deeper,
  the frame is drawn again with more layers.
- `ranges`: a count by blending, then each pixel takes a range of exactly its fragments; empty pixels take none.

`kept`, `dense` and `ranges` leave out what is behind opaque primitives, where these hide enough.
A `max_error` above its default cuts deep frames: in `dense` cells instead of planes, else in `ranges`, they store what
lies before the depth behind which no more than that shows through. With a budget of memory that may not hold all
fragments, `ranges` go band by band: what follows the count is drawn once for each rectangle whose fragments fit.

No plan can lose a fragment: what the frame before had only decides how much memory `dense` may take, and a guess that
was too low costs a frame. The fragments of a pixel are sorted in registers, by a network as small as their number
allows. Beyond 64 the nearest 32 are kept, sweep by sweep, until all are composited or no more than `max_error` shows
through; blocks of faint stacks are merged.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

from .shared import CLEARED, PAYLOAD, PIXEL_CLASS, STORED, in_framebuffer
from .shared.bands import SEGMENT
from .shared.in_framebuffer import KEPT, SHALLOW, beside_image, kept, payload_words
from .shared.in_order import DRAWS_IN_ORDER, FLAT, IN_ORDER, MOST_ORDERED, ORDERED, is_ordered
from .shared.opaque_first import (
    DRAW_NEAREST,
    NEAREST,
    NEAREST_DEPTH,
    OPAQUE,
    in_front,
    is_in_front,
    is_tested,
    whole_and_in_front,
)
from .spec import (
    ADD,
    COMMAND_WORDS,
    IMAGE,
    OVER,
    Buffer,
    Known,
    Loop,
    Method,
    Param,
    Params,
    Pass,
    Plan,
    Planned,
    State,
    Target,
    When,
)

ORDER = 9

EXACT = 2.0**-20  # of the transmittance: no more than rounding errs by in a stack of a hundred fragments

MAX_ERROR = Param("max_error", EXACT, "largest error of a channel by which fragments far behind others may be left "
                  "out; by default so small that the image counts as exact", real=True, low=0, high=1,
                  weakens={"0.000000954-1": "fragments behind others may be left out, an error of up to max_error"})
MEMORY_MB = Param("memory_mb", 0.0, "most memory in MiB; where it does not hold all fragments at once, the frame is "
                  "stored and resolved in several bands; 0: any number", real=True, low=0, high=2**20, off=0.0)

MOST_GUESSED_BYTES = 2**27  # what a storage block holds on every driver at hand

SPARE_MEMORY = Param("spare_memory", 16.0, "most memory that cells for as many layers as the frame before had may take "
                     "in addition to exact ranges, as a multiple of these; 0: always exact ranges", real=True, low=0,
                     high=1024, off=0.0)

FURTHEST_CUT = Param("furthest_cut", 0.5, "depth; a cut further behind would save less than finding it costs",
                     real=True, low=0, high=1)

DIRECT, PLANES, DENSE, RANGES = "direct", "planes", "dense", "ranges"
BLENDED = DIRECT, NEAREST, ORDERED  # plans that make the image of the geometry as it is drawn, and store no fragment

SPARE = 1 / 20  # of the memory of exact ranges and two words per pixel, that `dense` may take in addition

NETWORKS = (2, 4, 8, 16, 32, 64)  # fragments of each sorting network; deeper pixels are swept
HALVES = 64  # places of two networks: both halves of a pixel, or 32 fragments kept and 32 that are new
DEEPEST = 65535  # fragments that 16 bits can count
WORTH_CUTTING = 40  # layers from which two cheap passes for the opacity cost less than storing what it hides
CHUNK = 8  # fragments of a pixel side by side, a line of a cache; of rgba8
UNCHUNKED = 8  # layers up to which cells of neighbouring pixels are adjacent instead
UNCLASSED = 16  # layers up to which telling pixels apart costs more than it saves
BOUNDS = (0, *NETWORKS, 2**32)
COUNT_DEFINES = {"DEEPEST": DEEPEST}
CLASSES = {"COMMAND_WORDS": COMMAND_WORDS, "UNCLASSED": UNCLASSED, "HALVES": HALVES}


def plan(known: Known, params: Params) -> Plan:
    """The cheapest way that is right and stays within the memory of exact ranges and SPARE."""
    if drawn := _drawn(known, params):
        return drawn
    cells = known.layers * known.area
    banded = known.room is not None and cells > known.room
    cut = float(params.get(MAX_ERROR.name, EXACT)) > EXACT and known.layers >= WORTH_CUTTING
    if known.filled and not banded:
        return Plan(DENSE if cut else PLANES, known, cells, cut_off=cut)
    if banded or cut:
        return Plan(RANGES, known, banded=banded, cut_off=cut)
    return in_front(_stored(known, params, cells), params)


def _stored(known: Known, params: Params, cells: int) -> Plan:
    """The plan of a frame whose fragments are stored all at once, where every layer would take so many cells."""
    if in_targets := kept(known, params, _most_cells(known, params)):
        return in_targets
    room = 0 if known.fragments is None else known.fragments + SPARE * (known.fragments + known.pixels)
    if cells <= room:
        return Plan(DENSE, known, cells)
    if guess := _guess(known, params):
        return guess
    return Plan(RANGES, known, known.reach if known.reach is not None and known.reach <= room else None,
                finds_deepest=True)


def _drawn(known: Known, params: Params) -> Plan | None:
    """The plan of a frame that stores no fragments; None where it has to."""
    if known.layers <= 1:
        return Plan(DIRECT, known, 0)
    if known.opaque == 1 and is_tested(known, params):
        return Plan(NEAREST, known, 0)
    if is_ordered(known, params):
        return Plan(ORDERED, known, known.layers)
    return None


def _most_cells(known: Known, params: Params) -> float:
    """The cells of exact ranges, as far as they are known, and those that `spare_memory` allows more."""
    fragments = max(known.fragments or 0, known.expected if is_in_front(known, params) else 0)
    return fragments + float(params.get(SPARE_MEMORY.name, SPARE_MEMORY.default)) * (fragments + known.pixels)


def _guess(known: Known, params: Params) -> Plan | None:
    """Dense cells for as many layers as the frame before had; None where they would take too much memory."""
    if known.deepest is None or known.fragments is None:
        return None
    layers = min(known.layers, known.deepest)
    layers = layers if layers <= UNCHUNKED else -(-layers // CHUNK) * CHUNK
    cells = layers * known.area
    if cells > min(_most_cells(known, params), MOST_GUESSED_BYTES / (4 * (1 + payload_words(params)))):
        return None
    return Plan(DENSE, replace(known, layers=layers), cells, guessed=True)


@dataclass(frozen=True)
class AboveValue(When):
    """Holds where the parameter `name` is above the one value."""

    def holds(self, params: Params) -> bool:
        return float(params[self.name]) > float(self.values[0]) and (self.also is None or self.also.holds(params))


APPROXIMATE = AboveValue(MAX_ERROR.name, (EXACT,))
BUDGETED = AboveValue(MEMORY_MB.name, (0.0,))


@dataclass(frozen=True)
class Layout:
    """A layout of the cells in memory: the frames that use it, and the defines that select it in the shaders."""

    runs_in: Callable[[Plan], bool]
    defines: Mapping[str, int]

    @property
    def storage(self) -> tuple[str, ...]:
        return ("nodes",) if self.defines["PLANES"] else ("counter", "nodes")

    @property
    def may_be_guessed(self) -> bool:
        return bool(self.defines["DENSE"] and not self.defines["PLANES"])

    @property
    def reads(self) -> tuple[str, ...]:
        return self.storage if self.defines["DENSE"] else (*self.storage, "fragment_counts")


def _in(path: str) -> Callable[[Plan], bool]:
    return lambda plan: plan.path == path


def _where(*conditions: Callable[[Plan], bool]) -> Callable[[Plan], bool]:
    return lambda plan: all(holds(plan) for holds in conditions)


def _cut(plan: Plan) -> bool:
    return plan.cut_off


def _classed(plan: Plan) -> bool:
    """Whether pixels are classified by their number of fragments."""
    return plan.cut_off or ((plan.path == RANGES or plan.guessed) and plan.known.layers > UNCLASSED)


def _chunked(plan: Plan) -> bool:
    return plan.guessed and plan.known.layers > UNCHUNKED


IN_PLANES = Layout(_in(PLANES), {"DENSE": 1, "PLANES": 1, "CHUNK": 1})
IN_CELLS = Layout(_where(_in(DENSE), lambda plan: not _chunked(plan)), {"DENSE": 1, "PLANES": 0, "CHUNK": 1})
IN_CHUNKS = Layout(_chunked, {"DENSE": 1, "PLANES": 0, "CHUNK": CHUNK})
IN_RANGES = Layout(_in(RANGES), {"DENSE": 0, "PLANES": 0, "CHUNK": 1, **COUNT_DEFINES})
LAYOUTS = (IN_PLANES, IN_CELLS, IN_CHUNKS, IN_RANGES)


def _cleared(plan: Plan) -> bool:
    """Whether the resolve leaves pixels out anywhere."""
    if plan.path == KEPT:
        return not beside_image(plan) and plan.known.area < plan.known.pixels
    return plan.path not in BLENDED and (plan.known.area < plan.known.pixels or plan.banded or _classed(plan))


def _banded(plan: Plan) -> bool:
    return plan.banded


def _ranged(plan: Plan) -> bool:
    return plan.path == RANGES and not _classed(plan)


def _classed_by_counter(plan: Plan) -> bool:
    """Whether they are classified after the store, because nothing was counted before."""
    return plan.path == DENSE and _classed(plan)


def _guessed(plan: Plan) -> bool:
    return plan.guessed


def _certain(plan: Plan) -> bool:
    return not plan.guessed


def _resolves() -> tuple[Pass, ...]:
    """One resolve for each number of fragments: of all pixels, or of a class of them."""
    return tuple(made for index in range(len(BOUNDS) - 1) for made in (
        *(_resolve(index, layout) for layout in LAYOUTS),
        *(_resolve_class(index, layout) for layout in (IN_CELLS, IN_CHUNKS, IN_RANGES))))


def _resolve(index: int, layout: Layout) -> Pass:
    low, high = BOUNDS[index], BOUNDS[index + 1]
    return Pass("resolve", "fullscreen", "methods/adaptive/resolve.frag", region=True, into=(IMAGE,),
                runs_in=lambda plan: layout.runs_in(plan) and low < plan.known.layers <= high and not _classed(plan),
                reads=layout.reads,
                writes=(*(("deepest",) if layout.may_be_guessed else ()), *(("nodes",) if high > HALVES else ())),
                texels=() if high <= UNCHUNKED else ("nodes",),
                pairs=("nodes",) if layout is IN_CHUNKS and high > UNCHUNKED else (),
                resolver=f"methods/adaptive/{_resolver(high)}.glsl",
                defines={**layout.defines, "NETWORK": min(high, HALVES), "ASKS": int(layout.may_be_guessed)})


def _resolver(most: int) -> str:
    """The file that resolves pixels with up to `most` fragments."""
    return "network" if most < HALVES else "halves" if most == HALVES else "nearest"


def _resolve_class(index: int, layout: Layout) -> Pass:
    step = _resolve(index, layout)
    low, high = BOUNDS[index], BOUNDS[index + 1]
    return replace(step, into=(IMAGE, PIXEL_CLASS.name), defines={**step.defines, "CLASS": index, "ASKS": 0},
                   writes=tuple(name for name in step.writes if name != "deepest"),
                   vertex="screen/triangle_of_class.vert", command="draws",
                   runs_in=_where(layout.runs_in, _classed,
                                  lambda plan: low < plan.known.layers and high >= UNCLASSED),
                   state=State(depth_test="equal", depth_write=False, early=True))


def _before_cut(step: Pass) -> Pass:
    """The pass without the fragments that early z discards."""
    return replace(step, into=(*step.into, "cut_depth"), runs_in=_where(step.runs_in, _cut), when=APPROXIMATE,
                   state=replace(step.state, depth_test="lequal", depth_write=False, early=True))


def _whole_and_cut(step: Pass) -> tuple[Pass, ...]:
    """The pass where nothing is cut, all of it or what is in front, and where something is."""
    whole = replace(step, runs_in=_where(step.runs_in, lambda plan: not plan.cut_off))
    return *whole_and_in_front(whole), _before_cut(step)


COUNT = Pass("count", "geometry", "methods/adaptive/count.frag", into=("fragment_counts",),
             clears={"fragment_counts": CLEARED}, defines=COUNT_DEFINES, state=State(blend=ADD), counts=True)
COUNT_LATER = replace(COUNT, counts=False, counts_for_plan=True)  # there is room for whatever comes
ALLOCATE = Pass("allocate", "fullscreen", "methods/adaptive/allocate.frag", region=True, reads=("fragment_counts",),
                writes=("counter", "taken", "deepest"))
CLASSIFIES = {"into": (PIXEL_CLASS.name,), "clears": {PIXEL_CLASS.name: (1.0,)}, "state": State(depth_test="always")}


def _store(layout: Layout, runs_in: Callable[[Plan], bool], guessed: bool = False, **more) -> Pass:
    """The pass that stores fragments; where room is `guessed`, those that find none count as not lost yet."""
    return Pass("store", "geometry", "methods/adaptive/store.frag", runs_in=runs_in, writes=layout.storage,
                defines={**layout.defines, "GUESSED": int(guessed)}, **more)


# After the count: a range for each pixel, the fragments in it, and what counts them; after that the image.
STORING = (
    Pass("clear", "clear", writes=("taken", "deepest"), runs_in=_ranged),
    Pass("clear", "clear", writes=("taken", "deepest", "draws"), runs_in=_where(_in(RANGES), _classed)),
    Pass("clear", "clear", writes=("draws",), runs_in=_classed_by_counter),
    replace(ALLOCATE, defines={**IN_RANGES.defines, "CLASSED": 0}, runs_in=_ranged),
    replace(ALLOCATE, defines={**IN_RANGES.defines, **CLASSES, "CLASSED": 1}, runs_in=_where(_in(RANGES), _classed),
            writes=(*ALLOCATE.writes, "draws"), **CLASSIFIES),
    _store(IN_PLANES, IN_PLANES.runs_in, counts_for_plan=True),
    *_whole_and_cut(_store(IN_CELLS, _where(IN_CELLS.runs_in, _certain), counts_for_plan=True)),
    *(step for layout in (IN_CELLS, IN_CHUNKS) for step in whole_and_in_front(
        _store(layout, _where(layout.runs_in, _guessed), guessed=True, counts_for_plan=True))),
    *_whole_and_cut(_store(IN_RANGES, IN_RANGES.runs_in)),
    Pass("resolve", "fullscreen", "methods/adaptive/classify.frag", region=True, reads=("counter",),
         writes=("draws", "deepest"),
         defines={**IN_CELLS.defines, **CLASSES}, runs_in=_classed_by_counter, **CLASSIFIES),
    *(Pass("resolve", "fullscreen", "methods/adaptive/stored.frag", region=True, reads=layout.reads,
           defines=layout.defines, runs_in=_where(layout.runs_in, lambda plan: not plan.in_front), probes=STORED)
      for layout in LAYOUTS),
)
RESOLVING = _resolves()


def _at_once(step: Pass) -> Pass:
    return replace(step, runs_in=_where(step.runs_in, lambda plan: not plan.banded))


def _of_band(step: Pass) -> Pass:
    return replace(step, region=step.kind != "clear", runs_in=_where(step.runs_in, _banded)).only(BUDGETED)


METHODS = [
    Method(
        id="adaptive", name="Adaptive", family="adaptive", source="mfr-bench, see docs/adaptive.md",
        summary="plans each frame from what its geometry and the frame before tell: nothing stored, planes, dense "
                "cells, for sure or by a guess that is checked, or exact ranges; sorts in registers as few fragments "
                "as a pixel has",
        guarantee="exact all", words="2*f + 2", ties="kept, in no fixed order",
        untouched="plans for each frame what it touches",
        beside=f"{2 + COMMAND_WORDS * (len(BOUNDS) - 1)} words for the cells taken, the deepest pixel and the draws of "
               "classes, and "
               f"with flat: ordered {COMMAND_WORDS} for each layer, up to {MOST_ORDERED}, for draws in order; where "
               "fragments are kept in the framebuffer, two for each layer of the viewport in place of 2f; where "
               "opaque primitives hide what is left out, one per pixel for a depth; where cells are dense, at most "
               "a twentieth of 2f + 2 for those that stay empty, or by a guess spare_memory "
               f"times as much, {MOST_GUESSED_BYTES // 2**20} MiB in all; with max_error above its "
               f"default, one and a half per pixel for the cut; with memory_mb one for each {SEGMENT} pixels of a row, "
               "and no more fragments at a time than it leaves room for",
        params=(MAX_ERROR, MEMORY_MB, SPARE_MEMORY, FLAT, OPAQUE, SHALLOW, PAYLOAD), fixed=(FURTHEST_CUT,),
        leaves_out=MAX_ERROR.name, deepest=DEEPEST,
        capacity=Planned(plan, budget=MEMORY_MB.name, least=f"min(F, {SEGMENT}*n)", deepest="deepest"),
        buffers=(Buffer("counter", "P", doc="fragments stored, or the next cell of the range, of each pixel"),
                 Buffer("taken", "1", doc="cells taken by ranges"),
                 Buffer("deepest", "1", doc="fragments of the deepest pixel, where they are counted or find no room"),
                 Buffer("draws", f"{COMMAND_WORDS}*{len(BOUNDS) - 1}", doc="indirect draw of each class of pixels"),
                 DRAWS_IN_ORDER,
                 Buffer("nodes", "2*capacity", type="FRAGMENT",
                        doc="fragments: of one pixel, in planes, in dense cells, or in ranges"),
                 Buffer("sums", f"H*ceil(W/{SEGMENT})", when=BUDGETED,
                        doc=f"fragments of each {SEGMENT} adjacent pixels of a row")),
        targets=(Target("fragment_counts", "r16", doc="number of fragments, counted by blending"),
                 replace(PIXEL_CLASS, format="depth16"),
                 Target("opacity", "rg8", when=APPROXIMATE,
                        doc="optical depth of the first and second half of the depths before furthest_cut"),
                 *in_framebuffer.TARGETS,
                 NEAREST_DEPTH,
                 Target("cut_depth", "depth32f", when=APPROXIMATE, doc="depth beyond which fragments are discarded")),
        steps=(
            Pass("blend", "geometry", "methods/baseline/floor.frag", into=(IMAGE,), clears={IMAGE: CLEARED},
                 state=State(blend=OVER), runs_in=_in(DIRECT)),
            DRAW_NEAREST,
            *IN_ORDER,
            Pass("clear", "clear", writes=("counter",), runs_in=_where(_in(DENSE), _certain)),
            Pass("clear", "clear", writes=("counter", "deepest"), runs_in=_guessed),
            Pass("clear", "clear", clears={IMAGE: CLEARED}, into=(IMAGE,), runs_in=_cleared),
            Pass("cut", "clear", clears={"cut_depth": (FURTHEST_CUT.default,)}, into=("cut_depth",), runs_in=_cut,
                 when=APPROXIMATE),
            Pass("cut", "geometry", "methods/adaptive/opacity.frag", into=("opacity", "cut_depth"),
                 clears={"opacity": CLEARED}, runs_in=_cut, when=APPROXIMATE,
                 state=State(blend=ADD, depth_test="less", depth_write=False, early=True)),
            Pass("cut", "fullscreen", "methods/adaptive/cut.frag", region=True, reads=("opacity",), into=("cut_depth",),
                 state=State(depth_test="always"), runs_in=_cut, when=APPROXIMATE),
            *_whole_and_cut(replace(COUNT, runs_in=lambda plan: plan.path == RANGES and plan.capacity is None)),
            *whole_and_in_front(
                replace(COUNT_LATER, runs_in=lambda plan: plan.path == RANGES and plan.capacity is not None)),
            *in_framebuffer.passes(),
            *map(_at_once, STORING),
            Pass("blend", "geometry", "methods/adaptive/blended.frag", probes=STORED,
                 runs_in=lambda plan: plan.path in BLENDED or plan.in_front),
            *map(_at_once, RESOLVING),
            Pass("clear", "clear", writes=("sums",), runs_in=_banded, when=BUDGETED),
            Pass("allocate", "fullscreen", "methods/adaptive/sums.frag", region=True, reads=("fragment_counts",),
                 writes=("sums",), defines={"SEGMENT": SEGMENT, **COUNT_DEFINES}, runs_in=_banded, when=BUDGETED),
            Loop(tuple(_of_band(step) for step in (*STORING, *RESOLVING) if not step.defines.get("DENSE")),
                 bands="sums"),
        ),
    ),
]
