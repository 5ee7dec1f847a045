"""The ways in which a method learns for how many fragments it needs room: grown, counted, decided or planned."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from .params import Params
from .scene_stats import SceneStats


@dataclass(frozen=True)
class Grown:
    """Capacity that starts at `start` elements and doubles whenever the counter, read after a frame, has passed it.

    `counter` names the one-word buffer that counts what the frame asked for, `wanted` by its formula; the frame is
    then redone.
    """

    start: str
    counter: str
    wanted: str = "F"


# The words, in addition to those of its formula, of a method whose cells come from a counter.
SPARE_CELLS = ("the counter, one word per frame, and the spare cells of a capacity that is doubled until the frame "
               "fits, where the formula counts those in use")


@dataclass(frozen=True)
class Counted:
    """Capacity known inside the frame: what the pass that `counts` has counted by an occlusion query, or `totals`.

    `elements` is the same as a formula of the scene's stats.
    """

    elements: str = "F"


@dataclass(frozen=True)
class Choice:
    """The values that the host sets inside a frame: fragments kept per pixel, and elements for all that are kept."""

    k: int
    capacity: int


Rule = Callable[[Sequence[int], int, int, Params], Choice]


@dataclass(frozen=True)
class Decided:
    """k and the capacity set by the host inside the frame, after the pass that `decides`.

    `reads` names the buffer that the pass has written: pixels with 1, 2, … fragments, deeper ones in the last place.
    `rule` gives the choice from it, the fragments counted, the pixels of the viewport and the parameters, of which
    `budget` names that of the most MiB; `beside` are the bytes that a frame of default options takes beside those which
    the rule counts. Later passes see the chosen k as K.
    """

    reads: str
    rule: Rule
    budget: str
    beside: int = 0


@dataclass(frozen=True)
class Known:
    """The facts that a host knows before it draws a frame: its geometry, and what it counted in the frame before."""

    layers: int  # most fragments that a pixel can have by the geometry
    area: int  # pixels of the rectangle that bounds the geometry on the screen
    pixels: int  # of the viewport
    fragments: int | None  # of the frame before; None where there was none
    room: int | None = None  # elements that the budget allows; None: any number
    reach: int | None = None  # most fragments that the geometry can have; None: every layer in every pixel
    filled: bool = False  # every primitive has one fragment in each pixel of the rectangle
    deepest: int | None = None  # most fragments of a pixel in the frame before; None where that is not known
    fetches: bool = False  # the device lets a shader read the pixel that a fragment is drawn into
    opaque: float = 0.0  # share of the primitives that hide what is behind them, as a depth test finds it
    draws_in_parts: bool = False  # opaque primitives can be drawn without the others
    expected: int = 0  # fragments of all primitives by their areas, about as many as a frame that stores all would have

    @classmethod
    def of(cls, stats: SceneStats, fragments: int | None, room: int | None, deepest: int | None = None,
           fetches: bool = False) -> Known:
        """Knowledge of a scene before a frame is drawn, from the statistics of its geometry."""
        area = stats.P if stats.area is None else stats.area
        filled = stats.flat and not stats.rejects and stats.reach == stats.primitives * area
        return cls(stats.most_layers, area, stats.P, fragments, room, stats.reach, filled, deepest, fetches,
                   stats.opaque_primitives / max(1, stats.primitives) if stats.forward else 0.0,
                   stats.draws_in_parts, stats.expected)


@dataclass(frozen=True)
class Plan:
    """The plan of a frame: which passes run, and room for how many elements; None: counted within the frame.

    `banded`: the budget may not hold all elements at once, so that loops over bands run. `cut_off`: what lies behind a
    depth that an earlier pass finds for each pixel is left out. `finds_deepest`: the frame leaves the fragments of its
    deepest pixel. `guessed`: the room of a pixel is a guess; a frame with a deeper one leaves that in the same place,
    and is drawn again. `in_front`: opaque primitives are drawn first, and what they hide is left out.
    """

    path: str
    known: Known
    capacity: int | None = None
    banded: bool = False
    cut_off: bool = False
    finds_deepest: bool = False
    guessed: bool = False
    in_front: bool = False


@dataclass(frozen=True)
class Planned:
    """The passes and the capacity of each frame are planned by the host before it, by `rule`.

    The passes that `runs_in` lets run have to be right whatever the frame before had. `budget` names the parameter
    that holds the most MiB, 0 for any number; a band then has at most `least` elements, a formula. `deepest` names the
    buffer of one word in which a frame leaves the fragments of its deepest pixel.
    """

    rule: Callable[[Known, Params], Plan]
    budget: str | None = None
    least: str = "F"
    deepest: str | None = None
