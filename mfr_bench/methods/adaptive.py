"""The method of this project: only the work that a scene needs, without a k, an n or a size from its user.

Before a frame the host knows its geometry: how many primitives can cover a pixel, the rectangle that they lie in, and
how many fragments the frame before had. From these it plans the frame:

- `direct`: no pixel can have two fragments. They are blended, and nothing is stored.
- `dense`: cells for every layer of every pixel of the rectangle take at most SPARE more memory than exact ranges would.
  Nothing is counted beforehand; the cells of neighbours lie side by side.
- `ranges`: a count by blending, then each pixel takes a range of exactly its fragments; empty pixels take none.
- `cut`: the same, of what lies before the depth behind which no more than `max_error` shows through.

With a budget of memory that may not hold all fragments, `ranges` and `cut` go band by band: what follows the count
is drawn once for each of the rectangles whose fragments fit.

No plan can lose a fragment: what the frame before had only decides how much memory `dense` may take. The fragments of
a pixel are sorted in registers, by a network as small as their number allows; beyond 32 the nearest 32 are kept,
sweep by sweep, until all are composited or no more than `max_error` shows through.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

from ..bands import SEGMENT
from .shared import CLEARED, HELD, PAYLOAD, PIXEL_CLASS
from .spec import IMAGE, OVER, Buffer, Known, Loop, Method, Param, Params, Pass, Plan, Planned, State, Target, When

ORDER = 9

EXACT = 2.0**-20  # of the transmittance: no more than rounding errs by in a stack of a hundred fragments

MAX_ERROR = Param("max_error", EXACT, "largest error of a channel by which fragments far behind others may be left "
                  "out; by default so small that the image counts as exact", real=True, low=0, high=1,
                  weakens={"0.000000954-1": "fragments behind others may be left out, an error of up to max_error"})
MEMORY_MB = Param("memory_mb", 0.0, "most memory in MiB; where it does not hold all fragments at once, the frame is "
                  "stored and resolved in several bands; 0: any number", real=True, low=0, high=2**20, off=0.0)

DIRECT, DENSE, RANGES, CUT = "direct", "dense", "ranges", "cut"
SPARE = 1 / 20  # of the memory of exact ranges and two words per pixel, that `dense` may take beside it

NETWORKS = (2, 4, 8, 16, 32)  # fragments of each sorting network; deeper pixels are swept
SWEPT = 64  # places of the network that sweeps: 32 fragments kept, and 32 that are new
DEEPEST = 65535  # fragments that 16 bits can count
WORTH_CUTTING = 24  # layers from which two cheap passes for the opacity cost less than storing what it hides
UNCLASSED = 4  # layers up to which telling pixels apart costs more than it saves
BOUNDS = (0, *NETWORKS, 2**32)
ADD = ("add", "one", "one")


def plan(known: Known, params: Params) -> Plan:
    """The cheapest way that is right and stays within the memory of exact ranges and SPARE."""
    if known.layers <= 1:
        return Plan(DIRECT, known, 0)
    cells = known.layers * known.area
    banded = known.room is not None and cells > known.room
    if float(params.get("max_error", EXACT)) > EXACT and known.layers >= WORTH_CUTTING:
        return Plan(CUT, known, banded=banded)
    if known.fragments is not None and not banded:
        room = known.fragments + SPARE * (known.fragments + known.pixels)
        if cells <= room:
            return Plan(DENSE, known, cells)
    return Plan(RANGES, known, banded=banded)


@dataclass(frozen=True)
class Above(When):
    """Holds where the parameter `name` is above the one value."""

    def holds(self, params: Params) -> bool:
        return float(params[self.name]) > float(self.values[0]) and (self.also is None or self.also.holds(params))


APPROXIMATE = Above(MAX_ERROR.name, (EXACT,))
BUDGETED = Above(MEMORY_MB.name, (0.0,))


@dataclass(frozen=True)
class Layout:
    """Where cells lie: which frames have them there, and how the shaders are told."""

    runs_in: Callable[[Plan], bool]
    defines: Mapping[str, int]

    @property
    def reads(self) -> tuple[str, ...]:
        return ("counter", "nodes") if self.defines["DENSE"] else ("counter", "nodes", "tally")


def _in(*paths: str) -> Callable[[Plan], bool]:
    return lambda plan: plan.path in paths


def _beside(plan: Plan) -> bool:
    """Whether the resolve leaves pixels out beside the region."""
    return plan.path != DIRECT and not plan.banded and plan.known.area < plan.known.pixels and not _classed(plan)


def _classed(plan: Plan) -> bool:
    """Whether pixels are told apart by their number of fragments."""
    return plan.path in (RANGES, CUT) and plan.known.layers > UNCLASSED


WHOLE = Layout(lambda plan: plan.path == DENSE and plan.known.area == plan.known.pixels, {"DENSE": 1, "PART": 0})
PART = Layout(lambda plan: plan.path == DENSE and plan.known.area < plan.known.pixels, {"DENSE": 1, "PART": 1})
EXACT_RANGES = Layout(_in(RANGES, CUT), {"DENSE": 0, "PART": 0})
LAYOUTS = (WHOLE, PART, EXACT_RANGES)


def _cleared(plan: Plan) -> bool:
    """Whether the resolve leaves pixels out anywhere."""
    return plan.banded or _classed(plan)


def _banded(plan: Plan) -> bool:
    return plan.banded


def _ranged(plan: Plan) -> bool:
    return plan.path in (RANGES, CUT) and not _classed(plan)


def _resolves() -> tuple[Pass, ...]:
    """One resolve for each number of fragments: of all pixels, or of a class of them."""
    return tuple(made for index in range(len(BOUNDS) - 1) for made in (
        *(_resolve(index, layout) for layout in LAYOUTS), _resolve_class(index)))


def _resolve(index: int, layout: Layout) -> Pass:
    low, high = BOUNDS[index], BOUNDS[index + 1]
    swept = high > NETWORKS[-1]
    return Pass("resolve", "fullscreen", "methods/adaptive/resolve.frag", region=True, into=(IMAGE,),
                runs_in=lambda plan: layout.runs_in(plan) and low < plan.known.layers <= high and not _classed(plan),
                reads=layout.reads,
                resolver=f"methods/adaptive/{'nearest' if swept else 'network'}.glsl",
                defines={**layout.defines, "NETWORK": SWEPT if swept else high})


def _resolve_class(index: int) -> Pass:
    step = _resolve(index, EXACT_RANGES)
    low, high = BOUNDS[index], BOUNDS[index + 1]
    return replace(step, into=(IMAGE, PIXEL_CLASS.name), defines={**step.defines, "CLASS": index},
                   vertex="screen/triangle_of_class.vert",
                   runs_in=lambda plan: _classed(plan) and low < plan.known.layers and high >= UNCLASSED,
                   state=State(depth_test="equal", depth_write=False, early=True))


def _before_cut(step: Pass) -> Pass:
    """The pass without the fragments that early z discards."""
    return replace(step, into=(*step.into, "cut_depth"), runs_in=_in(CUT), when=APPROXIMATE,
                   state=replace(step.state, depth_test="lequal", depth_write=False, early=True))


COUNT = Pass("count", "geometry", "methods/adaptive/count.frag", into=("tally",), clears={"tally": CLEARED},
             state=State(blend=ADD), counts=True)
ALLOCATE = Pass("allocate", "fullscreen", "methods/adaptive/allocate.frag", region=True, reads=("tally",),
                writes=("counter", "taken"))
STORE = Pass("store", "geometry", "methods/adaptive/store.frag", writes=("counter", "nodes"))

# After the count: a range for each pixel, the fragments in it, and what counts them; after that the image.
STORED = (
    Pass("clear", "clear", writes=("taken",), runs_in=_in(RANGES, CUT)),
    replace(ALLOCATE, defines={"CLASSED": 0, "PART": 0}, runs_in=_ranged),
    replace(ALLOCATE, defines={"CLASSED": 1, "PART": 0}, runs_in=_classed, into=(PIXEL_CLASS.name,),
            clears={PIXEL_CLASS.name: (1.0,)}, state=State(depth_test="always")),
    *(replace(STORE, defines=layout.defines, runs_in=layout.runs_in, tallies=bool(layout.defines["DENSE"]))
      for layout in (WHOLE, PART)),
    replace(STORE, defines=EXACT_RANGES.defines, runs_in=_in(RANGES)),
    _before_cut(replace(STORE, defines=EXACT_RANGES.defines)),
    *(Pass("resolve", "fullscreen", "methods/adaptive/held.frag", region=True, reads=layout.reads,
           defines=layout.defines, runs_in=layout.runs_in, probes=HELD) for layout in LAYOUTS),
)
RESOLVED = _resolves()


def _at_once(step: Pass) -> Pass:
    return replace(step, runs_in=lambda plan: step.runs_in(plan) and not plan.banded)


def _of_band(step: Pass) -> Pass:
    return replace(step, region=step.kind != "clear", runs_in=lambda plan: step.runs_in(plan) and plan.banded,
                   when=step.when & BUDGETED if step.when else BUDGETED)

METHODS = [
    Method(
        id="adaptive", name="Adaptive", family="adaptive", source="mfr-bench, see docs/adaptive.md",
        summary="plans each frame from what its geometry and the frame before tell: nothing stored, dense cells, or "
                "exact ranges; sorts in registers as few fragments as a pixel has",
        guarantee="exact all", words="2*f + 2", ties="kept, in no fixed order",
        beside="one word for the cells taken; where cells are dense, at most a twentieth of 2f + 2 for those that stay "
               "empty; with max_error above its default, two words per pixel for the cut; with memory_mb one for each "
               f"{SEGMENT} pixels of a row, and no more fragments at a time than it leaves room for",
        params=(MAX_ERROR, MEMORY_MB, PAYLOAD), leaves_out=MAX_ERROR.name, deepest=DEEPEST,
        capacity=Planned(plan, budget=MEMORY_MB.name, least=f"min(F, {SEGMENT}*n)"),
        buffers=(Buffer("counter", "P"), Buffer("taken", "1"), Buffer("nodes", "2*capacity", type="FRAGMENT"),
                 Buffer("sums", f"H*ceil(W/{SEGMENT})", when=BUDGETED)),
        targets=(Target("tally", "r16"), replace(PIXEL_CLASS, format="depth16"),
                 Target("opacity", "rgba8", when=APPROXIMATE), Target("cut_depth", "depth32f", when=APPROXIMATE)),
        steps=(
            Pass("blend", "geometry", "methods/baseline/floor.frag", into=(IMAGE,), clears={IMAGE: CLEARED},
                 state=State(blend=OVER), runs_in=_in(DIRECT)),
            Pass("clear", "clear", clears={IMAGE: CLEARED}, into=(IMAGE,), runs_in=_cleared),
            Pass("clear", "clear", clears={IMAGE: CLEARED}, into=(IMAGE,), region=True, runs_in=_beside),
            Pass("clear", "clear", writes=("counter",), runs_in=_in(DENSE)),
            Pass("cut", "geometry", "methods/adaptive/opacity.frag", into=("opacity",), clears={"opacity": CLEARED},
                 state=State(blend=ADD), runs_in=_in(CUT), when=APPROXIMATE),
            Pass("cut", "fullscreen", "methods/adaptive/cut.frag", region=True, reads=("opacity",), into=("cut_depth",),
                 state=State(depth_test="always"), runs_in=_in(CUT), when=APPROXIMATE),
            replace(COUNT, runs_in=_in(RANGES)),
            _before_cut(COUNT),
            *map(_at_once, STORED),
            Pass("blend", "geometry", "methods/adaptive/blended.frag", runs_in=_in(DIRECT), probes=HELD),
            *map(_at_once, RESOLVED),
            Pass("clear", "clear", writes=("sums",), runs_in=_banded, when=BUDGETED),
            Pass("allocate", "fullscreen", "methods/adaptive/sums.frag", region=True, reads=("tally",),
                 writes=("sums",), defines={"SEGMENT": SEGMENT}, runs_in=_banded, when=BUDGETED),
            Loop(tuple(_of_band(step) for step in (*STORED, *RESOLVED) if not step.defines.get("DENSE")), bands="sums"),
        ),
    ),
]
