"""The messages between the process that measures and its parent. Plain values, which pickle."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from ..plan import Limits
from ..store.journal import Partial
from .jobs import Job

# --- parent to worker ----------------------------------------------------------------------------


@dataclass(frozen=True)
class Needs:
    """The first message: what the run needs of the device, which is then tried and answered for by `Ready`.

    features: those that its cells depend on; None: all. cells: how many there are, as far as that is known.
    """

    features: frozenset[str] | None = None
    cells: int = 0


@dataclass(frozen=True)
class Group:
    """Measure these cells of one scene. `partials`: samples by key that earlier processes took.

    One cell of each set of keys in `replicates` is sampled twice, for the noise floor. most_bytes: main memory that the
    process may take. until: when `Stop` will be sent, on the monotonic clock, which is the same in every process. then:
    the cells of the group that is likely to follow.
    """

    jobs: tuple[Job, ...]
    partials: Mapping[str, Partial] = field(default_factory=dict)
    replicates: tuple[frozenset[str], ...] = ()
    most_bytes: float = float("inf")
    until: float = float("inf")
    then: tuple[Job, ...] = ()


@dataclass(frozen=True)
class Calibrate:
    """Time the work of known size again; the answer is `Calibrated`."""


@dataclass(frozen=True)
class SelfTest:
    """Run the self-tests of the device; the answer is `SelfTested`."""


@dataclass(frozen=True)
class Stop:
    """End between two frames; cells with samples enough are finished."""


@dataclass(frozen=True)
class Go:
    """Everything that was sent until `Synced` is taken in, and on its way to the disk."""


# Phases in which the harness compares images, waits for a quiet machine, and does what comes between two steps of a
# cell: keeps samples, looks at the reference frame, stops other processes. None is time of the method.
CHECK, WAIT, BETWEEN = "check", "wait", "between two steps"

# --- worker to parent ----------------------------------------------------------------------------


@dataclass(frozen=True)
class Ready:
    """The device is open, and its timer chosen.

    calibration: empty where the timer was given; else it took calibrated_s seconds. bound_threads, instructions: of
    `Device`.
    """

    device: Mapping[str, str]
    limits: Limits
    timer: str
    calibration: Mapping[str, Any]
    bound_threads: int = 0
    calibrated_s: float = 0.0
    instructions: str | None = None


@dataclass(frozen=True)
class Calibrated:
    """`Ready.calibration` once more."""

    calibration: Mapping[str, Any]


@dataclass(frozen=True)
class SelfTested:
    """What each self-test has seen that fails and without which any result may be wrong, by its name."""

    failed: Mapping[str, str]


@dataclass(frozen=True)
class Failed:
    """There is no device, and why. unknown: there are others than the one that was asked for."""

    reason: str
    unknown: bool = False


@dataclass(frozen=True)
class Begun:
    """The worker begins a phase of the cell with this key; None: of all cells of the group."""

    key: str | None
    phase: str


@dataclass(frozen=True)
class Sampled:
    """A batch of a cell's frame times, and of its passes' times, in ms."""

    key: str
    samples_ms: tuple[float, ...] = ()
    passes: Mapping[str, tuple[float, ...]] = field(default_factory=dict)


@dataclass(frozen=True)
class Synced:
    """The worker waits for `Go`: what it sent should be taken in first, and no time is taken meanwhile."""


@dataclass(frozen=True)
class Finished:
    """A cell's row, but for what the parent knows better. `details`: warm-ups, samples, passes, buffers.

    `arrays`: those that the cell keeps, as the contents of a .npz. `failed_trials`: the self-tests that the device
    fails, for which the cell is unsupported.
    """

    key: str
    status: str
    reason: str | None
    values: Mapping[str, Any]
    details: Mapping[str, Any] = field(default_factory=dict)
    arrays: bytes = b""
    noise_floor_rel: float | None = None
    failed_trials: tuple[str, ...] = ()


@dataclass(frozen=True)
class Ended:
    """The group is over. `split_s`: where the time went since the last group.

    beside_s: processor time of the process beside the device, by kind of work.
    """

    split_s: Mapping[str, float]
    interrupted: bool = False
    beside_s: Mapping[str, float] = field(default_factory=dict)
