"""How each method stands on each device: its ratio to the fastest and its rank there, with intervals.

Times are medians with intervals. A ratio of two has the interval that the two give together (as `stats.ratio_interval`
has it, from the ends that the records state), and over several places the geometric mean with its own.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

from .digest import NUMBERS
from .reading import Experiment

if TYPE_CHECKING:
    import numpy as np

MOST_DEVICES = 12  # that are shown one by one; of more, how they spread
LOW, MIDDLE, HIGH = (NUMBERS.index(name) for name in ("time_ms_low", "time_ms", "time_ms_high"))


@dataclass(frozen=True)
class Standing:
    """Methods by device, over all places; NaN where a device did not measure a method.

    ratio: (devices, entries, 3), time over that of the device's fastest entry, between the ends of its interval.
    rank: (devices, entries, 3), 1 the fastest; its ends count the entries that are surely faster, and those that are
    not surely slower: beyond the interval of the ratio and the noise floor.
    """

    experiment: Experiment
    allowed: np.ndarray | None = None  # (devices, places, entries): what counts; all that was measured unless given

    @cached_property
    def _logs(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Logarithms of the medians, and their distances from the ends: (devices, places, entries) each."""
        import numpy as np

        numbers = self.experiment.numbers
        with np.errstate(invalid="ignore", divide="ignore"):
            middle = np.log(np.where(numbers[..., MIDDLE] > 0, numbers[..., MIDDLE], np.nan))
            down, up = middle - np.log(numbers[..., LOW]), np.log(numbers[..., HIGH]) - middle
        if self.allowed is not None:
            middle = np.where(self.allowed, middle, np.nan)
        return middle, down, up

    @cached_property
    def _both(self) -> tuple[np.ndarray, np.ndarray]:
        import numpy as np

        ratios, ranks = zip(*map(self._on, range(len(self.experiment.devices))), strict=True)
        return np.stack(ratios), np.stack(ranks)

    @property
    def ratio(self) -> np.ndarray:
        """float64 (devices, entries, 3), as the class says."""
        return self._both[0]

    @property
    def rank(self) -> np.ndarray:
        """float64 (devices, entries, 3), as the class says."""
        return self._both[1]

    def _on(self, number: int) -> tuple[np.ndarray, np.ndarray]:
        """Ratio and rank of every entry on one device: by the places that it shares with each other entry."""
        import numpy as np

        middle, down, up = (part[number] for part in self._logs)  # (places, entries)
        there = np.isfinite(middle)
        shared = there.T.astype(float) @ there  # how many places two entries share
        with np.errstate(invalid="ignore", divide="ignore"):
            filled = np.where(there, middle, 0.0)
            mean = (filled.T @ there - there.T @ filled) / shared  # log of the ratio of row to column
            below = np.sqrt(_squares(down, there).T @ there + there.T @ _squares(up, there)) / shared
            above = np.sqrt(_squares(up, there).T @ there + there.T @ _squares(down, there)) / shared
            noise = np.log1p(self.experiment.devices[number].noise)
            slower = (mean - below > 0) & (mean > noise)
            faster = (mean + above < 0) & (mean < -noise)
        measured = there.any(axis=0)
        rank = np.stack([1.0 + slower.sum(axis=1), 1.0 + (mean > 0).sum(axis=1),
                         shared.astype(bool).sum(axis=1) - faster.sum(axis=1)], axis=1)
        rank[~measured] = np.nan
        best = int(np.nanargmin(rank[:, 1])) if measured.any() else 0
        least, usual, most = (part[:, best] for part in (mean - below, mean, mean + above))
        ratio = np.exp(np.stack([least, usual, most], axis=1))
        ratio[best] = 1.0 if measured.any() else np.nan
        return ratio, rank

    def by_entry(self) -> list[tuple[str, Mapping[str, float]]]:
        """Each entry that some device measured, the least median ratio first, with its statistics over devices."""
        import numpy as np

        rows = []
        for i, entry in enumerate(self.experiment.entries):
            ratios, ranks = self.ratio[:, i, 1], self.rank[:, i, 1]
            known = np.isfinite(ratios)
            if known.any():
                worst = int(np.nanargmax(ratios))
                rows.append((entry, {"devices": int(known.sum()), "first": int((ranks == 1).sum()),
                                     "rank": float(np.nanmedian(ranks)), "rank_low": float(np.nanmin(ranks)),
                                     "rank_high": float(np.nanmax(ranks)), "ratio": float(np.nanmedian(ratios)),
                                     "worst_ratio": float(ratios[worst]), "worst_on": worst}))
        return sorted(rows, key=lambda row: (-row[1]["devices"], row[1]["ratio"]))


def _squares(distances: np.ndarray, there: np.ndarray) -> np.ndarray:
    """Squares of distances; infinite where a time has no interval, so that nothing is told apart by it."""
    import numpy as np

    return np.where(there, np.where(np.isfinite(distances), distances**2, 1e300), 0.0)
