"""`compare`: what changed between two sets of results; from the store alone, no GL."""

from __future__ import annotations

from typing import NoReturn

import click

from ..errors import UsageError
from .endings import DOUBT, REGRESSION
from .options import CSV, JSON, JUNIT, MARKDOWN, SUMMARY, THRESHOLD, WHOLE, InPath, hold_one_form
from .output import append_text, note, say, width, write_text


@click.command()
@click.argument("before", metavar="DIR_A", type=InPath())
@click.argument("after", metavar="DIR_B", type=InPath())
@THRESHOLD
@click.option("--across-devices", is_flag=True, help="Compare results of different devices or drivers.")
@click.option("--absolute", is_flag=True,
              help="Count what all methods of a scene have in common as theirs; else it is taken out.")
@click.option("--strict", is_flag=True,
              help="End with status 5 also where any cell is UNCLEAR, or the machine as a whole moved.")
@WHOLE
@JSON
@CSV
@MARKDOWN
@JUNIT
@SUMMARY
def compare(before: str, after: str, threshold: float, across_devices: bool, absolute: bool, strict: bool, whole: bool,
            as_json: bool, as_csv: bool, as_markdown: bool, junit: str | None, summary: str | None) -> int:
    """Say where DIR_B is faster, slower or worse than DIR_A.

    Cells are matched by config, method, parameters and scene, in all results at or below each folder.

    \b
    FASTER, SLOWER  beyond the threshold, and what two runs of one thing differ
                    by, as the cells show it, corrected for their number; with
                    fewer than 20 cells also beyond both noise floors
    SAME            within the threshold, with 95 % confidence
    UNCLEAR         neither: measure again, longer, or on a quieter machine
    MISSING         in one of the two folders alone

    Two runs differ by more than the intervals within them tell. So what all methods of a scene have in common is taken
    out (a load or a clock does that; --absolute leaves it in), and how far cells scatter between the runs is estimated
    from all of them. A cell that moved alone, against the others of its method, must be four times as far out.
    One sample is a weak interval, not none: with fewer than 6, the frames of all cells show how far frames lie apart.

    \b
    Examples:
      mfr-bench compare results/before results/after
      mfr-bench compare old new --threshold 5 --strict
      mfr-bench compare results/nvidia-h100 results/nvidia-h200 --across-devices

    \b
    Exit status:
      4  something is slower, or newly wrong or failed, or has a larger error
         or more memory
      5  else, where cells are MISSING, or nothing could be told of any cell;
         with --strict also where any cell is UNCLEAR
      0  else: a few UNCLEAR cells are ordinary noise
    """
    from ..compare import compare as compared

    hold_one_form("compare", json=as_json, csv=as_csv, markdown=as_markdown)
    sides = _sides(before, after)
    damaged = list(dict.fromkeys(line for side in sides for line in side.damaged))
    if not all(side.entries for side in sides):
        _refuse_empty(sides, damaged)
    found = compared(*sides, threshold, across_devices, absolute)
    if found.verdicts:
        printed(found, whole, as_json, as_csv, as_markdown)
        handed_over(found, junit, summary)
    for line in damaged:
        note(line)
    if not found.verdicts:
        raise UsageError(f"compare: {before} and {after} have no cell in common; allowed: results of the same configs")
    return status_of(found, strict)


def printed(found, whole: bool, as_json: bool, as_csv: bool, as_markdown: bool) -> None:
    """Print a comparison in the form that is asked for."""
    from ..compare import present

    if as_json:
        say(present.as_json(found))
    elif as_csv:
        say(present.as_csv(found).rstrip("\n"))
    else:
        say(present.as_markdown(found, whole) if as_markdown else present.as_text(found, width(), whole))


def handed_over(found, junit: str | None, summary: str | None) -> None:
    """Write a JUnit report and append to a summary, where that is asked for."""
    from ..compare import present
    from ..report.machine import junit as as_xml

    if junit:
        write_text(junit, as_xml(present.as_cases(found)).decode())
    if summary:
        append_text(summary, present.as_markdown(found))


def status_of(found, strict: bool) -> int:
    """The exit status that a comparison ends with."""
    return REGRESSION if found.regressed else DOUBT if found.untold or (strict and found.doubtful) else 0


def _sides(before: str, after: str):
    """Both sides. Raises UsageError with the mistakes of both."""
    from ..compare import load_side

    sides, mistakes = [], []
    for path in (before, after):
        try:
            sides.append(load_side(path))
        except UsageError as error:
            mistakes += error.lines
    if mistakes:
        raise UsageError(mistakes)
    return sides


def _refuse_empty(sides, damaged: list[str]) -> NoReturn:
    """Name the files that were not used. Raises UsageError that names the sides of which no cell is left."""
    for line in damaged:
        note(line)
    raise UsageError([f"{side.path}: no cell of it can be used; allowed: results with a cell at least, which "
                      "'mfr-bench run' measures" for side in sides if not side.entries])
