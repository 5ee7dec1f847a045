"""The measures that a figure can show, with the labels of their axes."""

from __future__ import annotations

from ...errors import StoreError, nearest
from ...stats import Interval
from ...store.columns import COLUMNS, DERIVED, PASS_COLUMNS

NOTHING: Interval = (None, None, None)
MEASURES = {c.name: c.axis for c in (*PASS_COLUMNS, *COLUMNS, *DERIVED) if c.drawn not in ("", "place")}  # axes
IN_MIB = {"memory_bytes": "memory_mib", "memory_model_bytes": "memory_model_mib"}  # bytes are drawn as MiB


def drawn_measure(name: str, where: str) -> str:
    """The measure that `y: name` draws. Raises StoreError naming the nearest one."""
    if name not in MEASURES:
        raise StoreError(f"{where}: y: {name!r} unknown; allowed: {', '.join(MEASURES)}{nearest(name, MEASURES)}")
    return IN_MIB.get(name, name)


def column_of(measure: str) -> str:
    """The column of results.csv that a drawn measure is taken from."""
    return next((column for column, drawn in IN_MIB.items() if drawn == measure), measure)
