"""Buffers and targets that a method allocates, with their sizes as formulas."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

from ...effects import MSAA
from .params import When

EMPTY = 0xFFFFFFFF  # no fragment, no next node: above the bits of every depth in [0, 1]
SAMPLE_FEATURES: Mapping[str, int] = {f"samples_{count}": count for count in (4, 8, 16, 32)}  # of multisample targets
MSAA_FEATURES: Mapping[int, str] = {count: f"msaa_{count}" for count in MSAA if count > 1}  # of rasterizing a scene
SAMPLE_STENCIL = "sample_stencil"  # the feature of testing each sample's stencil with multisampling off
FRAMEBUFFER_FETCH = "framebuffer_fetch"  # the feature of reading the pixel that a fragment is drawn into, in order
NEAREST_33 = "nearest_33"  # the feature of picking a list's nearest 33 and sorting them in registers: docs/drivers.md
# FRAGMENT is a depth with its payload, PAYLOAD a payload; formulas count them with the plain payload of one word.
ELEMENT_WORDS: Mapping[str, int] = {"uint": 1, "uvec2": 2, "uint64_t": 2, "int64_t": 2, "vec4": 4, "FRAGMENT": 2,
                                    "PAYLOAD": 1}
PAYLOAD_WORDS: Mapping[str, int] = {"rgba8": 1, "rgba16f": 2, "two_channel": 1}


@dataclass(frozen=True)
class Buffer:
    """A shader storage buffer of 32-bit words.

    `words` is its length as a formula, in which `capacity` is the method's. The clear pass gives the GLSL value `clear`
    to every element; with `clear_heads` only to the first P, or to the first P times the parameter that it names in
    GLSL. The iterations of a loop use the copies in turn. `doc` says what the buffer contains; the prelude prints it
    beside the declaration, and docs/methods.md lists it.
    """

    name: str
    words: str
    type: str = "uint"  # GLSL element type, a key of ELEMENT_WORDS
    clear: str | None = None
    clear_heads: bool | str = False
    coherent: bool = False
    copies: int = 1
    when: When | None = None
    doc: str = ""

    @property
    def element_words(self) -> int:
        return ELEMENT_WORDS[self.type]

    @property
    def continues(self) -> bool:
        """Whether the clear pass makes the buffer's values from those of the frame before; the first frame's are 0."""
        return bool(self.clear and re.search(rf"\b{self.name}\[", self.clear))


Format = Literal["r8", "rg8", "rgba8", "r16", "rgba16f", "r32f", "rg32f", "rgba32f", "r32ui", "rg32ui", "depth16",
                 "depth32f", "depth24_stencil8"]
FORMAT_WORDS: Mapping[str, float] = {"r8": 0.25, "rg8": 0.5, "rgba8": 1, "r16": 0.5, "rgba16f": 2, "r32f": 1,
                                     "rg32f": 2, "rgba32f": 4, "r32ui": 1, "rg32ui": 2, "depth16": 0.5, "depth32f": 1,
                                     "depth24_stencil8": 1}


@dataclass(frozen=True)
class Target:
    """A texture of the viewport's size that passes draw into. The iterations of a loop use the copies in turn.

    `samples` is the formula of the samples of a multisample texture, `layers` that of the layers of an array texture,
    which are drawn into at once, at successive locations. With `on_demand` it is allocated by the first frame that
    draws into it. `doc` says what the texture contains, as for a buffer.
    """

    name: str
    format: Format
    copies: int = 1
    when: When | None = None
    samples: str | None = None
    layers: str | None = None
    on_demand: bool = False
    doc: str = ""

    @property
    def attaches(self) -> Literal["colour", "depth"]:
        """The attachment of a framebuffer that takes it; a stencil comes with a depth."""
        return "depth" if self.format.startswith("depth") else "colour"


COMMAND_WORDS = 5  # of an indirect draw in a buffer of several: vertices, instances, the first of both, and one unused
TILE_LIST, TILE_COMMAND = "tile_list", "tile_command"  # of passes that go by tile: which, and the indirect draw of them
DISPATCH_OFFSET = 16  # bytes of TILE_COMMAND before the indirect dispatch: the four words of the draw
LISTED = 16  # pixels, side of the tiles that are listed
TILE_POINTS = f"points_{LISTED}"  # the feature of drawing points as large as a tile
IMAGE = "image"  # the frame's result: RGBA32F, premultiplied, shared by all methods, in no method's memory
