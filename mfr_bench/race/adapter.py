"""The one place where a declared method meets the race machine: a variant as passes with their GLSL, and buffers."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace

from ..errors import UsageError
from ..glsl import StageSource, split_ref, stages
from ..glsl.bindings import DIAGNOSTICS, Binding, buffer_bindings, colour_refs, texture_bindings
from ..methods.spec import (
    FRAMEBUFFER_FETCH,
    IMAGE,
    TILE_COMMAND,
    TILE_LIST,
    Buffer,
    Counted,
    Fitted,
    FrameState,
    Grown,
    Loop,
    Pass,
    Planned,
    SceneStats,
    Target,
    Variant,
    evaluate,
    left_out,
)

DIAGNOSTICS_BUFFER = "Diagnostics"
FEATURES = frozenset({FRAMEBUFFER_FETCH})  # of the machine, as far as plans depend on them


@dataclass(frozen=True)
class FramePass:
    """A pass as a frame runs it: its declaration, its stages, and what it binds."""

    step: Pass
    sources: tuple[StageSource, ...]
    buffers: tuple[Binding, ...]
    textures: tuple[Binding, ...]
    outputs: tuple[str, ...]  # colour targets in location order
    instances: int
    groups: int

    @property
    def own(self) -> StageSource:
        """The stage with the method's code: fragment or compute."""
        return self.sources[-1]

    @property
    def concurrent(self) -> bool:
        """Whether its invocations could meet in memory."""
        return bool(self.step.writes or self.step.fetched) or self.step.kind == "compute"


@dataclass(frozen=True)
class FrameStep:
    """The next step: a pass by its number, in which iteration, and where to go on once its counting sees none."""

    step: int
    iteration: int = 0
    leave: int | None = None


@dataclass(frozen=True)
class Frame:
    """All that a machine needs to draw frames of one variant."""

    variant: Variant
    stats: SceneStats
    passes: tuple[FramePass, ...]
    steps: tuple[FrameStep, ...]
    words: dict[str, int] = field(hash=False)  # of one copy of each buffer
    capacity: int = 0
    chosen_k: int = 0
    region: tuple[int, int, int, int] = (0, 0, 0, 0)  # left, bottom, width and height of what bounds the geometry

    @property
    def fitted(self) -> Fitted:
        """The variant in its scene."""
        return Fitted(self.variant, self.stats, FEATURES)

    @property
    def buffers(self) -> tuple[Buffer, ...]:
        return (*self.variant.buffers, Buffer(DIAGNOSTICS_BUFFER, str(len(DIAGNOSTICS)), coherent=True))

    @property
    def targets(self) -> tuple[Target, ...]:
        drawn_into = {ref for p in self.passes for ref in p.step.into}
        return (*(t for t in self.variant.targets if not t.on_demand or t.name in drawn_into),
                Target(IMAGE, "rgba32f"))

    @property
    def grown_counter(self) -> str | None:
        """The buffer that counts what a frame asked for, where it may ask for more than there is."""
        capacity = self.variant.method.capacity
        return capacity.counter if isinstance(capacity, Grown) else None

    @property
    def capacity_is_counted(self) -> bool:
        return isinstance(self.variant.method.capacity, (Counted, Planned))


def frame_of(fitted: Fitted, region: tuple[int, int, int, int] | None = None) -> Frame:
    """The frame of a variant in a scene. Raises UsageError for what no small scene can show."""
    variant, stats, fitted = fitted.variant, fitted.stats, replace(fitted, features=FEATURES)
    if any(isinstance(step, Loop) and step.bands for step in variant.steps) and variant.budget_bytes:
        raise UsageError(f"{variant.method.id}: the race machine draws no frame in bands; leave memory_mb at 0")
    maker = _Maker(fitted)
    capacity, decision = fitted.capacity(), fitted.decision()
    words = {b.name: fitted.block_bytes(b, capacity) // 4 for b in variant.buffers}
    kept = decision.k if decision else int(fitted.scope.get("k", 0))
    return Frame(variant, stats, tuple(maker.passes), tuple(maker.steps),
                 words | {DIAGNOSTICS_BUFFER: len(DIAGNOSTICS)}, capacity, kept, region or (0, 0, stats.W, stats.H))


class _Maker:
    """Lays out the steps of a frame, or of two where later frames of a static scene run other passes than the first."""

    def __init__(self, fitted: Fitted):
        self.fitted = fitted
        self.passes: list[FramePass] = []
        self.steps: list[FrameStep] = []
        self.known: dict[int, int] = {}
        plan = fitted.plan() if isinstance(fitted.variant.method.capacity, Planned) else None
        frames = (False, True) if any(p.static is not None for p in fitted.variant.passes) else (False,)
        for static in frames:
            self._lay_out(FrameState(plan, static))

    def _lay_out(self, frame: FrameState) -> None:
        for step in self.fitted.variant.steps:
            if isinstance(step, Loop):
                self._loop(step, frame)
            elif left_out(step, self.fitted, frame) is None:
                self._add(step)

    def _loop(self, loop: Loop, frame: FrameState) -> None:
        if loop.bands:
            return
        first = len(self.steps)
        for iteration in range(int(evaluate(loop.times, self.fitted.stats, self.fitted.scope))):
            for step in loop.passes:
                if left_out(step, self.fitted, frame) is None:
                    self._add(step, iteration, leaves=loop.until_empty and step.counts)
        end = len(self.steps)
        self.steps[first:] = [s if s.leave is None else FrameStep(s.step, s.iteration, end) for s in self.steps[first:]]

    def _add(self, step: Pass, iteration: int = 0, leaves: bool = False) -> None:
        if id(step) not in self.known:
            self.known[id(step)] = len(self.passes)
            self.passes.append(self._made(step))
        self.steps.append(FrameStep(self.known[id(step)], iteration, 0 if leaves else None))

    def _made(self, step: Pass) -> FramePass:
        fitted, variant = self.fitted, self.fitted.variant
        sources = () if step.kind == "clear" else stages(fitted, step, texels=False)
        groups = int(evaluate(step.groups, fitted.stats, fitted.scope)) if step.groups else 0
        return FramePass(step, sources, tuple(buffer_bindings(variant, step)), tuple(texture_bindings(variant, step)),
                         tuple(colour_refs(variant, step)), fitted.value(step.instances), groups)


def locator(source: StageSource) -> Callable[[int], str]:
    """File and line of an encoded line of a stage."""
    def locate(line: int) -> str:
        return source.located(f"0:{line}(1): ").partition(": ")[0].split("(")[0] if line > 0 else source.entry
    return locate


def record(frame: Frame, only: str | None = None) -> dict:
    """The parts of a variant that the machine reads: passes in order (or those of one name), buffers, params."""
    return {
        "method": frame.variant.method.id, "params": frame.variant.params,
        "passes": [_pass_record(p) for p in _in_order(frame) if only in (None, p.step.name)],
        "buffers": [{"name": b.name, "words": frame.words[b.name], "clear": b.clear, "coherent": b.coherent,
                     "type": b.type, "copies": b.copies} for b in frame.variant.buffers],
    }


def _in_order(frame: Frame) -> Iterator[FramePass]:
    """Each pass where a frame first runs it."""
    for number in dict.fromkeys(step.step for step in frame.steps):
        yield frame.passes[number]


def _pass_record(p: FramePass) -> dict:
    return {"name": p.step.name, "kind": p.step.kind,
            "stages": [{"entry": s.entry, "glsl": s.text, "files": list(s.files)} for s in p.sources],
            "reads": list(p.step.reads), "writes": list(p.step.writes), "into": list(p.step.into)}


def tile_buffers(frame: Frame) -> tuple[str | None, str | None]:
    """The list of tiles and its commands, where resolves go by tile."""
    names = {b.name for b in frame.buffers}
    return (TILE_LIST if TILE_LIST in names else None, TILE_COMMAND if TILE_COMMAND in names else None)


def base_of(ref: str) -> tuple[str, int]:
    """A reference as a name and a role of the machine: 0 as it is, 1 current, 2 previous."""
    name, role = split_ref(ref)
    return name, {"": 0, "current": 1, "previous": 2}[role]
