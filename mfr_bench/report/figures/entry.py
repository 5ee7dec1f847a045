"""A figure from its entry in a config.

    kind     a file of `kinds/`, which declares the keys besides these
    x, y     a swept key or column (see `data.Point.at`), a measure (see `data.MEASURES`)
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from ...errors import StoreError, nearest
from ...store.columns import ARRAYS
from .. import data
from ..data import Result
from .kinds import DRAW, KINDS
from .series import Options
from .sheet import styled

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def build(result: Result, options: Options) -> Figure:
    """The Figure of one entry of the config's `figures`. Raises StoreError for an option that cannot be drawn."""
    where = f"{result.folder.path}: figure"
    name = options.get("kind")
    if name not in KINDS:
        raise StoreError(f"{where}: kind: {name!r} unknown; allowed: {', '.join(KINDS)}{nearest(str(name), KINDS)}")
    kind = KINDS[name]
    y = str(options.get("y") or "time_ms")
    if y not in kind.other_y:
        y = _array(y, where) if kind.arrays else data.drawn_measure(y, where)
    for key, allowed in (("x", "a swept key such as k, or a column of results.csv"),
                         *((key, "a swept key, or a column of results.csv") for key in kind.needs)):
        if not options.get(key):
            raise StoreError(f"{where}: {key}: missing; allowed: {allowed}")
    with styled():
        return DRAW[name](result, {**options, "y": y, "zip": tuple(result.manifest.get("zip") or ())})


def _array(name: str, where: str) -> str:
    if name not in ARRAYS:
        raise StoreError(f"{where}: y: {name!r} is no kept array; allowed: {', '.join(ARRAYS)}{nearest(name, ARRAYS)}")
    return name
