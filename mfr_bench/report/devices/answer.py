"""The method to take for many devices: the best on the worst device, and what is near the best on all."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

from .digest import NUMBERS
from .reading import Experiment
from .standing import MIDDLE

if TYPE_CHECKING:
    import numpy as np

WITHIN = 0.2  # of the time of each device's best


@dataclass(frozen=True)
class Limits:
    """The bounds of an answer: the column of the error, its largest value, and the largest memory; None is no limit."""

    error: str | None = None
    most_error: float | None = None
    memory_mib: float | None = None

    def keeps(self, numbers: np.ndarray) -> np.ndarray:
        """Whether each cell keeps them, as NUMBERS of it tell; one whose error or memory is not known does not."""
        kept = numbers[..., MIDDLE] > 0
        if self.error and self.most_error is not None:
            kept &= numbers[..., NUMBERS.index(self.error)] <= self.most_error
        if self.memory_mib is not None:
            kept &= numbers[..., NUMBERS.index("memory_mib")] <= self.memory_mib
        return kept

    def __str__(self) -> str:
        parts = [f"{self.error} at most {self.most_error:g}"] if self.error and self.most_error is not None else []
        parts += [f"memory at most {self.memory_mib:g} MiB"] if self.memory_mib is not None else []
        return ", ".join(parts) or "no limits"


@dataclass(frozen=True)
class Row:
    """A method that keeps the limits on every device: its worst ratio to a device's best, its longest time, and where.

    within: on how many devices it is within the share of the best.
    """

    entry: str
    method: str
    worst_ratio: float
    worst_on: str
    longest_ms: float
    longest_on: str
    within: int


@dataclass(frozen=True)
class Answer:
    """The methods that keep the limits on every device of one scene, by their worst ratio."""

    experiment: str
    place: str
    devices: Sequence[str]
    limits: Limits
    within: float
    rows: Sequence[Row]
    partly: Sequence[tuple[str, int]]  # entries that keep the limits on some devices only, and on how many

    @cached_property
    def best_on_worst(self) -> Row | None:
        """The one whose ratio to the best is least on the device where it is largest."""
        return min(self.rows, key=lambda row: row.worst_ratio, default=None)

    @cached_property
    def shortest_longest(self) -> Row | None:
        """The one whose time is least on the device where it takes longest."""
        return min(self.rows, key=lambda row: row.longest_ms, default=None)

    @property
    def near_on_all(self) -> list[Row]:
        """Those within the share of the best on every device."""
        return [row for row in self.rows if row.within == len(self.devices)]


def answers(experiments: Sequence[Experiment], limits: Limits, within: float = WITHIN) -> list[Answer]:
    """An answer for each scene that several devices measured; `experiments` were read by whole scenes."""
    found = []
    for experiment in experiments:
        for number, place in enumerate(experiment.places):
            numbers = experiment.numbers[:, number]
            there = [i for i in range(len(experiment.devices)) if (numbers[i, :, MIDDLE] > 0).any()]
            if len(there) > 1:
                found.append(_answer(experiment, place, there, numbers[there], limits, within))
    return found


def _answer(experiment: Experiment, place: str, there: Sequence[int], numbers: np.ndarray, limits: Limits,
            within: float) -> Answer:
    import numpy as np

    kept = limits.keeps(numbers)  # (devices, entries)
    times = np.where(kept, numbers[..., MIDDLE], np.nan)
    names = [experiment.devices[i].name for i in there]
    best = np.array([np.nan if np.isnan(own).all() else np.nanmin(own) for own in times])
    ratios = times / best[:, None]
    rows = [_row(experiment, entry, names, ratios[:, i], times[:, i], within)
            for i, entry in enumerate(experiment.entries) if kept[:, i].all()]
    partly = [(entry, int(kept[:, i].sum())) for i, entry in enumerate(experiment.entries)
              if kept[:, i].any() and not kept[:, i].all()]
    return Answer(experiment.name, place, names, limits, within, sorted(rows, key=lambda row: row.worst_ratio), partly)


def _row(experiment: Experiment, entry: str, names: Sequence[str], ratios: Any, times: Any, within: float) -> Row:
    worst, longest = int(ratios.argmax()), int(times.argmax())
    return Row(entry, experiment.method(entry), float(ratios[worst]), names[worst], float(times[longest]),
               names[longest], int((ratios <= 1 + within).sum()))
