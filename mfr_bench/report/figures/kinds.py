"""The kinds of figures, by the name that a config gives them.

`build` returns the matplotlib Figure of one entry of the config's `figures`:

    kind     stacked_passes | bars | lines | maps | histogram | breaking | pareto | heat | work
    x, y     a swept key or column (see `data.Point.at`), a measure (see `data.MEASURES`)
    log      x | y | xy; log_base 2, 5 or 10
    panels   a swept key or column: one panel for each of its values
    methods  labels or ids: only these series
    floor    true: the floor as a dashed line
    bound    true: the error that rounding explains, as a dotted line
    passes   the time of the first of these passes that a method has, instead of y
    rows     of heat: a swept key, one row for each of its values
    gain_of  what a parameter gains over its first value, instead of y
    fit      linear | quadratic: a polynomial through each line
    printed  the paper's numbers of this quantity, as marks
    title, x_label, y_label
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING

from ...errors import StoreError, nearest
from ...store.columns import ARRAYS
from .. import data
from ..data import Result
from .bars import bars, stacked_passes
from .breaking import breaking
from .heat import BEST, heat
from .histogram import histogram
from .lines import lines
from .maps import maps
from .pareto import pareto
from .series import Options
from .sheet import styled
from .work import work

if TYPE_CHECKING:
    from matplotlib.figure import Figure

KINDS: Mapping[str, Callable[[Result, Options], Figure]] = {
    "stacked_passes": stacked_passes, "bars": bars, "lines": lines, "maps": maps, "histogram": histogram,
    "breaking": breaking, "pareto": pareto, "heat": heat, "work": work}


def build(result: Result, options: Options) -> Figure:
    """The Figure of one entry of the config's `figures`. Raises StoreError for an option that cannot be drawn."""
    where = f"{result.folder.path}: figure"
    kind = options.get("kind")
    if kind not in KINDS:
        raise StoreError(f"{where}: kind: {kind!r} unknown; allowed: {', '.join(KINDS)}{nearest(str(kind), KINDS)}")
    y = str(options.get("y") or "time_ms")
    if kind != "heat" or y != BEST:
        y = _array(y, where) if kind == "maps" else data.drawn_measure(y, where)
    if not options.get("x"):
        raise StoreError(f"{where}: x: missing; allowed: a swept key such as k, or a column of results.csv")
    if kind == "heat" and not options.get("rows"):
        raise StoreError(f"{where}: rows: missing; allowed: a swept key, or a column of results.csv")
    with styled():
        return KINDS[kind](result, {**options, "y": y, "zip": tuple(result.manifest.get("zip") or ())})


def _array(name: str, where: str) -> str:
    if name not in ARRAYS:
        raise StoreError(f"{where}: y: {name!r} is no kept array; allowed: {', '.join(ARRAYS)}{nearest(name, ARRAYS)}")
    return name
