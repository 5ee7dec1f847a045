"""Decides which cells of a run need no measuring, and why: one answer for the run and for its dry run."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from ..plan import CellOutcome, Outcomes
from ..store import ResultFolder, failed_trials
from ..store.status import STATUSES
from .sheet import Sheet

Row = dict[str, Any]


@dataclass(frozen=True)
class Kept:
    """The folder of the experiment has the row."""

    row: Row


@dataclass(frozen=True)
class Copied:
    """Another folder has the row."""

    row: Row
    source: ResultFolder


@dataclass(frozen=True)
class LeftOut:
    """A smaller cell took too long. row: what the folder has of an earlier run that left the cell out for it."""

    reason: str
    row: Row | None


Settled = Kept | Copied | LeftOut


def settled(sheets: Sequence[Sheet], elsewhere: Iterable[ResultFolder] = (), force: bool = False,
            keep_failed: bool = False, try_hopeless: bool = False) -> list[dict[str, Settled]]:
    """The cells of each sheet, by key, that need no measuring; with `force` none.

    elsewhere: folders whose cells may be copied. Nothing is written.
    """
    if force:
        return [{} for _ in sheets]
    kept = [{key: Kept(row) for key in _there(sheet.folder, sheet.jobs)
             if (row := final(sheet.folder, key, keep_failed))} for sheet in sheets]
    folders = [sheet.folder for sheet in sheets]
    found = [mine | _copies(sheet, mine, [(folder, own) for folder, own in zip(folders, kept, strict=True)],
                            elsewhere, keep_failed) for sheet, mine in zip(sheets, kept, strict=True)]
    if try_hopeless:
        return found
    outcomes = Outcomes(outcome for sheet, mine in zip(sheets, found, strict=True) for key, each in mine.items()
                        if (outcome := CellOutcome.of(sheet.jobs[key].cell, each.row)))
    return [mine | _left_out(sheet, mine, outcomes) for sheet, mine in zip(sheets, found, strict=True)]


def _copies(sheet: Sheet, mine: Mapping[str, Kept], own: Iterable[tuple[ResultFolder, Mapping[str, Kept]]],
            elsewhere: Iterable[ResultFolder], keep_failed: bool) -> dict[str, Copied]:
    """The rows that other folders have: those of the same run first."""
    found: dict[str, Copied] = {}
    wanted = dict.fromkeys(key for key in sheet.jobs if key not in mine)
    for folder, kept in own:
        found |= {key: Copied(kept[key].row, folder) for key in wanted if key in kept and key not in found}
    for folder in elsewhere:
        found |= {key: Copied(row, folder) for key in _there(folder, wanted)
                  if key not in found and (row := final(folder, key, keep_failed))}
    return found


def _there(folder: ResultFolder, keys: Iterable[str]) -> list[str]:
    """Those of the keys that the folder has a file for: most folders have none of them, and are not asked for each."""
    names = set(folder.names())
    return [key for key in keys if f"{key}.json" in names]


def _left_out(sheet: Sheet, mine: Mapping[str, Settled], outcomes: Outcomes) -> dict[str, LeftOut]:
    found = {}
    for key, job in sheet.jobs.items():
        if key not in mine and (reason := outcomes.predicted_timeout(job.cell)):
            row = sheet.folder.cell(key)
            same = row is not None and row["status"] == "timeout" and row["reason"] == reason
            found[key] = LeftOut(reason, row if same else None)
    return found


def final(folder: ResultFolder, key: str, keep_failed: bool) -> Row | None:
    """The row of a cell that need not be measured again."""
    row = folder.cell(key)
    return None if row is None or (_retried(row) and not keep_failed) else row


def _retried(row: Row) -> bool:
    """Whether the cause may have gone. A device may pass its self-tests under the same name and version later."""
    return STATUSES[row["status"]].retried or bool(failed_trials(row))
