"""The vocabulary in which a method is declared: parameters, resources, passes, guarantee.

A declaration is data. It knows nothing of GL objects, YAML, files or plots; `gpu.executor` runs it,
and the catalog, the tables and the tests read it.

Formulas are strings over the names of `Sizes` and the method's own parameters, e.g. ``"2*k*P"``, so
that one text is evaluated for allocation, compared with the paper's, and printed.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import lru_cache
from typing import Any, Literal

from ..errors import nearest

Value = int | float | str
Params = Mapping[str, Value]

ON_OFF = ("on", "off")


@dataclass(frozen=True)
class Sizes:
    """What a frame needs to know of its scene. Counts are of fragments unless said otherwise."""

    W: int  # viewport width, pixels
    H: int  # viewport height, pixels
    n: int  # most fragments in any pixel, at least 1
    F: int  # fragments of the frame
    quads: int  # rectangles submitted
    rejects: bool = False  # some generated fragments are discarded (f_p < 1)
    histogram: tuple[int, ...] = ()  # histogram[i] = pixels with i fragments

    @property
    def P(self) -> int:
        """Pixels of the viewport."""
        return self.W * self.H

    def bounded(self, k: int) -> int:
        """Fragments left when each pixel keeps at most `k`: the sum of min(f, k) over the pixels."""
        return sum(min(f, k) * pixels for f, pixels in enumerate(self.histogram))

    def names(self) -> dict[str, float]:
        return {"W": self.W, "H": self.H, "P": self.P, "n": self.n, "F": self.F, "f": self.F / self.P}


def doubled(start: int, needed: int) -> int:
    """Capacity reached when `start` is doubled until it holds `needed` (gpupro5 §1.5.2)."""
    capacity = max(1, start)
    while capacity < needed:
        capacity *= 2
    return capacity


@lru_cache(maxsize=None)
def _compiled(formula: str):
    return compile(formula, f"<formula {formula}>", "eval")


def evaluate(formula: str, sizes: Sizes, params: Params) -> float:
    """Value of a resource formula for one frame. Raises NameError for a name it does not know."""
    functions = {"ceil": math.ceil, "floor": math.floor, "log2": math.log2, "min": min, "max": max, "doubled": doubled,
                 "bounded": sizes.bounded}
    scope = {"__builtins__": {}} | functions | sizes.names() | dict(params)
    if "k" in params:
        scope["f_k"] = sizes.bounded(int(params["k"])) / sizes.P
    return eval(_compiled(formula), scope)


@dataclass(frozen=True)
class Param:
    """One parameter of a method: a whole number in [low, high], one of `choices`, or a `real` number in (low, high)."""

    name: str
    default: Value
    doc: str
    choices: tuple[str, ...] = ()
    low: float = 1
    high: float = 1024
    real: bool = False
    needs: Mapping[str, str] = field(default_factory=dict)  # choice -> feature the device must have

    @property
    def allowed(self) -> str:
        if self.real:
            return f"a number between {self.low} and {self.high}"
        return " | ".join(self.choices) if self.choices else f"a whole number from {self.low} to {self.high}"

    def at(self, value: Value) -> Param:
        """The same parameter with another default, for `Method.fixed`."""
        return replace(self, default=value)

    def parse(self, value: Any) -> Value:
        """The canonical value, or ValueError saying what is allowed. YAML's bare on/off are booleans."""
        if self.choices:
            if isinstance(value, bool) and self.choices == ON_OFF:
                return "on" if value else "off"
            if value in self.choices:
                return value
            raise ValueError(f"{value!r} is not allowed; allowed: {self.allowed}{nearest(str(value), self.choices)}")
        number = isinstance(value, (int, float) if self.real else int) and not isinstance(value, bool)
        if not number or not (self.low < value < self.high if self.real else self.low <= value <= self.high):
            raise ValueError(f"{value!r} is not allowed; allowed: {self.allowed}")
        return float(value) if self.real else value


@dataclass(frozen=True)
class When:
    """Holds where the parameter `name` has one of `values`."""

    name: str
    values: tuple[Value, ...]

    def holds(self, params: Params) -> bool:
        return params[self.name] in self.values


def when(name: str, *values: Value) -> When:
    return When(name, values)


@dataclass(frozen=True)
class Grown:
    """Capacity that starts at `start` elements and doubles whenever the counter, read after a frame, has passed it.

    `counter` names the one-word buffer that counts what the frame asked for; the frame is then redone.
    """

    start: str
    counter: str


@dataclass(frozen=True)
class Counted:
    """Capacity known inside the frame: what the pass that `counts` has counted by an occlusion query."""


@dataclass(frozen=True)
class Buffer:
    """A shader storage buffer of 32-bit words.

    `words` is its length as a formula, in which `capacity` is the method's. `clear` is the GLSL value that the
    clear pass gives to every element, or with `clear_heads` to the first P. Two copies take turns in a loop.
    """

    name: str
    words: str
    type: str = "uint"  # GLSL element type: uint, uvec2 or uint64_t
    clear: str | None = None
    clear_heads: bool = False
    coherent: bool = False
    copies: int = 1
    when: When | None = None

    @property
    def element_words(self) -> int:
        return {"uint": 1, "uvec2": 2, "uint64_t": 2}[self.type]


Format = Literal["r32f", "rg32f", "rgba32f", "depth32f"]
FORMAT_WORDS: Mapping[str, int] = {"r32f": 1, "rg32f": 2, "rgba32f": 4, "depth32f": 1}


@dataclass(frozen=True)
class Target:
    """A texture of the viewport's size that passes draw into. Two copies are used in turn in a loop."""

    name: str
    format: Format
    copies: int = 1
    when: When | None = None


@dataclass(frozen=True)
class State:
    """Fixed-function state of a draw. `blend` is equation, source factor, destination factor."""

    blend: tuple[str, str, str] | None = None
    depth_test: Literal["less", "lequal"] | None = None


UNDER = ("add", "one_minus_dst_alpha", "one")  # premultiplied, front to back
OVER = ("add", "one", "one_minus_src_alpha")  # premultiplied, back to front
MAX = ("max", "one", "one")

IMAGE = "image"  # the frame's result: RGBA32F, premultiplied, shared by all methods, in no method's memory


@dataclass(frozen=True)
class Pass:
    """One step that the papers time.

    `shader` is the fragment (geometry, fullscreen) or compute entry point below shaders/. `into` names
    the targets drawn into, in location order (a depth format attaches as depth); none means that the
    pass only writes buffers, and its colour writes are masked. `reads` and `writes` name buffers, or
    targets as textures; in a loop `.current` and `.previous` tell the copies apart. The executor puts a
    memory barrier before any pass that touches what an earlier one wrote. `clears` gives targets the
    values that they start the pass with; a pass of kind `clear` does nothing else.
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
    counts: bool = False  # count the samples that pass, by an occlusion query
    fetch: str | None = None  # the include by which a resolve reads fragments
    when: When | None = None


@dataclass(frozen=True)
class Loop:
    """Passes repeated at most `times` (a formula); with `until_empty`, until the counting pass sees none."""

    passes: tuple[Pass, ...]
    times: str
    until_empty: bool = True


Guarantee = Literal["exact all", "exact k nearest", "approximate", "none"]


@dataclass(frozen=True)
class Method:
    """A multi-fragment rendering method as its paper describes it.

    `words` is the paper's memory formula in 32-bit words per pixel (f: the pixel's fragments).
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
    local: str = "n"  # length of the resolve's local array, a formula
    capacity: Grown | Counted | None = None
    failure: str | None = None  # the known failure of an approximate method

    def param(self, name: str) -> Param | None:
        return next((p for p in self.params if p.name == name), None)

    def complete(self, given: Mapping[str, Any]) -> dict[str, Value]:
        """All parameters of the method, `given` ones parsed, the others at their defaults."""
        return {p.name: p.parse(given[p.name]) if p.name in given else p.default for p in self.params}

    def variant(self, params: Params) -> Variant:
        return Variant(self, self.complete(params))

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
        return self._active(self.method.buffers)

    @property
    def targets(self) -> tuple[Target, ...]:
        return self._active(self.method.targets)

    @property
    def steps(self) -> tuple[Pass | Loop, ...]:
        return tuple(Loop(self._active(s.passes), s.times, s.until_empty) if isinstance(s, Loop) else s
                     for s in self.method.steps if isinstance(s, Loop) or self._active((s,)))

    @property
    def passes(self) -> tuple[Pass, ...]:
        return self._active(self.method.passes)

    @property
    def pass_names(self) -> tuple[str, ...]:
        return tuple(dict.fromkeys(p.name for p in self.passes))

    @property
    def needs(self) -> tuple[str, ...]:
        """Device features that these parameters need."""
        chosen = (p.needs.get(str(self.params[p.name])) for p in self.method.params)
        return self.method.needs + tuple(f for f in chosen if f)

    def kept(self, sizes: Sizes) -> int:
        """Fragments that the image is made of when the method does what it promises."""
        return sizes.bounded(self.layers) if self.layers else sizes.F

    @property
    def layers(self) -> int | None:
        """Most fragments per pixel that reach the image; None means all."""
        return int(self.scope["k"]) if self.method.guarantee == "exact k nearest" else None

    @property
    def all_params(self) -> tuple[Param, ...]:
        return self.method.fixed + self.method.params

    def capacity(self, sizes: Sizes) -> int:
        """Elements that the variable buffers have room for once the frame fits."""
        if isinstance(self.method.capacity, Grown):
            return doubled(self.start_capacity(sizes), sizes.F)
        return sizes.F

    def start_capacity(self, sizes: Sizes) -> int:
        """Elements allocated before anything is known of the frame; 0 where the frame counts them first."""
        if isinstance(self.method.capacity, Grown):
            return max(1, int(evaluate(self.method.capacity.start, sizes, self.scope)))
        return 0

    def block_bytes(self, buffer: Buffer, sizes: Sizes, capacity: int | None = None) -> int:
        """Bytes of one copy of a buffer; an empty one still holds one element."""
        room = self.capacity(sizes) if capacity is None else capacity
        words = int(evaluate(buffer.words, sizes, self.scope | {"capacity": room}))
        return 4 * max(words, buffer.element_words)

    def memory_bytes(self, sizes: Sizes) -> dict[str, int]:
        """Bytes of each resource, by name. The image that all methods share is not counted."""
        buffers = {b.name: b.copies * self.block_bytes(b, sizes) for b in self.buffers}
        targets = {t.name: 4 * FORMAT_WORDS[t.format] * t.copies * sizes.P for t in self.targets}
        return buffers | targets

    def model_bytes(self, sizes: Sizes) -> int:
        """Bytes by the paper's words per pixel."""
        return round(4 * sizes.P * evaluate(self.method.words, sizes, self.scope))
