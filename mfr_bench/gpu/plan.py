"""The plan of a frame: its passes with their bindings, and the barriers between them. Made and printed without GL.

`gpu.frame` executes it.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from ..glsl.bindings import Binding, buffer_bindings, split_ref, texture_bindings
from ..methods.spec import TILE_COMMAND, TILE_LIST, Fitted, FrameState, Loop, Pass, Planned, Variant, left_out


@dataclass(frozen=True)
class PassPlan:
    """A pass with the resources that its shaders see.

    accessed: names of the buffers that the pass reads or writes, lists of tiles and indirect commands included;
    written: those that it writes.
    """

    step: Pass
    buffers: tuple[Binding, ...]
    textures: tuple[Binding, ...]
    accessed: frozenset[str]
    written: frozenset[str]

    @classmethod
    def of(cls, variant: Variant, step: Pass) -> PassPlan:
        """The plan of a pass of the variant."""
        buffers = buffer_bindings(variant, step)
        accessed = {split_ref(binding.ref)[0] for binding in buffers}
        if step.by_tile:
            accessed |= {TILE_LIST, TILE_COMMAND}
        elif step.command:
            accessed.add(step.command)
        written = {split_ref(ref)[0] for ref in step.writes} & accessed
        return cls(step, tuple(buffers), tuple(texture_bindings(variant, step)), frozenset(accessed),
                   frozenset(written))


class Barriers:
    """Says before which passes of a frame a memory barrier is due.

    One is due where a pass accesses a buffer that an earlier pass wrote, or writes one that an earlier pass accesses;
    the frame before counts as having accessed all of `buffers`.
    """

    def __init__(self, buffers: Sequence[str]):
        self._written: set[str] = set()
        self._accessed: set[str] = set(buffers)

    def due(self, planned: PassPlan) -> bool:
        """Whether a barrier comes before this pass, which is the next to run."""
        due = bool(self._written & planned.accessed or self._accessed & planned.written)
        if due:
            self._written.clear()
            self._accessed.clear()
        self._written |= planned.written
        self._accessed |= planned.accessed
        return due


@dataclass(frozen=True)
class LoopPlan:
    """A loop with those of its passes that the frame runs."""

    loop: Loop
    passes: tuple[Pass, ...]


@dataclass(frozen=True)
class FramePlan:
    """The steps that a frame runs, in order, and for each pass that it leaves out the reason."""

    steps: tuple[Pass | LoopPlan, ...]
    left_out: tuple[tuple[Pass, str], ...]


def frame_plan(fitted: Fitted, frame: FrameState) -> FramePlan:
    """The plan of a frame. Every condition of every pass is evaluated here, once."""
    out: list[tuple[Pass, str]] = []

    def running(passes: Sequence[Pass]) -> Iterator[Pass]:
        for step in passes:
            reason = left_out(step, fitted, frame)
            if reason is None:
                yield step
            else:
                out.append((step, reason))

    steps: list[Pass | LoopPlan] = []
    for step in fitted.variant.steps:
        if isinstance(step, Loop):
            steps.append(LoopPlan(step, tuple(running(step.passes))))
        else:
            steps += running((step,))
    return FramePlan(tuple(steps), tuple(out))


def as_text(fitted: Fitted, frame: FrameState | None = None) -> str:
    """The plan of a frame as text: a line for each pass, lines for its bindings, and barriers where they come.

    Without a state, the frame is the first of a scene; a method that plans its frames plans it as if the fragments had
    been counted before. A loop is shown once, with the barriers of its first iteration.
    """
    plan = frame_plan(fitted, frame or _first(fitted))
    barriers = Barriers([buffer.name for buffer in fitted.variant.buffers])
    lines: list[str] = []
    for step in plan.steps:
        inside = step.passes if isinstance(step, LoopPlan) else (step,)
        indent = ""
        if isinstance(step, LoopPlan):
            until = ", until the counting pass sees nothing" if step.loop.until_empty else ""
            lines.append(f"loop at most {step.loop.times} times{until}" if not step.loop.bands
                         else f"loop over bands by {step.loop.bands}")
            indent = "  "
        for one in inside:
            planned = PassPlan.of(fitted.variant, one)
            lines += [f"{indent}barrier"] if barriers.due(planned) else []
            lines += [indent + line for line in _lines_of(planned)]
    left = Counter((step.name, reason) for step, reason in plan.left_out)
    lines += [f"left out: {name} ({reason}{f', {times} times' if times > 1 else ''})"
              for (name, reason), times in left.items()]
    return "\n".join(lines)


def _first(fitted: Fitted) -> FrameState:
    return FrameState(fitted.plan() if isinstance(fitted.variant.method.capacity, Planned) else None)


def _lines_of(planned: PassPlan) -> Iterator[str]:
    step = planned.step
    yield f"{step.name}: {step.kind}{f' {step.shader}' if step.shader else ''}"
    for binding in planned.buffers:
        how = "write" if binding.ref in step.writes else "read"
        yield f"  buffer {binding.index}: {binding.name} ({how})"
    for binding in planned.textures:
        yield f"  texture {binding.index}: {binding.name}"
    for ref in step.into:
        yield f"  into: {ref}"
