"""Stencil routing: the fragments of a pixel go to the samples of multisample targets, in order of arrival."""

from __future__ import annotations

from dataclasses import replace

from ..spec import EMPTY, Pass, State, Stencil, Target, when
from .options import MULTISAMPLING


def routed_targets(samples: str) -> tuple[Target, ...]:
    """The multisample targets for stencil routing: 3 words per sample, for depth, colour and stencil."""
    return (Target("depths", "r32ui", samples=samples, doc="depth of the fragment in each sample"),
            Target("colours", "r32ui", samples=samples, doc="colour of the fragment in each sample"),
            Target("routing", "depth24_stencil8", samples=samples, doc="stencil that selects the next sample"))


def route(samples: str, *more_targets: str, reads: tuple[str, ...] = ()) -> tuple[Pass, ...]:
    """The passes that send the fragments of a pixel to its samples one by one, in order of arrival."""
    into = ("depths", "colours", *more_targets)
    store = Pass("store", "geometry", "methods/routing/store.frag", reads=reads, into=(*into, "routing"),
                 clears=dict.fromkeys(into, (EMPTY,)), defines={"MULTI_PASS": int(bool(more_targets))})
    return (Pass("route", "fullscreen", "methods/routing/start.frag", into=("routing",), clears={"routing": (1.0, 1)},
                 state=State(stencil=Stencil("always", "increment")), vertex="screen/triangles.vert",
                 instances=samples),
            *(replace(store, state=State(stencil=Stencil("equal", "decrement", 2), multisample=choice == "on"),
                      when=when("multisampling", choice)) for choice in MULTISAMPLING.choices))
