"""Tells in which cells the device was slower while they were sampled, by the reference frame around their turns.

A reference of a fraction of a millisecond fits between the slices of time that other processes take from longer frames.
So turns during which it was as fast as ever tell how much slower a cell may be without its showing.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import groupby
from operator import itemgetter
from statistics import median

from ..stats import SLOWER_REFERENCE
from .few import Frames
from .sides import Entry

MOST_OFF = 0.5  # share of the cells, up to which a slower reference tells of these and not of a whole run
FEWEST = 3  # samples of a turn whose median is not that of a stalled frame
UNTOLD = 1.25  # times as much as the reference, at most, other frames were slowed down (1.17 was seen)


class References:
    """The reference frames of all cells of two runs.

    steady: of each cell, whether the reference was as fast as ever on both sides; None where that is not known. As fast
    as ever: the median of the cell's references is within 1.2 times the least of all. A run in which most are beyond
    that was slower as a whole, which tells nothing of its cells.
    """

    def __init__(self, pairs: Sequence[tuple[Entry, Entry]]):
        self._pairs = pairs
        self._least_ms = min((ms for pair in pairs for entry in pair for ms in _of(entry)), default=0)
        self._most_ms = SLOWER_REFERENCE * self._least_ms
        found = [None if None in (both := [_median_ms(entry) for entry in pair]) else max(both) <= self._most_ms
                 for pair in pairs]
        self.steady = [None] * len(found) if found.count(False) > MOST_OFF * len(found) else found
        self._turns = Frames(turns for pair in pairs for entry in pair if len(turns := self._medians_ms(entry)) > 1)

    def burst(self, time_ms: float) -> float | None:
        """The logarithmic distance of the slowest in a hundred steady turns from their cell; None without any."""
        return self._turns.burst(time_ms) if self._turns.count else None

    def explained(self, number: int) -> float:
        """The logarithm of how many times as long a cell that was not steady took, at most, for that reason.

        Its slowest reference on either side tells, over the least of all: that moves as much data as any frame.
        """
        slowest_ms = max(ms for entry in self._pairs[number] for ms in _of(entry))
        return math.log(UNTOLD * slowest_ms / self._least_ms)

    def _medians_ms(self, entry: Entry) -> list[float]:
        """The median of each turn during which the reference was as fast as ever."""
        references, every = _of(entry), entry.point.cell.get("samples_ms") or []
        samples = zip(references, every[max(0, len(every) - len(references)):], strict=False)  # earlier ones have none
        turns = [(reference, [ms for _, ms in turn]) for reference, turn in groupby(samples, key=itemgetter(0))]
        return [median(ms) for reference, ms in turns if len(ms) >= FEWEST and reference <= self._most_ms]


def _of(entry: Entry) -> list[float]:
    return entry.point.cell.get("references_ms") or []


def _median_ms(entry: Entry) -> float | None:
    references = _of(entry)
    return median(references) if references else None
