"""Passes that count fragments: for the method, or outside timed frames to see what it stores."""

from __future__ import annotations

from dataclasses import replace

from ..spec import Pass, State


def count() -> Pass:
    """The geometry pass that counts the fragments of each pixel, and their total by an occlusion query."""
    return Pass("count", "geometry", "common/count.frag", writes=("counter",), counts=True)


SHADED, STORED = "shaded_fragments", "stored_fragments"  # what `Pass.probes` may count


def count_stored(step: Pass, hazards: bool, room: str = "keep") -> Pass:
    """The pass that counts the fragments which the resolve `step` finds, at most `room` of each list.

    With `hazards` it looks up each generated fragment in the storage of its pixel instead, so that duplicated and torn
    fragments do not count.
    """
    kind, shader = ("geometry", "common/found.frag") if hazards else ("fullscreen", "common/stored.frag")
    return replace(step, kind=kind, shader=shader, resolver=None, into=(), state=State(), probes=STORED, expand=None,
                   defines={**step.defines, "HOLDS": room})
