"""Passes, the steps that the papers time, with their fixed-function state; and loops of them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any, Literal

from .capacity import Plan
from .params import Params, When
from .resources import Buffer, Target

SHARED_RESOLVERS = "common/resolve_"  # files that all methods share; each adds fragment by fragment


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


@dataclass(frozen=True)
class Pass:
    """One step that the papers time.

    `shader` is the fragment (geometry, fullscreen) or compute entry point below shaders/. `into` names
    the targets drawn into, in location order (a depth format attaches as depth); none means that the
    pass only writes buffers, and its colour writes are masked. `reads` and `writes` name buffers, or
    targets as textures; in a loop `.current` and `.previous` tell the copies apart. The runner puts a
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
    # Of the buffers that it reads, those that it reads through a texture of the same memory where the device has one so
    # large; of these it sees NAME_at(i) as NAME[i]. A resolve does so with whatever it reads for each fragment.
    texels: tuple[str, ...] = ()
    # Of these, those that it reads two elements at a time, where they have two words: NAME_pair_at(i) in place of
    # NAME_at(i) is a uvec4 of NAME[2i] and NAME[2i+1].
    pairs: tuple[str, ...] = ()
    fetched: tuple[str, ...] = ()  # of `into`, the targets whose pixel the shader reads as the fragment before left it
    keeps: tuple[str, ...] = ()  # of `into`, the targets that are attached and not drawn into, once they are cleared
    totals: str | None = None  # a buffer whose words, as the pass leaves them, add up to the capacity
    decides: bool = False  # afterwards the host sets k and the capacity, as the method's `Decided` says
    fetch: str | None = None  # the include by which a resolve reads fragments
    resolver: str | None = None  # the include by which a resolve makes them one colour
    vertex: str | None = None  # another vertex shader than the kind's own
    when: When | None = None
    needed: str | None = None  # a formula; the pass is left out where it gives 0
    runs_in: Callable[[Plan], bool] | None = None  # of a planned method: whether a frame of this plan needs the pass
    region: bool = False  # draws and clears only what bounds the geometry, or the loop's band; a clear: all but that
    whole: str = ""  # why it covers the viewport although the method has `touched`, which limits the others
    by_tile: bool = False  # only the tiles of TILE_LIST, as TILE_COMMAND has it on the device: a point or a group each
    # The buffer of indirect draws: a full-screen pass is drawn by the one of its define CLASS, a geometry pass by all,
    # one for each primitive, in order; every primitive then has the number 0.
    command: str | None = None
    opaque_first: bool = False  # geometry: draws opaque primitives, then the others, which leave the depth as it is
    corner: bool = False  # geometry: draws only the first pixel of what bounds the geometry
    static: bool | None = None  # False: only in a scene's first frame, for all; True: only in frames after that
    counts_for_plan: bool = False  # count the samples that pass, for the plan of the next frame
    atomics: tuple[str, ...] = ()  # of the written buffers of one word, those that the shader sees as atomic counters
    probes: str | None = None  # the counter outside the method's memory that it fills; runs where that is asked for
    expand: Callable[[Pass, Params], tuple[Pass, ...]] | None = None
    targets: tuple[Target, ...] = ()
    buffers: tuple[Buffer, ...] = ()

    def only(self, where: When) -> Pass:
        """The pass as it is, but that it runs only if this condition holds as well."""
        return replace(self, when=where & self.when if self.when else where)

    @property
    def hands_on(self) -> bool:
        """Whether it makes a pixel of the image of the pixel's fragments one by one, nearest first."""
        shared = (self.resolver or "").startswith(SHARED_RESOLVERS)
        return shared and self.state.blend is None and self.defines.get("LISTS") == 1


@dataclass(frozen=True)
class Loop:
    """Passes repeated at most `times` (a formula); with `until_empty`, until the counting pass sees none.

    `bands`: repeated instead for each band of the region whose elements the budget holds; its name is that of the
    buffer with the fragments of each `methods.shared.bands.SEGMENT` pixels of a row. Passes with `region` keep to the
    band.
    """

    passes: tuple[Pass, ...]
    times: str = "1"
    until_empty: bool = True
    bands: str | None = None
