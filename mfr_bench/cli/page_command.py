"""`report`: all results as one HTML page; from the store alone, no GL."""

from __future__ import annotations

from pathlib import Path

import click

from .options import FOLDERS, OUTSIDE, OutPath, results_below
from .output import note, say


def write_page_of(folders, out: str, tell) -> None:
    """Write the page of these results, and print where it is."""
    from ..page import write_page

    large = write_page(folders, Path(out))
    tell(f"page    {out}")
    if large:
        note(large)


@click.command()
@FOLDERS
@click.option("--out", metavar="F.html", default="report.html", show_default=True, type=OutPath(dir_okay=False),
              help="Write the page to this file.")
@click.option("--trend", is_flag=True, help="Show instead how each cell changed over the dated results below DIR.")
@OUTSIDE
def report(folders: tuple[str, ...], out: str, trend: bool) -> None:
    """Write one HTML page of all results at or below DIR, to be sent.

    Tables that can be sorted and filtered, figures, charts of any column, kept images behind a slider, the papers'
    claims, device and versions, and the command that gives each of them again. The file opens from disk, loads
    nothing from a network, and names no host, user or path. Without JavaScript all tables and figures are still there.

    \b
    Examples: mfr-bench report results/nvidia-h200 --out report.html
              mfr-bench report nightly/ --trend --out trend.html

    With --trend, DIR holds results of many days, such as nightly/2026-11-28/smoke: a page of every cell night by night,
    with the nights from which on it was slower or faster, and the commit of each.
    """
    from ..page import write_page, write_trend

    results = results_below(folders)
    large = None
    if trend:
        write_trend(results, Path(out))
    else:
        large = write_page(results, Path(out))
    say(out)
    if large:
        note(large)
    for folder in results:
        for line in folder.damaged:
            note(line)
