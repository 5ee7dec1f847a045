"""The tables of a result folder as files."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from ...store import Cell, ResultFolder, csv_text, remove_parts, write_file
from .. import data
from ..data import Point, Result
from .pages import markdown

CSV_COLUMNS = ("status", "exact", "max_abs_error", "rmse", "psnr_db", "flip", "hit_ratio", "wrong_pixels", "time_ms",
               "time_ms_low", "time_ms_high", "noisy", "floor_ratio", "floor_ratio_low", "floor_ratio_high",
               "memory_mib", "memory_model_mib", "reason")


def write_tables(folder: ResultFolder, cells: Sequence[Cell] | None = None) -> list[Path]:
    """Write tables/results.md, summary.csv (a row per cell) and pass_times.csv. Raises StoreError.

    cells: those of the folder, which are read unless given.
    """
    result = data.load(folder, cells)
    target = folder.path / "tables"
    remove_parts(target)
    contents = {"results.md": markdown(result).encode(), "summary.csv": _summary_csv(result),
                "pass_times.csv": _passes_csv(result)}
    for name, content in contents.items():
        write_file(target / name, content)
    (target / "results.csv").unlink(missing_ok=True)  # the name of summary.csv in earlier versions
    return [target / name for name in contents]


def _coordinates(result: Result, point: Point) -> dict[str, Any]:
    return {"label": point.label, "method": point.method} | {
        axis: data.plain(v) if (v := point.at(axis)) is not None else None for axis in result.axes}


def _summary_csv(result: Result) -> bytes:
    rows = []
    for p in result.points:
        low, ratio, high = p.floor_ratio
        derived = {"exact": p.exact, "floor_ratio": ratio, "floor_ratio_low": low, "floor_ratio_high": high,
                   "memory_mib": p.measure("memory_mib")[1], "memory_model_mib": p.measure("memory_model_mib")[1]}
        rows.append(p.row | derived | _coordinates(result, p))
    return csv_text(("label", "method", *result.axes, *CSV_COLUMNS), rows)


def _passes_csv(result: Result) -> bytes:
    names = dict.fromkeys(name for p in result.points for name in p.passes_ms)
    rows = [_coordinates(result, p) | {name: interval[1] for name, interval in p.passes_ms.items()}
            for p in result.points if p.passes_ms]
    return csv_text(("label", "method", *result.axes, *names), rows)
