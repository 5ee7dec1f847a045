"""`merge`: the results of several machines and runs as one set."""

from __future__ import annotations

from pathlib import Path

import click

from .options import FOLDERS, OutPath, results_below
from .output import note, say


@click.command()
@FOLDERS
@click.option("--into", required=True, metavar="DIR", type=OutPath(file_okay=False),
              help="Where the sets go: DIR/<device>/<experiment>/; DIR itself for one experiment of one device.")
def merge(folders: tuple[str, ...], into: str) -> None:
    """Merge results of several machines and runs, cell by cell.

    All results at or below each DIR become one set for each experiment and device. Every record is held to its key
    first. Cells stay byte for byte, and each manifest is kept whole. Merging again, or in another order, changes
    nothing; runs may go on meanwhile. One key with two contents is refused, and nothing is written. If equal
    devices, told apart by UUID, measured a cell, their samples are added up where they are equivalent, and kept
    apart where not.

    \b
    Example: mfr-bench merge node1/results node2/results --into results
    """
    merge_into(results_below(folders), Path(into))


def merge_into(folders, into: Path) -> None:
    """Merge result folders, write the tables of each set, and say what became of them."""
    from ..merge import merged_sets, write_set
    from .report_commands import write_tables_of

    sets, left_out = merged_sets(folders, into)
    for line in left_out:
        note(line)
    for merged in sets:
        with merged.folder.lock() as unlocked:
            if unlocked:
                note(unlocked)
            written = write_set(merged)
        write_tables_of(merged.folder)
        for line in filter(None, (cell.said for cell in merged.cells.values())):
            say(line)
        say(f"{merged.folder.path}: cells: {written.cells}, new: {written.new}, merged folders: {len(merged.sources)}")
    say(f"figures: mfr-bench plot {into}")
