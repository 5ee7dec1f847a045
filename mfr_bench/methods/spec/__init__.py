"""The vocabulary in which a method is declared: parameters, resources, passes, guarantee.

A declaration is data. It knows nothing of GL objects, YAML, files or plots; `gpu.executor` runs it,
and the catalog, the tables and the tests read it.

Formulas are strings over the names of `SceneStats` and the method's own parameters, e.g. ``"2*k*P"``, so
that one text is evaluated for allocation, compared with the paper's, and printed.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cache, cached_property
from typing import Any, Literal

from ...errors import nearest

Value = int | float | str
Params = Mapping[str, Value]

ON_OFF = ("on", "off")
UNIT_ROUNDOFF = 2.0**-24  # of float32, to nearest
ALPHA_STEPS = 255  # an 8-bit alpha is a multiple of 1/255
LEAF_ROUNDINGS = 21  # unit roundoffs of a fragment's own colour and of the last terms (docs/accuracy.md)
EMPTY = 0xFFFFFFFF  # no fragment, no next node: above the bits of every depth in [0, 1]
SAMPLE_FEATURES: Mapping[str, int] = {f"samples_{count}": count for count in (4, 8, 16, 32)}  # of multisample targets
SAMPLE_STENCIL = "sample_stencil"  # the feature of testing each sample's stencil with multisampling off


@dataclass(frozen=True)
class SceneStats:
    """What a frame needs to know of its scene. Counts are of fragments unless said otherwise."""

    W: int  # viewport width, pixels
    H: int  # viewport height, pixels
    n: int  # most fragments in any pixel, at least 1
    F: int  # fragments of the frame
    primitives: int  # submitted
    rejects: bool = False  # some fragments are not generated (f_p < 1, or pixels that draw their number)
    histogram: tuple[int, ...] = ()  # histogram[i] = pixels with i fragments
    geometry: str = "quad"  # how primitives reach the device: shaders/scene/<geometry>.vert
    area: int | None = None  # pixels of the rectangle that bounds the geometry; None: of the viewport
    layers: int | None = None  # most fragments that a pixel can have by the geometry; None: those of every primitive
    reach: int | None = None  # most fragments that the geometry can have; None: every layer in every pixel
    least: int = 0  # fewest fragments that a pixel draws of those of all primitives; 0: every pixel has all

    @property
    def P(self) -> int:
        """Pixels of the viewport."""
        return self.W * self.H

    @property
    def flat(self) -> bool:
        """Whether each primitive has one depth, and meets no pixel but at its edges."""
        return self.geometry == "quad"

    @property
    def most_layers(self) -> int:
        """Most fragments that a pixel can have by the geometry alone: a strip of two triangles may cover it twice."""
        return self.layers if self.layers is not None else self.primitives * (1 if self.geometry == "quad" else 2)

    def bounded(self, k: int) -> int:
        """Fragments left when each pixel keeps at most `k`: the sum of min(f, k) over the pixels."""
        return sum(min(f, k) * pixels for f, pixels in enumerate(self.histogram))

    def paged(self, page: int) -> int:
        """Cells in the pages of `page` cells that the fragments fill when no two pixels share one."""
        return sum(math.ceil(f / page) * page * pixels for f, pixels in enumerate(self.histogram))

    def names(self) -> dict[str, float]:
        return {"W": self.W, "H": self.H, "P": self.P, "n": self.n, "F": self.F, "f": self.F / self.P}


# What a parameter may ask of a scene: facts of SceneStats, in words.
SCENE_FACTS: Mapping[str, str] = {"flat": "flat primitives that meet no pixel but at its edges"}


def doubled(start: int, needed: int) -> int:
    """Capacity reached when `start` is doubled until it holds `needed` (gpupro5 §1.5.2)."""
    capacity = max(1, start)
    while capacity < needed:
        capacity *= 2
    return capacity


@cache
def _compiled(formula: str):
    return compile(formula, f"<formula {formula}>", "eval")


def evaluate(formula: str, stats: SceneStats, params: Params) -> float:
    """Value of a resource formula for one frame. Raises NameError for a name it does not know."""
    functions = {"ceil": math.ceil, "floor": math.floor, "log2": math.log2, "min": min, "max": max, "doubled": doubled,
                 "bounded": stats.bounded, "paged": stats.paged}
    scope = {"__builtins__": {}} | functions | stats.names() | dict(params)
    if "k" in params:
        scope["f_k"] = stats.bounded(int(params["k"])) / stats.P
    return eval(_compiled(formula), scope)


@dataclass(frozen=True)
class Param:
    """One parameter of a method: a whole number in [low, high] or `of` a list, one of `choices`, or a `real` number.

    A real number lies between the bounds, of which it reaches none, or with `closed` the upper one. `off` is allowed
    beside them.
    """

    name: str
    default: Value
    doc: str
    choices: tuple[str, ...] = ()
    low: float = 1
    high: float = 1024
    real: bool = False
    closed: bool = False
    off: float | None = None
    of: tuple[int, ...] = ()
    needs: Mapping[str, str] = field(default_factory=dict)  # choice, or a range "5-8" -> feature the device must have
    asks: Mapping[str, str] = field(default_factory=dict)  # choice -> what it asks of a scene, a key of SCENE_FACTS
    weakens: Mapping[str, str] = field(default_factory=dict)  # choice or range -> the known failure that it brings
    acts: When | None = None  # where it has an effect; elsewhere it stands at its default

    @property
    def allowed(self) -> str:
        if self.real:
            off = "" if self.off is None else f"{self.off:g} or "
            return off + (f"a number above {self.low}, up to {self.high}" if self.closed
                          else f"a number between {self.low} and {self.high}")
        if self.choices or self.of:
            return " | ".join(map(str, self.choices or self.of))
        return f"a whole number from {self.low} to {self.high}"

    def need(self, value: Value) -> str | None:
        """The feature that a device must have for the value."""
        return self._said(self.needs, value)

    def weakness(self, value: Value) -> str | None:
        """The known failure that the value brings."""
        return self._said(self.weakens, value)

    def _said(self, of: Mapping[str, str], value: Value) -> str | None:
        if self.choices:
            return of.get(str(value))
        ranges = ((*map(float, key.split("-")), text) for key, text in of.items())
        return next((text for low, *high, text in ranges if low <= float(value) <= (high or [low])[0]), None)

    def at(self, value: Value) -> Param:
        """The same parameter with another default, for `Method.fixed`."""
        return replace(self, default=value)

    def parse(self, value: Any) -> Value:
        """The canonical value, or ValueError saying what is allowed. YAML's bare on/off are booleans."""
        if self.choices:
            if isinstance(value, bool) and (word := "on" if value else "off") in self.choices:
                return word
            if value in self.choices:
                return value
            raise ValueError(f"{value!r} is not allowed; allowed: {self.allowed}{nearest(str(value), self.choices)}")
        number = isinstance(value, (int, float) if self.real else int) and not isinstance(value, bool)
        inside = number and self.low <= value <= self.high
        if self.real:
            inside = inside and value != self.low and (self.closed or value != self.high)
            inside = inside or (number and value == self.off)
        if not inside or (self.of and value not in self.of):
            raise ValueError(f"{value!r} is not allowed; allowed: {self.allowed}")
        return float(value) if self.real else value


@dataclass(frozen=True)
class When:
    """Holds where the parameter `name` has one of `values`."""

    name: str
    values: tuple[Value, ...]
    also: When | None = None

    def holds(self, params: Params) -> bool:
        return params[self.name] in self.values and (self.also is None or self.also.holds(params))

    def __and__(self, other: When) -> When:
        return replace(self, also=self.also & other if self.also else other)


def when(name: str, *values: Value) -> When:
    return When(name, values)


@dataclass(frozen=True)
class Grown:
    """Capacity that starts at `start` elements and doubles whenever the counter, read after a frame, has passed it.

    `counter` names the one-word buffer that counts what the frame asked for, `wanted` by its formula; the frame is
    then redone.
    """

    start: str
    counter: str
    wanted: str = "F"


# What stands beside the words of a method whose cells come from a counter.
SPARE_CELLS = ("the counter, one word per frame, and the spare cells of a capacity that is doubled until the frame "
               "fits, where the formula counts those in use")


@dataclass(frozen=True)
class Counted:
    """Capacity known inside the frame: what the pass that `counts` has counted by an occlusion query, or `totals`.

    `elements` is the same as a formula of the scene's stats.
    """

    elements: str = "F"


@dataclass(frozen=True)
class Choice:
    """What the host sets inside a frame: fragments kept per pixel, and elements for all that are kept."""

    k: int
    capacity: int


Rule = Callable[[Sequence[int], int, int, Params], Choice]


@dataclass(frozen=True)
class Decided:
    """k and the capacity set by the host inside the frame, after the pass that `decides`.

    `reads` names the buffer that the pass has written: pixels with 1, 2, … fragments, deeper ones in the last place.
    `rule` gives the choice from it, the fragments counted, the pixels of the viewport and the parameters. Later
    passes see the chosen k as K.
    """

    reads: str
    rule: Rule


@dataclass(frozen=True)
class Known:
    """What a host knows before it draws a frame: its geometry, and what it counted in the frame before."""

    layers: int  # most fragments that a pixel can have by the geometry
    area: int  # pixels of the rectangle that bounds the geometry on the screen
    pixels: int  # of the viewport
    fragments: int | None  # of the frame before; None where there was none
    room: int | None = None  # elements that the budget allows; None: any number
    reach: int | None = None  # most fragments that the geometry can have; None: every layer in every pixel
    filled: bool = False  # every primitive has one fragment in each pixel of the rectangle

    @classmethod
    def of(cls, stats: SceneStats, fragments: int | None, room: int | None) -> Known:
        """Of a scene of these sizes, from what its geometry tells."""
        area = stats.P if stats.area is None else stats.area
        filled = stats.flat and not stats.rejects and stats.reach == stats.primitives * area
        return cls(stats.most_layers, area, stats.P, fragments, room, stats.reach, filled)


@dataclass(frozen=True)
class Plan:
    """How a frame is drawn: which passes run, and room for how many elements; None: counted within the frame.

    `banded`: the budget may not hold all elements at once, so that loops over bands run. `cut`: what lies behind a
    depth that an earlier pass finds for each pixel is left out.
    """

    path: str
    known: Known
    capacity: int | None = None
    banded: bool = False
    cut: bool = False


@dataclass(frozen=True)
class Planned:
    """The passes and the capacity of each frame are planned by the host before it, by `rule`.

    The passes that `runs_in` lets run have to be right whatever the frame before had. `budget` names the parameter
    that holds the most MiB, 0 for any number; a band then has at most `least` elements, a formula.
    """

    rule: Callable[[Known, Params], Plan]
    budget: str | None = None
    least: str = "F"


# FRAGMENT is a depth with its payload, PAYLOAD a payload; formulas count them with the plain payload of one word.
ELEMENT_WORDS: Mapping[str, int] = {"uint": 1, "uvec2": 2, "uint64_t": 2, "vec4": 4, "FRAGMENT": 2, "PAYLOAD": 1}
PAYLOAD_WORDS: Mapping[str, int] = {"rgba8": 1, "rgba16f": 2, "two_channel": 1}


@dataclass(frozen=True)
class Buffer:
    """A shader storage buffer of 32-bit words.

    `words` is its length as a formula, in which `capacity` is the method's. `clear` is the GLSL value that the
    clear pass gives to every element, or with `clear_heads` to the first P, or P times
    the parameter that it names in GLSL. Two copies take turns in a loop.
    """

    name: str
    words: str
    type: str = "uint"  # GLSL element type, a key of ELEMENT_WORDS
    clear: str | None = None
    clear_heads: bool | str = False
    coherent: bool = False
    copies: int = 1
    when: When | None = None

    @property
    def element_words(self) -> int:
        return ELEMENT_WORDS[self.type]


Format = Literal["r8", "rg8", "rgba8", "r16", "rgba16f", "r32f", "rg32f", "rgba32f", "r32ui", "depth16", "depth32f",
                 "depth24_stencil8"]
FORMAT_WORDS: Mapping[str, float] = {"r8": 0.25, "rg8": 0.5, "rgba8": 1, "r16": 0.5, "rgba16f": 2, "r32f": 1,
                                     "rg32f": 2, "rgba32f": 4, "r32ui": 1, "depth16": 0.5, "depth32f": 1,
                                     "depth24_stencil8": 1}


@dataclass(frozen=True)
class Target:
    """A texture of the viewport's size that passes draw into. Two copies are used in turn in a loop.

    `samples` and `layers` are formulas: of a multisample texture, and of an array whose layers are drawn into at
    once, at successive locations.
    """

    name: str
    format: Format
    copies: int = 1
    when: When | None = None
    samples: str | None = None
    layers: str | None = None

    @property
    def attaches(self) -> Literal["colour", "depth"]:
        """Where a framebuffer takes it; a stencil comes with a depth."""
        return "depth" if self.format.startswith("depth") else "colour"


@dataclass(frozen=True)
class Stencil:
    """Stencil test of each sample, and what becomes of its value whether it passes or fails; both clamp at the ends."""

    test: Literal["always", "equal"]
    update: Literal["increment", "decrement"]
    reference: int = 0


Blend = tuple[str, str, str]  # equation, source factor, destination factor


@dataclass(frozen=True)
class State:
    """Fixed-function state of a draw. `blends` holds one blend for each location, where they differ.

    `blend_alpha`: the factors of alpha, where they are others than those of `blend`.
    """

    blend: Blend | None = None
    blend_alpha: tuple[str, str] | None = None
    blends: tuple[Blend, ...] = ()
    depth_test: Literal["less", "lequal", "equal", "always"] | None = None
    depth_write: bool = True  # where a depth target is attached
    early: bool = False  # the tests come before the shader, whatever it writes
    stencil: Stencil | None = None
    multisample: bool = True  # in a multisample target; off: a fragment covers all samples where it covers the middle


UNDER = ("add", "one_minus_dst_alpha", "one")  # premultiplied, front to back
BEHIND = ("add", "dst_alpha", "one")  # premultiplied, front to back, where alpha holds the transmittance
SEEN_THROUGH_BOTH = ("zero", "one_minus_src_alpha")  # the factors of alpha that go with it
INVERTED_ALPHA = ("one_minus_dst_alpha", "zero")  # under a source alpha of 1
OVER = ("add", "one", "one_minus_src_alpha")  # premultiplied, back to front
MAX = ("max", "one", "one")
ADD = ("add", "one", "one")
REVEAL = ("add", "zero", "one_minus_src_alpha")  # the product of 1 - alpha

COMMAND_WORDS = 5  # of an indirect draw in a buffer of several: vertices, instances, the first of both, and one unused
TILE_LIST, TILE_COMMAND = "tile_list", "tile_command"  # of passes that go by tile: which, and the indirect draw of them
DISPATCH_OFFSET = 16  # bytes of TILE_COMMAND before the indirect dispatch: the four words of the draw
LISTED = 16  # pixels, side of the tiles that are listed
TILE_POINTS = f"points_{LISTED}"  # the feature of drawing points as large as a tile
IMAGE = "image"  # the frame's result: RGBA32F, premultiplied, shared by all methods, in no method's memory


@dataclass(frozen=True)
class Pass:
    """One step that the papers time.

    `shader` is the fragment (geometry, fullscreen) or compute entry point below shaders/. `into` names
    the targets drawn into, in location order (a depth format attaches as depth); none means that the
    pass only writes buffers, and its colour writes are masked. `reads` and `writes` name buffers, or
    targets as textures; in a loop `.current` and `.previous` tell the copies apart. The executor puts a
    memory barrier before any pass that touches what an earlier one wrote. `clears` gives targets the
    values that they start the pass with; a pass of kind `clear` does nothing else. A compute pass writes `into`
    as images. `expand` makes the passes that run out of the declared one and the chosen parameters; `targets` and
    `buffers` are resources that shared code brings to whatever method uses it.
    """

    name: str
    kind: Literal["geometry", "fullscreen", "compute", "clear"]
    shader: str = ""
    reads: tuple[str, ...] = ()
    writes: tuple[str, ...] = ()
    into: tuple[str, ...] = ()
    clears: Mapping[str, tuple[float, ...]] = field(default_factory=dict)
    state: State = State()
    defines: Mapping[str, Any] = field(default_factory=dict)
    groups: str | None = None  # compute: number of work groups, a formula
    instances: str = "1"  # fullscreen: how often it is drawn, a formula
    counts: bool = False  # count the samples that pass, by an occlusion query
    totals: str | None = None  # a buffer whose words, as the pass leaves them, add up to the capacity
    decides: bool = False  # afterwards the host sets k and the capacity, as the method's `Decided` says
    fetch: str | None = None  # the include by which a resolve reads fragments
    resolver: str | None = None  # the include by which a resolve makes them one colour
    vertex: str | None = None  # another vertex shader than the kind's own
    when: When | None = None
    needed: str | None = None  # a formula; the pass is left out where it gives 0
    runs_in: Callable[[Plan], bool] | None = None  # of a planned method: whether a frame of this plan needs the pass
    region: bool = False  # draws and clears only what bounds the geometry, or the loop's band; a clear: all but that
    by_tile: bool = False  # only the tiles of TILE_LIST, as TILE_COMMAND has it on the device: a point or a group each
    command: str | None = None  # the buffer of indirect draws; the pass is drawn by the one of its define CLASS
    still: bool | None = None  # False: only in a scene's first frame, for all; True: only in frames after that
    tallies: bool = False  # count the samples that pass, for the plan of the next frame
    probes: str | None = None  # the counter outside the method's memory that it fills; runs where that is asked for
    expand: Callable[[Pass, Params], tuple[Pass, ...]] | None = None
    targets: tuple[Target, ...] = ()
    buffers: tuple[Buffer, ...] = ()


@dataclass(frozen=True)
class Loop:
    """Passes repeated at most `times` (a formula); with `until_empty`, until the counting pass sees none.

    `bands`: repeated instead for each band of the region whose elements the budget holds; its name is that of the
    buffer with the fragments of each `mfr_bench.bands.SEGMENT` pixels of a row. Passes with `region` touch the band.
    """

    passes: tuple[Pass, ...]
    times: str = "1"
    until_empty: bool = True
    bands: str | None = None


Guarantee = Literal["exact all", "exact k nearest", "exact k best", "approximate", "none"]


@dataclass(frozen=True)
class Promise:
    """The image that a method aims at: of each pixel the `layers` best fragments by `criterion`, or all of them.

    two_channel: in the colours that a payload of two channels gives back.
    """

    layers: int | None = None
    criterion: str = "nearest"
    two_channel: bool = False


@dataclass(frozen=True)
class Method:
    """A multi-fragment rendering method as its paper describes it.

    `words` is the paper's memory formula in 32-bit words per pixel (f: the pixel's fragments), `beside` what stands
    beside them or in their place, and why. `cost` is the reason why it may take more than thrice the time of the
    fastest A-buffer.
    `ties` says what becomes of fragments of equal depth. `needs` names device features without which
    no choice of parameters runs.
    """

    id: str
    name: str
    family: str
    source: str
    summary: str
    guarantee: Guarantee
    words: str
    steps: tuple[Pass | Loop, ...]
    ties: str
    params: tuple[Param, ...] = ()
    buffers: tuple[Buffer, ...] = ()
    targets: tuple[Target, ...] = ()
    needs: tuple[str, ...] = ()
    fixed: tuple[Param, ...] = ()  # parameters of shared shaders, at defaults that this method never varies
    local: str = "n"  # most fragments of a pixel that its resolve composites, a formula
    capacity: Grown | Counted | Decided | Planned | None = None
    failure: str | None = None  # the known failure of an approximate method
    beside: str | None = None
    cost: str | None = None
    leaves_out: str | None = None  # the parameter that bounds the error of leaving out fragments far behind others
    deepest: int | None = None  # most fragments of a pixel that the method can hold
    cut: str | None = None  # the nearest fragments that its parameters leave of all, 0 for every one: a formula
    mixes: bool = False  # its image stands for every fragment, whatever its k; few or none are held as they were
    exact_where: str | None = None  # where an approximate method is exact all the same: a formula, e.g. "n <= k"
    merges: bool = False  # composites groups of fragments by themselves before they are stacked

    def param(self, name: str) -> Param | None:
        return next((p for p in self.params if p.name == name), None)

    def complete(self, given: Mapping[str, Any]) -> dict[str, Value]:
        """All parameters of the method: `given` ones parsed, others and those without effect at their defaults."""
        chosen = {p.name: p.parse(given[p.name]) if p.name in given else p.default for p in self.params}
        return {p.name: chosen[p.name] if p.acts is None or p.acts.holds(chosen) else p.default for p in self.params}

    def variant(self, params: Params) -> Variant:
        return Variant(self, self.complete(params))

    @property
    def k_saves_passes(self) -> bool:
        """Whether a loop runs less often the more fragments each round of it keeps."""
        deep = SceneStats(W=1, H=1, n=1024, F=1024, primitives=1024)
        few, many = (self.complete({}) | {"k": k} for k in (1, deep.n))
        return any(evaluate(step.times, deep, many) < evaluate(step.times, deep, few)
                   for step in self.steps if isinstance(step, Loop))

    @property
    def passes(self) -> tuple[Pass, ...]:
        """Every declared pass in order, loops unrolled once."""
        return tuple(p for step in self.steps for p in (step.passes if isinstance(step, Loop) else (step,)))

    @property
    def pass_names(self) -> tuple[str, ...]:
        return tuple(dict.fromkeys(p.name for p in self.passes))


@dataclass(frozen=True)
class Variant:
    """A method with every parameter chosen: what is compiled, allocated and measured."""

    method: Method
    params: dict[str, Value]

    def __hash__(self) -> int:
        return hash((self.method.id, tuple(sorted(self.params.items()))))

    def _active(self, items):
        return tuple(i for i in items if i.when is None or i.when.holds(self.scope))

    @property
    def scope(self) -> dict[str, Value]:
        """Parameters that formulas, conditions and shaders see."""
        return {p.name: p.default for p in self.method.fixed} | self.params

    @property
    def buffers(self) -> tuple[Buffer, ...]:
        return self._active(self.method.buffers + tuple(b for p in self.passes for b in p.buffers))

    @property
    def targets(self) -> tuple[Target, ...]:
        return self._active(self.method.targets + tuple(t for p in self.passes for t in p.targets))

    @cached_property
    def steps(self) -> tuple[Pass | Loop, ...]:
        """What runs with these parameters, in order. The passes are the same objects each time."""
        found: list[Pass | Loop] = []
        for step in self.method.steps:
            if isinstance(step, Loop):
                found.append(replace(step, passes=self._expanded(step.passes)))
            else:
                found += self._expanded((step,))
        return tuple(found)

    def _expanded(self, passes: tuple[Pass, ...]) -> tuple[Pass, ...]:
        return tuple(made for p in self._active(passes) for made in (p.expand(p, self.scope) if p.expand else (p,)))

    @property
    def passes(self) -> tuple[Pass, ...]:
        return tuple(p for step in self.steps for p in (step.passes if isinstance(step, Loop) else (step,)))

    def value(self, formula: str, stats: SceneStats) -> int:
        """A formula of a pass: it may also use `keep`, the method's `local`."""
        keep = max(1, int(evaluate(self.method.local, stats, self.scope)))
        return int(evaluate(formula, stats, self.scope | {"keep": keep}))

    def runs(self, step: Pass, stats: SceneStats) -> bool:
        """Whether a frame of these sizes needs the pass."""
        return step.needed is None or bool(self.value(step.needed, stats))

    @property
    def pass_names(self) -> tuple[str, ...]:
        return tuple(dict.fromkeys(p.name for p in self.passes))

    @property
    def needs(self) -> tuple[str, ...]:
        """Device features that these parameters need."""
        chosen = (p.need(self.params[p.name]) for p in self.acting)
        return self.method.needs + tuple(f for f in chosen if f)

    @property
    def asks(self) -> tuple[str, ...]:
        """Facts of a scene without which these parameters do not work."""
        return tuple(p.asks[str(self.params[p.name])] for p in self.acting if str(self.params[p.name]) in p.asks)

    @property
    def acting(self) -> tuple[Param, ...]:
        """The method's parameters that have an effect here."""
        return tuple(p for p in self.method.params if p.acts is None or p.acts.holds(self.scope))

    @property
    def weaknesses(self) -> tuple[str, ...]:
        """The known failures that chosen parameters bring to a method that has none."""
        brought = (p.weakness(self.params[p.name]) for p in self.acting)
        return tuple(f for f in brought if f)

    @property
    def guarantee(self) -> Guarantee:
        """What the method promises with these parameters."""
        promised = self.method.guarantee
        if promised == "none":
            return promised
        cut = promised == "exact all" and self.layers is not None
        return "approximate" if self.weaknesses else "exact k nearest" if cut else promised

    def exact_in(self, stats: SceneStats) -> bool:
        """Whether the image of a scene of these sizes has to be the promised one."""
        if self.guarantee.startswith("exact"):
            return True
        condition = None if self.weaknesses else self.method.exact_where
        return condition is not None and bool(evaluate(condition, stats, self.scope))

    def kept(self, stats: SceneStats) -> int:
        """Fragments that the image is made of when the method does what it promises."""
        layers = self.promise(stats).layers
        return stats.bounded(layers) if layers else stats.F

    @property
    def layers(self) -> int | None:
        """Most fragments per pixel that the parameters let reach the image; None means all."""
        if self.method.cut:
            return int(evaluate(self.method.cut, SceneStats(W=1, H=1, n=1, F=1, primitives=1), self.scope)) or None
        bounded = self.method.guarantee not in ("exact all", "none") and not self.method.mixes
        return int(self.scope["k"]) if bounded and "k" in self.scope else None

    def promise(self, stats: SceneStats) -> Promise:
        """The image that the method aims at in a scene, by which conformance is judged."""
        decision = self.decision(stats)
        return Promise(decision.k if decision else self.layers, str(self.scope.get("criterion", "nearest")),
                       self.two_channel)

    @property
    def two_channel(self) -> bool:
        """Whether fragments are stored with colours of two channels."""
        return self.scope.get("payload") == "two_channel"

    def decision(self, stats: SceneStats) -> Choice | None:
        """What the host will choose in a scene, or None where nothing is chosen."""
        decided = self.method.capacity
        if not isinstance(decided, Decided):
            return None
        return decided.rule(stats.histogram[1:], stats.F, stats.P, self.scope)

    def local_array(self, stats: SceneStats) -> int:
        """Fragments in the longest local array of any shader that a frame runs."""
        return max((self.value(str(p.defines["LOCAL"]), stats) for p in self.passes
                    if "LOCAL" in p.defines and self.runs(p, stats)), default=0)

    def error_bound(self, stats: SceneStats) -> float | None:
        """Largest channel error by float32 rounding (docs/accuracy.md) and by what the method leaves out.

        None where no image is promised.
        """
        if not self.guarantee.startswith("exact"):
            return None
        layers = min(stats.n, self.promise(stats).layers or stats.n)
        left_out = float(self.scope[self.method.leaves_out]) if self.method.leaves_out else 0.0
        steps = 5 * layers if self.method.merges else layers / 2 + 2 * min(layers, ALPHA_STEPS)
        return (steps + LEAF_ROUNDINGS) * UNIT_ROUNDOFF + left_out

    def _values(self, stats: SceneStats) -> Params:
        """What resource formulas see: the parameters, and the k that the host chooses."""
        decision = self.decision(stats)
        return self.scope | {"k": decision.k} if decision else self.scope

    @property
    def all_params(self) -> tuple[Param, ...]:
        return self.method.fixed + self.method.params

    def capacity(self, stats: SceneStats) -> int:
        """Elements that the variable buffers have room for once the frame fits."""
        if isinstance(self.method.capacity, Grown):
            wanted = int(evaluate(self.method.capacity.wanted, stats, self.scope))
            return doubled(self.start_capacity(stats), wanted)
        if isinstance(self.method.capacity, Counted):
            return int(evaluate(self.method.capacity.elements, stats, self.scope))
        if isinstance(self.method.capacity, Planned):
            plan = self.plan(stats)
            counted = stats.F if plan.known.room is None else max(0, min(stats.F, plan.known.room))
            return counted if plan.capacity is None else plan.capacity
        decision = self.decision(stats)
        return decision.capacity if decision else stats.F

    def plan(self, stats: SceneStats) -> Plan:
        """The plan of a frame whose scene was shown before, of a planned method."""
        return self.method.capacity.rule(Known.of(stats, stats.F, self.room(stats)), self.scope)

    @property
    def budget_bytes(self) -> int:
        """Bytes that a parameter of the method allows it; 0: any number."""
        planned = self.method.capacity
        named = isinstance(planned, Planned) and planned.budget
        return int(float(self.scope[planned.budget]) * 2**20) if named else 0

    def room(self, stats: SceneStats) -> int | None:
        """Elements that the budget allows beside what every frame takes, below 1 where that is too much already."""
        if not self.budget_bytes:
            return None
        one, two = (sum(self.memory_bytes(stats, elements).values()) for elements in (1, 2))
        return (self.budget_bytes - one) // (two - one) + 1

    def least_bytes(self, stats: SceneStats) -> int:
        """Bytes of the smallest budget by which the method can draw any scene of these sizes; 0 where it has none."""
        if not self.budget_bytes:
            return 0
        least = max(1, int(evaluate(self.method.capacity.least, stats, self.scope)))
        return sum(self.memory_bytes(stats, least).values())

    def start_capacity(self, stats: SceneStats) -> int:
        """Elements allocated before anything is known of the frame; 0 where the frame counts them first."""
        if isinstance(self.method.capacity, Grown):
            return max(1, int(evaluate(self.method.capacity.start, stats, self.scope)))
        return 0

    def block_bytes(self, buffer: Buffer, stats: SceneStats, capacity: int | None = None) -> int:
        """Bytes of one copy of a buffer; an empty one still holds one element."""
        room = self.capacity(stats) if capacity is None else capacity
        words = int(evaluate(buffer.words, stats, {**self._values(stats), "capacity": room}))
        elements = max(1, words // buffer.element_words)
        return 4 * (max(words, buffer.element_words) + elements * self._extra_words(buffer))

    @property
    def payload_words(self) -> int:
        """Words that a fragment takes beside its depth."""
        return PAYLOAD_WORDS[str(self.scope.get("payload", "rgba8"))]

    def _extra_words(self, buffer: Buffer) -> int:
        """Words of each element beyond those that the buffer's formula counts."""
        return self.payload_words - 1 if buffer.type in ("FRAGMENT", "PAYLOAD") else 0

    def memory_bytes(self, stats: SceneStats, capacity: int | None = None) -> dict[str, int]:
        """Bytes of each resource, by name, with as much capacity as the frame needs or as is given.

        The image that all methods share is not counted.
        """
        buffers = {b.name: b.copies * self.block_bytes(b, stats, capacity) for b in self.buffers}
        targets = {t.name: int(4 * FORMAT_WORDS[t.format]) * t.copies * stats.P * self.samples(t, stats)
                   * self.layer_count(t, stats) for t in self.targets}
        return buffers | targets

    @property
    def stores_fewer(self) -> bool:
        """Whether fragments may be discarded before they take room: the declared bytes are then the most."""
        cut = self.method.leaves_out and self.guarantee == "approximate" and isinstance(self.method.capacity, Planned)
        return bool(cut or (self.scope.get("occupancy") and isinstance(self.method.capacity, (Grown, Counted))))

    def samples(self, target: Target, stats: SceneStats) -> int:
        """Samples of a target's pixel."""
        return self.value(target.samples, stats) if target.samples else 1

    def layer_count(self, target: Target, stats: SceneStats) -> int:
        """Layers of a target."""
        return self.value(target.layers, stats) if target.layers else 1

    def model_bytes(self, stats: SceneStats) -> int:
        """Bytes by the paper's words per pixel, and by the words of a wider payload."""
        values = self._values(stats)
        stored = {**values, "capacity": stats.F}
        wider = sum(evaluate(b.words, stats, stored) / b.element_words * self._extra_words(b) for b in self.buffers)
        return round(4 * (stats.P * evaluate(self.method.words, stats, values) + wider))
