"""What a cell is measured with: the method's entry of its config, and the settings of the measurement.

Apart from the rest of a config, since the process that measures needs no kinds of figures.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Annotated, Any, ClassVar, Literal

from annotated_types import Interval

from ..methods.spec import Value
from ..scene.spec.values import STRICT, Allowed, Unit, plain
from ..store.columns import ARRAYS

Samples = Annotated[int, Interval(ge=1, le=1_000_000), Allowed("a whole number from 1 to 1000000")]
Seconds = Annotated[float, Interval(gt=0, le=86400), Allowed("seconds above 0, up to 86400")]
Mebibytes = Annotated[float, Interval(gt=0, le=2**24), Allowed("MiB above 0, up to 16777216")]

KEPT = tuple(ARRAYS)  # arrays that a cell may keep
OF_IMAGES = ("image", "error", "loss")  # those of its last image
ALLOWANCE_S = 120.0  # for a cell to compile, to be checked, and to end
LIMITS_LONG = 10  # time limits that a cell may take at most: a frame of nearly that time is drawn in each of its phases


class Plain:
    """Gives a dataclass its JSON form."""

    def as_dict(self) -> dict[str, Any]:
        """The fields as JSON knows them: lists instead of tuples."""
        return {name: plain(value) for name, value in asdict(self).items()}


@dataclass(frozen=True, kw_only=True)
class Measure(Plain):
    """The settings that say when a measurement is enough, and what it may take.

    repeat_images: untimed frames whose distinct images are counted; with 1 none are. counters: whether the work of
    each pass is counted, in a frame of its own. keep: arrays of a cell to store with its numbers.

    time_limit_s: of a cell's frames. hard_limit_s: of everything done for a cell, which is then ended; None means
    120 s and ten time limits. memory_budget_mb: of what a method allocates, known beforehand. hard_limit_mb: of main
    memory that the process that measures takes, which is then ended; None means 80 % of what is free when the run
    starts.

    wait_s: what a run may spend, beside a tenth of the time of its samples, to wait while the device is slower than it
    was, and to sample again what was sampled meanwhile.

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
    wait_s: Annotated[float, Interval(ge=0, le=3600), Allowed("seconds from 0 to 3600")] = 0.0
    eliminate: bool = False
    max_error: Unit | None = None

    def as_dict(self) -> dict[str, Any]:
        """The fields; keys that came later are left out at their defaults, so that older records stay valid."""
        return {name: value for name, value in super().as_dict().items()
                if name not in ("wait_s", "eliminate", "max_error") or value}

    @property
    def keeps_image(self) -> bool:
        """Whether an array of the last image is kept."""
        return bool(set(OF_IMAGES).intersection(self.keep))

    @property
    def single(self) -> bool:
        """Whether one sample is all that is asked for: images are what counts, and no time has an interval."""
        return self.max_samples == 1

    @property
    def longest_s(self) -> float:
        """Seconds after which a cell is ended, whatever it does."""
        return self.hard_limit_s or ALLOWANCE_S + LIMITS_LONG * self.time_limit_s


@dataclass(frozen=True)
class MethodEntry:
    """A line of `methods:`. `params` has only what the entry itself fixes."""

    id: str
    label: str
    params: Mapping[str, Value]
