"""Stencil routing: the fragments of a pixel go to the samples of multisample targets, in order of arrival."""

from __future__ import annotations

from dataclasses import replace

from ..spec import EMPTY, Buffer, Pass, State, Stencil, Target, when
from .options import MULTISAMPLING
from .resolving import resolve

# Resources of several passes of routing: the origin of each sample's fragment, and the fragments of all passes.
ARRIVALS = Target("arrivals", "r32ui", doc="primitive whose fragment each sample took")
COLLECTED = Buffer("counter", "P", clear="0u", doc="fragments collected in each pixel")
RESUME = Buffer("resume", "P", clear="0u", doc="first primitive not captured yet; EMPTY if all are")
IN_ORDER = Buffer("nodes", "2*n*P", type="uvec2", doc="fragments of each pixel, in order of arrival")


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


def collected(samples: str, most: str) -> tuple[Pass, ...]:
    """One pass of several: the next fragments of a pixel, appended to its array of at most `most`."""
    return (*route(samples, "arrivals", reads=("resume",)),
            Pass("collect", "fullscreen", "methods/routing/collect.frag", reads=("depths", "colours", "arrivals"),
                 writes=("counter", "resume", "nodes"), defines={"SAMPLES": samples, "SLOTS": most}, counts=True))


def resolve_collected(most: str) -> Pass:
    """The resolve of the array that the passes have filled."""
    return resolve("counter", "nodes", fetch="methods/array/fetch.glsl", texels=("nodes",), defines={"SLOTS": most})
