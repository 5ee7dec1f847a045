"""Tells in which cells the device was slower while they were sampled, by the reference frame around their turns."""

from __future__ import annotations

from collections.abc import Sequence
from statistics import median

from ..stats import SLOWER_REFERENCE
from .sides import Entry

MOST_OFF = 0.5  # share of the cells, up to which a slower reference tells of these and not of a whole run


def steady(pairs: Sequence[tuple[Entry, Entry]]) -> list[bool | None]:
    """Whether the reference frame was as fast as ever on both sides of each cell; None where that is not known.

    As fast as ever: the median of the cell's references is within 1.2 times the least of all. A run in which most are
    beyond that was slower as a whole, which tells nothing of its cells.
    """
    medians = [[_reference_ms(entry) for entry in pair] for pair in pairs]
    least = min((ms for pair in pairs for entry in pair for ms in _references(entry)), default=0.0)
    found = [None if None in both else max(both) <= SLOWER_REFERENCE * least for both in medians]
    return [None] * len(found) if found.count(False) > MOST_OFF * len(found) else found


def _references(entry: Entry) -> list[float]:
    return entry.point.cell.get("references_ms") or []


def _reference_ms(entry: Entry) -> float | None:
    references = _references(entry)
    return median(references) if references else None
