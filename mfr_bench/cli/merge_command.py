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
    from ..merge import merged_sets
    from ..parallel import in_processes

    sets, left_out = merged_sets(folders, into)
    for line in left_out:
        note(line)
    for noted, said in in_processes(_written, sets):
        for line in noted:
            note(line)
        for line in said:
            say(line)
    say(f"figures: mfr-bench plot {into}")


def _written(merged) -> tuple[list[str], list[str]]:
    """Write a set and its tables; lines for stderr and for stdout."""
    from ..merge import write_set
    from ..report.devices import write_digest
    from .report_commands import write_tables_of

    with merged.folder.lock() as unlocked:
        written = write_set(merged)
    records = merged.folder.cells() if written.records is None else written.records
    write_tables_of(merged.folder, records)
    write_digest(merged.folder, records)
    counts = f"cells: {written.cells}, new: {written.new}, merged folders: {written.folders}"
    return [unlocked] if unlocked else [], [*written.said, f"{merged.folder.path}: {counts}"]
