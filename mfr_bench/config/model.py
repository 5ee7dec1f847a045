"""What a config says, as frozen values; the annotations are the rules that `check` holds them to."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import asdict, dataclass, make_dataclass
from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal

from annotated_types import Interval, MinLen, Predicate

from ..methods.spec import Value
from ..report.figures.kind import Key
from ..report.figures.kinds import KINDS, all_keys
from ..store.columns import ARRAYS

MAX_SIDE = 16384  # pixels
MAX_OVERHANG = 2**24  # pixels: a float32 holds every corner
MAX_QUADS = 2**22  # distinct depths on the grid of 2**-23, with a free point between any two


@dataclass(frozen=True)
class Allowed:
    """The values that a field takes, in the words of an error message and of the JSON Schema."""

    text: str

    def __get_pydantic_json_schema__(self, core_schema, handler) -> dict[str, Any]:
        return handler(core_schema) | {"description": self.text}


class OneOrTwo(Allowed):
    """For a pair that may be written as the one value that both are."""

    def __get_pydantic_core_schema__(self, source, handler):
        from pydantic_core import core_schema  # only who validates pays for it
        return core_schema.no_info_before_validator_function(self._pair, handler(source))

    @staticmethod
    def _pair(value: Any) -> Any:
        if isinstance(value, (int, float)):
            return value, value
        return tuple(value) if isinstance(value, list) else value

    def __get_pydantic_json_schema__(self, core_schema, handler) -> dict[str, Any]:
        pair = handler(core_schema)
        return {"anyOf": [pair["prefixItems"][0], pair], "description": self.text}


Text = Annotated[str, MinLen(1), Allowed("text")]
Whole = Annotated[int, Interval(ge=1, le=MAX_SIDE), Allowed(f"a whole number from 1 to {MAX_SIDE}")]
Size = Annotated[tuple[Whole, Whole], Allowed(f"two whole numbers from 1 to {MAX_SIDE}")]
Share = Annotated[float, Interval(gt=0, le=1), Allowed("a number above 0, up to 1")]
Unit = Annotated[float, Interval(ge=0, le=1), Allowed("a number from 0 to 1")]
Alpha = Annotated[tuple[Unit, Unit], Predicate(lambda pair: pair[0] <= pair[1]),
                  OneOrTwo("a number from 0 to 1, or two such numbers, the lower first")]
Colours = Annotated[str, Predicate(re.compile(r"any|plane|hues-[1-9][0-9]?").fullmatch),
                    Allowed("any | plane | hues-N with N from 1 to 99")]
Samples = Annotated[int, Interval(ge=1, le=1_000_000), Allowed("a whole number from 1 to 1000000")]
Seconds = Annotated[float, Interval(gt=0, le=86400), Allowed("seconds above 0, up to 86400")]
Mebibytes = Annotated[float, Interval(gt=0, le=2**24), Allowed("MiB above 0, up to 16777216")]

KEPT = tuple(ARRAYS)  # arrays that a cell may keep

STRICT = {"extra": "forbid", "allow_inf_nan": False}  # pydantic's settings for a class below


def _plain(value: Any) -> Any:
    return [_plain(v) for v in value] if isinstance(value, tuple) else value


class _Plain:
    """Gives a dataclass its JSON form."""

    def as_dict(self) -> dict[str, Any]:
        """The fields as JSON knows them: lists instead of tuples."""
        return {name: _plain(value) for name, value in asdict(self).items()}


@dataclass(frozen=True, kw_only=True)
class Scene(_Plain):
    """A synthetic scene; docs/scenes.md describes every kind and layout.

    size: viewport, pixels. pixel_density: share of the pixels that the block or the tiles cover, or the block around
    a hairball, needle tree or temple. depth_complexity: quads over every covered pixel; with layout `random`, their
    mean over the block's pixels; with layout `mixed` and the other kinds the maximum over the pixels, whose mean is
    mean_depth (None: two fifths of it). least_depth: each pixel of a block of flat quads draws its number of
    fragments evenly from this share of depth_complexity up to all of it; None: every pixel has all. slant: most
    change of depth across a quad, share of the depth range. alpha: lowest and highest opacity. quad_size: pixels,
    layout `random` only; None means a quarter of each side of the viewport.

    What puts methods under stress: depth_at: depths lie about this one in steps of 2**depth_gap_log2, instead of all
    over the range. depth_copies: quads that share a depth; copies: whether they share their colour as well.
    odd_depth: what the quad submitted first has for a depth. alpha_order: falling, the nearest quad has the highest
    alpha; rising, the lowest. overhang: pixels by which every quad reaches beyond its place, on each side.
    """

    __pydantic_config__: ClassVar[dict] = STRICT

    kind: Literal["quads", "hairball", "needles", "temple"] = "quads"
    size: Size
    pixel_density: Share = 1.0
    depth_complexity: Annotated[int, Interval(ge=0, le=MAX_QUADS), Allowed(f"a whole number from 0 to {MAX_QUADS}")]
    mean_depth: Annotated[float, Interval(ge=1, le=MAX_QUADS), Allowed(f"a number from 1 to {MAX_QUADS}")] | None = None
    least_depth: Share | None = None
    layout: Literal["block", "tiles", "random", "mixed"] = "block"
    order: Literal["random", "front_to_back", "back_to_front"] = "random"
    slant: Annotated[float, Interval(ge=0, le=1), Allowed("a number from 0 to 1")] = 0.0
    alpha: Alpha = (0.1, 0.6)
    colours: Colours = "any"
    fragment_probability: Share = 1.0
    seed: Annotated[int, Interval(ge=0, lt=2**32), Allowed("a whole number from 0 to 4294967295")] = 1
    animate: bool = False
    quad_size: Size | None = None
    depth_at: Unit | None = None
    depth_gap_log2: Annotated[int, Interval(ge=-126, le=-1), Allowed("a whole number from -126 to -1")] = -4
    depth_copies: Whole = 1
    copies: Literal["alike", "different"] = "alike"
    odd_depth: Literal["none", "zero", "minus_zero", "one", "below", "beyond", "far_below", "far_beyond", "infinity",
                       "minus_infinity", "nan"] = "none"
    alpha_order: Literal["random", "falling", "rising"] = "random"
    overhang: Annotated[int, Interval(ge=0, le=MAX_OVERHANG), Allowed(f"pixels from 0 to {MAX_OVERHANG}")] = 0


ALLOWANCE_S = 120.0  # for a cell to compile, to be checked, and to end
LIMITS_LONG = 10  # time limits that a cell may take at most: a frame of nearly that time is drawn in each of its phases


@dataclass(frozen=True, kw_only=True)
class Measure(_Plain):
    """When a measurement is enough, and what it may take.

    repeat_images: untimed frames whose distinct images are counted; with 1 none are. counters: whether the work of
    each pass is counted, in a frame of its own. keep: arrays of a cell to be kept beside its numbers.

    time_limit_s: of a cell's frames. hard_limit_s: of everything done for a cell, which is then ended; None means
    120 s and ten time limits. memory_budget_mb: of what a method allocates, known beforehand. hard_limit_mb: of main
    memory that the process that measures takes, which is then ended; None means 80 % of what is free when the run
    starts.

    eliminate: the methods of a scene draw in rounds of one frame each, and the clearly slower leave early; their time
    limits are pooled, as wall time for all of the scene. max_error: largest error of a channel, against the image of
    all fragments, with which a method takes part; without it a method leaves only to one whose error and memory are no
    larger than its own.
    """

    __pydantic_config__: ClassVar[dict] = STRICT

    target_rel_ci: Annotated[float, Interval(gt=0, lt=1), Allowed("a number between 0 and 1")] = 0.01
    min_samples: Samples = 10
    max_samples: Samples = 1000
    time_limit_s: Seconds = 10.0
    repeat_images: Samples = 1
    memory_budget_mb: Mebibytes = 3072.0
    counters: bool = False
    keep: Annotated[tuple[Literal[KEPT], ...], Allowed(f"a list of {', '.join(KEPT)}")] = ()
    hard_limit_s: Seconds | None = None
    hard_limit_mb: Mebibytes | None = None
    eliminate: bool = False
    max_error: Unit | None = None

    def as_dict(self) -> dict[str, Any]:
        """The fields; keys of elimination are left out at their defaults, so that older records stay valid."""
        return {name: value for name, value in super().as_dict().items()
                if name not in ("eliminate", "max_error") or value}

    @property
    def longest_s(self) -> float:
        """Seconds after which a cell is ended, whatever it does."""
        return self.hard_limit_s or ALLOWANCE_S + LIMITS_LONG * self.time_limit_s


def _rule(key: Key) -> Any:
    """The annotation of a key that kinds of figures declare."""
    if isinstance(key.takes, tuple):
        return Literal[key.takes] if key.default in key.takes else Literal[key.takes] | None
    return {"text": Text | None, "flag": bool,
            "texts": Annotated[tuple[Text, ...], Allowed(f"a list of {key.of}")]}[key.takes]


Figure = make_dataclass(
    "Figure", [("kind", Literal[tuple(KINDS)]), ("x", Text), ("y", Text, "time_ms"),
               *((key.name, _rule(key), key.default) for key in all_keys())],
    bases=(_Plain,), frozen=True, kw_only=True, namespace={
        "__module__": __name__, "__pydantic_config__": STRICT,
        "__doc__": "One figure; x and y are columns of results.csv, parameters or axes. The kinds are: "
                   + "; ".join(f"`{name}`: {kind.meaning}" for name, kind in KINDS.items()) + "."})


@dataclass(frozen=True, kw_only=True)
class Source(_Plain):
    """Where an experiment comes from, what stands for its scene, and which quantities of results/reference it has.

    readings: how a text that leaves something open was read, and what differs from the paper; a sentence each.
    """

    __pydantic_config__: ClassVar[dict] = STRICT

    paper: Text | None = None
    figure: Text | None = None
    stand_in: Text | None = None
    prints: Annotated[tuple[Text, ...], Allowed("a list of quantities of results/reference")] = ()
    readings: Annotated[tuple[Text, ...], Allowed("a list of sentences")] = ()


@dataclass(frozen=True)
class MethodEntry:
    """A line of `methods:`. `params` holds only what the entry itself fixes."""

    id: str
    label: str
    params: Mapping[str, Value]


@dataclass(frozen=True)
class Experiment:
    """A checked config. `sweep` and `zip` hold the values of each axis by key; `source` what it says of Source."""

    name: str
    title: str
    source: Mapping[str, Any]
    scene: Scene
    params: Mapping[str, Value]
    methods: tuple[MethodEntry, ...]
    sweep: Mapping[str, tuple]
    zip: Mapping[str, tuple]
    measure: Measure
    figures: tuple[Figure, ...]
    path: Path
