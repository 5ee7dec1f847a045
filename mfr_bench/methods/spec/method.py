"""A method as its paper describes it, and a variant of it: the method with every parameter chosen."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, Literal

from .capacity import Counted, Decided, Grown, Planned
from .formulas import evaluate
from .params import Param, Params, Value
from .passes import Loop, Pass
from .resources import IMAGE, PAYLOAD_WORDS, Buffer, Target
from .scene_stats import SceneStats

CLASSIFY = "common/classify.frag"  # sorts pixels into classes, and gives colour to none
ONE = SceneStats(W=1, H=1, n=1, F=1, primitives=1)  # for formulas that depend on parameters alone

Guarantee = Literal["exact all", "exact k nearest", "exact k best", "approximate", "none"]


@dataclass(frozen=True)
class Promise:
    """The image that a method aims at: of each pixel the `layers` best fragments by `criterion`, or all of them.

    two_channel: in the colours that a payload of two channels gives back.
    """

    layers: int | None = None
    criterion: str = "nearest"
    two_channel: bool = False


class _Stepped:
    """Passes of the `steps`: of a method all that it declares, of a variant those that run with its parameters."""

    steps: tuple[Pass | Loop, ...]

    @property
    def passes(self) -> tuple[Pass, ...]:
        """Every pass in order, loops unrolled once."""
        return tuple(p for step in self.steps for p in (step.passes if isinstance(step, Loop) else (step,)))

    @property
    def pass_names(self) -> tuple[str, ...]:
        """The names of the passes, each once, in order."""
        return tuple(dict.fromkeys(p.name for p in self.passes))


@dataclass(frozen=True)
class Method(_Stepped):
    """A multi-fragment rendering method as its paper describes it.

    `words` is the paper's memory formula in 32-bit words per pixel (f: the pixel's fragments), `beside` what is
    allocated in addition or in their place, and why. `cost` is the reason why it may take more than three times as long
    as the fastest A-buffer.
    `ties` says what becomes of fragments of equal depth, `loses_ties` whether some of them are lost by nature,
    `spoils_ties` whether nothing is then promised of a pixel that has them. `needs` names device features without which
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
    loses_ties: bool = False
    spoils_ties: bool = False
    counts_losses: bool = False  # a fragment may be lost, but every one that is lost is counted
    needs: tuple[str, ...] = ()
    fixed: tuple[Param, ...] = ()  # parameters of shared shaders, at defaults that this method never varies
    local: str = "n"  # most fragments of a pixel that its resolve composites, a formula
    capacity: Grown | Counted | Decided | Planned | None = None
    failure: str | None = None  # the known failure of an approximate method
    beside: str | None = None
    cost: str | None = None
    leaves_out: str | None = None  # the parameter that bounds the error of leaving out fragments far behind others
    deepest: int | None = None  # most fragments of a pixel that the method can hold
    most_layers: str | None = None  # the nearest fragments that its parameters leave of all, 0: every one; a formula
    mixes: bool = False  # its image stands for every fragment, whatever its k; few or none are stored as they were
    exact_where: str | None = None  # where an approximate method is exact all the same: a formula, e.g. "n <= k"
    untouched: str | None = None  # why it has no parameter `touched`
    package: Mapping[str, str | None] | None = None  # name, version and hash of what brings it from outside
    merges: bool = False  # composites groups of fragments by themselves before they are stacked

    def param(self, name: str) -> Param | None:
        return next((p for p in self.params if p.name == name), None)

    def complete(self, given: Mapping[str, Any]) -> dict[str, Value]:
        """All parameters of the method: `given` ones parsed, others and those without effect at their defaults.

        They are settled in order: one whose effect depends on another that may have none stands behind it.
        """
        chosen = {p.name: p.parse(given[p.name]) if p.name in given else p.default for p in self.params}
        for p in self.params:
            if p.acts and not p.acts.holds(chosen):
                chosen[p.name] = p.default
        return chosen

    def variant(self, params: Params) -> Variant:
        return Variant(self, self.complete(params))

    @cached_property
    def k_saves_passes(self) -> bool:
        """Whether a loop runs less often the more fragments each round of it keeps."""
        deep = SceneStats(W=1, H=1, n=1024, F=1024, primitives=1024)
        few, many = (self.complete({}) | {"k": k} for k in (1, deep.n))
        return any(evaluate(step.times, deep, many) < evaluate(step.times, deep, few)
                   for step in self.steps if isinstance(step, Loop))


@dataclass(frozen=True)
class Variant(_Stepped):
    """A method with every parameter chosen: what is compiled, allocated and measured. Bound to a scene it is Fitted."""

    method: Method
    params: dict[str, Value]

    def __hash__(self) -> int:
        return hash((self.method.id, tuple(sorted(self.params.items()))))

    def _active(self, items):
        return tuple(i for i in items if i.when is None or i.when.holds(self.scope))

    @cached_property
    def scope(self) -> dict[str, Value]:
        """The parameters that formulas, conditions and shaders see."""
        return {p.name: p.default for p in self.method.fixed} | self.params

    @cached_property
    def buffers(self) -> tuple[Buffer, ...]:
        """The buffers that these parameters use."""
        return self._active(self.method.buffers + tuple(b for p in self.passes for b in p.buffers))

    @cached_property
    def targets(self) -> tuple[Target, ...]:
        """The targets that these parameters use."""
        return self._active(self.method.targets + tuple(t for p in self.passes for t in p.targets))

    @cached_property
    def steps(self) -> tuple[Pass | Loop, ...]:
        """The steps that run with these parameters, in order. The passes are the same objects each time."""
        found: list[Pass | Loop] = []
        for step in self.method.steps:
            if isinstance(step, Loop):
                inside = self._expanded(step.passes)
                found += [replace(step, passes=inside)] if inside else []
            else:
                found += self._expanded((step,))
        return tuple(found)

    def _expanded(self, passes: tuple[Pass, ...]) -> tuple[Pass, ...]:
        return tuple(made for p in self._active(passes) for made in (p.expand(p, self.scope) if p.expand else (p,)))

    @property
    def all_params(self) -> tuple[Param, ...]:
        """The parameters that shaders see: the method's own, after those that it never varies."""
        return self.method.fixed + self.method.params

    @cached_property
    def acting(self) -> tuple[Param, ...]:
        """The method's parameters that have an effect here."""
        return tuple(p for p in self.method.params if p.acts is None or p.acts.holds(self.scope))

    @cached_property
    def needs(self) -> tuple[str, ...]:
        """Device features that these parameters need."""
        chosen = (p.need(self.params) for p in self.acting)
        return self.method.needs + tuple(f for f in chosen if f)

    @cached_property
    def asks(self) -> tuple[str, ...]:
        """Facts of a scene without which these parameters do not work."""
        chosen = {p.asked(self.params[p.name]): None for p in self.acting if p.asked(self.params[p.name])}
        promises = self.method.guarantee != "none"
        facts = {
            "forward": any(step.kind == "geometry" and step.state.depth_test for step in self.passes),
            "blended": promises and not self.hands_on,
            "one_sample": self.hands_on and any(step.kind == "geometry" and step.into for step in self.passes),
            "unmasked": self.hands_on and self.method.loses_ties,
        }
        return tuple(chosen | dict.fromkeys(name for name, asked in facts.items() if asked))

    @property
    def hands_on(self) -> bool:
        """Whether the image is made of the fragments that are kept of a pixel one by one, nearest first.

        Any effect can then take the place of transparency.
        """
        shaded = [p for p in self.passes if IMAGE in p.into and p.shader and p.shader != CLASSIFY]
        return not self.method.mixes and bool(shaded) and all(p.hands_on for p in shaded)

    @property
    def weaknesses(self) -> tuple[str, ...]:
        """The known failures that chosen parameters bring to a method that has none."""
        return tuple(str(p.weakness(self.params[p.name])) for p in self._weakening)

    @property
    def _weakening(self) -> tuple[Param, ...]:
        return tuple(p for p in self.acting if p.weakness(self.params[p.name]))

    @property
    def weakened_error(self) -> float | None:
        """The largest error of a channel that the weaknesses bring; None if there is none, or one of unknown error."""
        formulas = [p.error for p in self._weakening]
        if not formulas or None in formulas:
            return None
        return max(float(evaluate(str(formula), ONE, self.scope)) for formula in formulas)

    @property
    def counts_losses(self) -> bool:
        """Whether a fragment may be lost, but every one that is lost is counted."""
        return self.method.counts_losses or any(p.counts_losses for p in self._weakening)

    @property
    def guarantee(self) -> Guarantee:
        """The guarantee of the method with these parameters."""
        promised = self.method.guarantee
        if promised == "none":
            return promised
        cut = promised == "exact all" and self.layers is not None
        return "approximate" if self.weaknesses else "exact k nearest" if cut else promised

    @property
    def layers(self) -> int | None:
        """Most fragments per pixel that the parameters let reach the image; None means all."""
        if self.method.most_layers:
            return int(evaluate(self.method.most_layers, ONE, self.scope)) or None
        bounded = self.method.guarantee not in ("exact all", "none") and not self.method.mixes
        return int(self.scope["k"]) if bounded and "k" in self.scope else None

    @property
    def two_channel(self) -> bool:
        """Whether fragments are stored with colours of two channels."""
        return self.scope.get("payload") == "two_channel"

    @property
    def payload_words(self) -> int:
        """Words that a fragment takes in addition to its depth."""
        return PAYLOAD_WORDS[str(self.scope.get("payload", "rgba8"))]

    @property
    def budget_bytes(self) -> int:
        """Bytes that a parameter of the method allows it; 0: any number."""
        planned = self.method.capacity
        named = isinstance(planned, Planned) and planned.budget
        return int(float(self.scope[planned.budget]) * 2**20) if named else 0

    @property
    def stores_fewer(self) -> bool:
        """Whether fragments may be discarded before they take room: the declared bytes are then the most."""
        cut_off = (self.method.leaves_out and self.guarantee == "approximate"
                   and isinstance(self.method.capacity, Planned))
        return bool(cut_off or (self.scope.get("occupancy") and isinstance(self.method.capacity, (Grown, Counted))))


class Variants:
    """The variants of methods that many cells have: each is made once, and so is all that it derives."""

    def __init__(self, catalog: Mapping[str, Method]):
        self._catalog = catalog
        self._made: dict[tuple, Variant] = {}

    def of(self, method: str, params: Params) -> Variant:
        """The variant of a method by its id, with all parameters chosen."""
        chosen = method, *params.items()
        if chosen not in self._made:
            self._made[chosen] = self._catalog[method].variant(params)
        return self._made[chosen]
