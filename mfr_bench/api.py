"""The interface for other programs and notebooks: results as data frames, and a plot of them (docs/api.md)."""

from __future__ import annotations

import os
import warnings
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import matplotlib.axes
    import pandas as pd

Path = str | os.PathLike[str]


@dataclass(frozen=True)
class Results:
    """All results at or below some folders.

    `cells`: a row for each cell, with the columns of results.csv; each swept key is a column of its own,
    `point.<key>`. `passes`: a row for each cell and pass. `samples`: a row for each timed frame, `key` and `time_ms`.
    `units`, `meanings` in the `.attrs` of each: by column. `manifests`: by experiment, what the runs say of themselves;
    of several results of one experiment the last.
    """

    cells: pd.DataFrame
    passes: pd.DataFrame
    samples: pd.DataFrame
    manifests: Mapping[str, Mapping[str, Any]]


class DamagedWarning(UserWarning):
    """A file of results was damaged, and is not among what was loaded."""


def load(*folders: Path) -> Results:
    """The results at or below folders, in the order of their paths. Raises UsageError where there are none.

    A folder that 'mfr-bench table --parquet' wrote is read as it is: nothing below it counts.

    What was not measured is missing (`<NA>` or NaN), never 0. Times are in ms, memory in bytes, as `.attrs` says.
    Warns with DamagedWarning of each file that cannot be used. Raises TypeError where an argument is no path.
    Raises UsageError as well where a hand or another program put a value of another type into a cell.
    """
    from pathlib import Path as Folder

    from .parquet import FIRST

    for folder in folders:
        if not isinstance(folder, str | os.PathLike):
            raise TypeError(f"load: {folder!r} is no folder; allowed: paths as str or os.PathLike, each an argument of "
                            "its own")
    places = [Folder(folder) for folder in folders]
    parts = [_load_parquet(place) for place in places if (place / FIRST).is_file()]
    measured = [place for place in places if not (place / FIRST).is_file()]
    if measured or not parts:
        parts.append(_load_results(measured))
    return parts[0] if len(parts) == 1 else _joined(parts)


def _load_parquet(folder) -> Results:
    from .parquet import read_parquet

    frames, manifests = read_parquet(folder)
    return Results(**frames, manifests=manifests)


def _joined(parts: Sequence[Results]) -> Results:
    import pandas as pd

    frames = {}
    for name in ("cells", "passes", "samples"):
        found = [getattr(part, name) for part in parts]
        frames[name] = pd.concat(found, ignore_index=True)
        frames[name].attrs = found[0].attrs
    return Results(**frames, manifests={key: value for part in parts for key, value in part.manifests.items()})


def _load_results(folders) -> Results:
    from .report import data
    from .store import ResultFolder, find_results
    from .store.columns import COLUMNS, PASS_COLUMNS
    from .store.rows import pass_rows

    cells, passes, samples, manifests = [], [], [], {}
    for path in find_results(folders):
        result = data.load(ResultFolder(path))
        manifests[result.name] = dict(result.manifest)
        for point in result.points:
            cells.append({**point.row, **{f"point.{name}": value for name, value in point.cell["point"].items()}})
            passes += pass_rows([point.cell])
            samples += [(point.cell["key"], time_ms) for time_ms in point.cell.get("samples_ms") or ()]
        for line in result.folder.damaged:
            warnings.warn(line, DamagedWarning, stacklevel=3)
    return Results(_frame(cells, COLUMNS), _frame(passes, PASS_COLUMNS), _samples(samples), manifests)


DTYPES = {"str": "string", "int": "Int64", "float": "float64", "bool": "boolean", "json": "object"}


def _frame(rows: Sequence[Mapping[str, Any]], columns: Iterable[Any]) -> pd.DataFrame:
    """Rows as a data frame: the columns in their order, each of its type, then what else the rows have."""
    import pandas as pd

    columns = list(columns)
    frame = pd.DataFrame(list(rows), columns=[*(c.name for c in columns), *_others(rows, columns)])
    for column in columns:
        frame[column.name] = _typed(frame, column)
    return _told(frame, {c.name: c.unit for c in columns if c.unit}, {c.name: c.meaning for c in columns})


def _typed(frame: pd.DataFrame, column: Any) -> pd.Series:
    """A column with its type. Raises UsageError, with the first place, where a value has another one."""
    from .errors import UsageError

    dtype = DTYPES[column.type]
    try:
        return frame[column.name].astype(dtype)
    except (TypeError, ValueError, OverflowError):
        for at, value in enumerate(frame[column.name]):
            try:
                frame[column.name].iloc[[at]].astype(dtype)
            except (TypeError, ValueError, OverflowError):
                where = f"{frame['experiment'].iloc[at]}: a cell of {frame['method'].iloc[at]}"
                raise UsageError(f"{where}: {column.name} is {value!r}; allowed: {column.type}; delete the cell's file "
                                 "and measure it again") from None
        raise


def _told(frame: pd.DataFrame, units: Mapping[str, str], meanings: Mapping[str, str]) -> pd.DataFrame:
    frame.attrs = {"units": dict(units), "meanings": dict(meanings)}
    return frame


def _others(rows: Sequence[Mapping[str, Any]], columns: Iterable[Any]) -> list[str]:
    known = {c.name for c in columns}
    return list(dict.fromkeys(name for row in rows for name in row if name not in known))


def _samples(samples: Sequence[tuple[str, float]]) -> pd.DataFrame:
    import pandas as pd

    frame = pd.DataFrame(samples, columns=["key", "time_ms"]).astype({"key": "string", "time_ms": "float64"})
    return _told(frame, {"time_ms": "ms"}, {"key": "name of the cell file", "time_ms": "one timed frame"})


def plot(cells: pd.DataFrame, x: str = "k", y: str = "time_ms", *, by: str = "label",
         ax: matplotlib.axes.Axes | None = None, log: str = "") -> matplotlib.axes.Axes:
    """Lines of the column `y` over the column `x`, one for each value of `by`; with the interval where `y` has one.

    cells: `Results.cells`, or some rows of it. A method has the colour that it has in every figure of mfr-bench. log:
    the axes, of "xy", that are logarithmic. Rows without a value are left out. Raises UsageError for a column that is
    not there or has no numbers, and for other axes. Returns the axes, those of a new figure unless some are given.
    """
    import pandas as pd
    from matplotlib import pyplot as plt

    from .errors import UsageError, one_of
    from .report.style import method_colour

    for name in (x, y, by):
        if name not in cells:
            raise UsageError(f"plot: no column {name!r}; {one_of(name, map(str, cells.columns))}")
    for name in (x, y):
        given = cells[name].dropna().infer_objects()
        if len(given) and not pd.api.types.is_numeric_dtype(given):
            numbers = map(str, cells.select_dtypes("number").columns)
            raise UsageError(f"plot: column {name!r} has no numbers; {one_of(name, numbers)}")
    if set(log) - set("xy"):
        raise UsageError(f"plot: log={log!r}; allowed: letters of 'xy', the axes that are logarithmic")
    axes = ax or plt.subplots(layout="constrained")[1]
    shown = cells.dropna(subset=[x, y, by])
    for label, rows in shown.groupby(by, sort=False):
        ordered = rows.sort_values(x)
        places, values = ordered[x].astype(float), ordered[y].astype(float)
        colour = method_colour(str(rows["method"].iloc[0])) if "method" in rows else None
        axes.plot(places, values, marker="o", label=str(label), color=colour)
        if {f"{y}_low", f"{y}_high"} <= set(cells):
            low, high = (ordered[f"{y}_{end}"].astype(float) for end in ("low", "high"))
            axes.fill_between(places, low, high, color=colour, alpha=0.2, linewidth=0)
    axes.set(xlabel=_said(cells, x), ylabel=_said(cells, y), **{f"{a}scale": "log" for a in log})
    if len(shown):
        axes.legend(frameon=False)
    return axes


def _said(cells: pd.DataFrame, name: str) -> str:
    """A column's name with its unit."""
    unit = cells.attrs.get("units", {}).get(name)
    return f"{name} ({unit})" if unit else name
