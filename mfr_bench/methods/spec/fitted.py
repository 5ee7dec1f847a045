"""A variant bound to the statistics of its scene: whatever depends on both is answered here.

Allocation, tables and tests ask for bytes here, so that what is printed is what is allocated.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

from .capacity import Choice, Counted, Decided, Grown, Known, Plan, Planned
from .formulas import doubled, evaluate
from .method import Promise, Variant
from .params import Params
from .passes import Pass
from .resources import FORMAT_WORDS, FRAMEBUFFER_FETCH, Buffer, Target
from .scene_stats import SceneStats

PAIRED_WORDS = 2  # of an element, of which a texel holds two
UNIT_ROUNDOFF = 2.0**-24  # of float32, to nearest
ALPHA_STEPS = 255  # an 8-bit alpha is a multiple of 1/255
LEAF_ROUNDINGS = 21  # unit roundoffs of a fragment's own colour and of the last terms (docs/accuracy.md)


@dataclass(frozen=True)
class Fitted:
    """A variant with the statistics of the scene that it draws, and the features of the device, where one is known."""

    variant: Variant
    stats: SceneStats
    features: frozenset[str] = frozenset()

    @cached_property
    def scope(self) -> Params:
        """The parameters that formulas, conditions and shaders see."""
        return self.variant.scope

    def value(self, formula: str) -> int:
        """The value of a pass's formula, which may also use `keep`, the method's `local`."""
        return int(evaluate(formula, self.stats, self.scope | {"keep": self._keep}))

    @cached_property
    def _keep(self) -> int:
        return max(1, int(evaluate(self.variant.method.local, self.stats, self.scope)))

    # --- the image ---

    def promise(self) -> Promise:
        """The image that the method aims at in the scene, by which conformance is judged."""
        decision = self.decision()
        return Promise(decision.k if decision else self.variant.layers, str(self.scope.get("criterion", "nearest")),
                       self.variant.two_channel)

    def exact(self) -> bool:
        """Whether the image of the scene has to be the promised one."""
        if self.variant.guarantee.startswith("exact"):
            return True
        condition = None if self.variant.weaknesses else self.variant.method.exact_where
        return condition is not None and bool(evaluate(condition, self.stats, self.scope))

    def kept(self) -> int:
        """Fragments that the image is made of when the method does what it promises."""
        layers = self.promise().layers
        return self.stats.bounded(layers) if layers else self.stats.F

    def error_bound(self) -> float | None:
        """Largest channel error by float32 rounding (docs/accuracy.md) and by what the method leaves out.

        None where no image is promised, or another effect than transparency is.
        """
        if not (self.variant.guarantee.startswith("exact") and self.stats.blended):
            return None
        method = self.variant.method
        layers = min(self.stats.n, self.promise().layers or self.stats.n)
        left_out = float(self.scope[method.leaves_out]) if method.leaves_out else 0.0
        steps = 5 * layers if method.merges else layers / 2 + 2 * min(layers, ALPHA_STEPS)
        return (steps + LEAF_ROUNDINGS) * UNIT_ROUNDOFF + left_out

    # --- what the host decides ---

    def decision(self) -> Choice | None:
        """The choice that the host will make in the scene, or None if it makes none."""
        return self._decision

    @cached_property
    def _decision(self) -> Choice | None:
        decided, stats = self.variant.method.capacity, self.stats
        if not isinstance(decided, Decided):
            return None
        return decided.rule(stats.histogram[1:], stats.F, stats.P, self.scope)

    def plan(self) -> Plan:
        """The plan of a frame whose scene was shown before, of a planned method."""
        plan = self._plan_of(self.stats.F, self.stats.n)
        return self._plan_of(*self.stats.in_front) if plan.in_front and self.stats.in_front else plan

    def _plan_of(self, fragments: int, deepest: int) -> Plan:
        """The plan of a frame after one that had so many fragments, and so many in its deepest pixel."""
        known = Known.of(self.stats, fragments, self.room(), deepest, self.fetches)
        return self.variant.method.capacity.rule(known, self.scope)

    @property
    def fetches(self) -> bool:
        """Whether the device lets a shader read the pixel that a fragment is drawn into."""
        return FRAMEBUFFER_FETCH in self.features

    def room(self) -> int | None:
        """Elements that the budget allows in addition to what every frame takes, below 1 where that is too much."""
        if not self.variant.budget_bytes:
            return None
        one, two = (sum(self.memory_bytes(elements).values()) for elements in (1, 2))
        return (self.variant.budget_bytes - one) // (two - one) + 1

    # --- memory ---

    def start_capacity(self) -> int:
        """Elements allocated before anything is known of the frame; 0 where the frame counts them first."""
        grown = self.variant.method.capacity
        return max(1, int(evaluate(grown.start, self.stats, self.scope))) if isinstance(grown, Grown) else 0

    def capacity(self) -> int:
        """Elements that the variable buffers have room for once the frame fits."""
        return self._capacity

    @cached_property
    def _capacity(self) -> int:
        known = self.variant.method.capacity
        if isinstance(known, Grown):
            return doubled(self.start_capacity(), int(evaluate(known.wanted, self.stats, self.scope)))
        if isinstance(known, Counted):
            return int(evaluate(known.elements, self.stats, self.scope))
        if isinstance(known, Planned):
            plan = self.plan()
            counted = self.stats.F if plan.known.room is None else max(0, min(self.stats.F, plan.known.room))
            counted = plan.known.fragments if plan.in_front else counted
            return counted if plan.capacity is None else plan.capacity
        decision = self.decision()
        return decision.capacity if decision else self.stats.F

    def memory_bytes(self, capacity: int | None = None) -> dict[str, int]:
        """Bytes of each resource, by name, with as much capacity as the frame needs or as is given.

        The image that all methods share is not counted.
        """
        return self._frame_bytes if capacity is None else self._bytes(capacity)

    @cached_property
    def _frame_bytes(self) -> dict[str, int]:
        return self._bytes(None)

    def _bytes(self, capacity: int | None) -> dict[str, int]:
        buffers = {b.name: b.copies * self.block_bytes(b, capacity) for b in self.variant.buffers}
        targets = {t.name: int(4 * FORMAT_WORDS[t.format]) * t.copies * self.stats.P * self.samples(t)
                   * self.layer_count(t) for t in self.variant.targets if not t.on_demand or t.name in self._drawn_into}
        return buffers | targets

    @cached_property
    def _drawn_into(self) -> frozenset[str]:
        """The targets that passes of the plan draw into; none with a budget, which leaves no plan with such targets."""
        if not isinstance(self.variant.method.capacity, Planned) or self.variant.budget_bytes:
            return frozenset()
        plan = self.plan()
        return frozenset(ref for p in self.variant.passes if p.runs_in and p.runs_in(plan) for ref in p.into)

    def block_bytes(self, buffer: Buffer, capacity: int | None = None) -> int:
        """Bytes of one copy of a buffer; an empty one still has one element."""
        room = self.capacity() if capacity is None else capacity
        words = int(evaluate(buffer.words, self.stats, {**self._values, "capacity": room}))
        elements = max(1, words // buffer.element_words)
        return 4 * (max(words, buffer.element_words) + elements * self._extra_words(buffer))

    def least_bytes(self) -> int:
        """Bytes of the smallest budget by which the method can draw any scene like this; 0 where it has none."""
        if not self.variant.budget_bytes:
            return 0
        least = max(1, int(evaluate(self.variant.method.capacity.least, self.stats, self.scope)))
        return sum(self.memory_bytes(least).values())

    def model_bytes(self) -> int:
        """Bytes by the paper's words per pixel, and by the words of a wider payload."""
        stored = {**self._values, "capacity": self.stats.F}
        wider = sum(evaluate(b.words, self.stats, stored) / b.element_words * self._extra_words(b)
                    for b in self.variant.buffers)
        words = evaluate(self.variant.method.words, self.stats, self._values)
        return round(4 * (self.stats.P * words + wider))

    def samples(self, target: Target) -> int:
        """Samples of a target's pixel."""
        return self.value(target.samples) if target.samples else 1

    def layer_count(self, target: Target) -> int:
        """Layers of a target."""
        return self.value(target.layers) if target.layers else 1

    def needed(self, step: Pass) -> bool:
        """Whether the scene needs the pass."""
        return step.needed is None or bool(self.value(step.needed))

    def local_array(self) -> int:
        """Fragments in the longest local array of any shader that a frame runs."""
        return max((self.value(str(p.defines["LOCAL"])) for p in self.variant.passes
                    if "LOCAL" in p.defines and self.needed(p)), default=0)

    @cached_property
    def _values(self) -> Params:
        """The names that resource formulas see: the parameters, and the k that the host chooses."""
        decision = self.decision()
        return {**self.scope, "k": decision.k} if decision else self.scope

    def element_bytes(self, buffer: Buffer) -> int:
        """Bytes of one element of a buffer, with the payload that the variant has."""
        return 4 * (buffer.element_words + self._extra_words(buffer))

    def reads_pairs(self, step: Pass, buffer: str) -> bool:
        """Whether a pass reads the elements of a buffer two at a time: where it may, and they have two words each."""
        return buffer in step.pairs and any(b.name == buffer and self.element_bytes(b) == 4 * PAIRED_WORDS
                                            for b in self.variant.buffers)

    def _extra_words(self, buffer: Buffer) -> int:
        """Words of each element in addition to those that the buffer's formula counts."""
        return self.variant.payload_words - 1 if buffer.type in ("FRAGMENT", "PAYLOAD") else 0
