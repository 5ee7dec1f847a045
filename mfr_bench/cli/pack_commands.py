"""`pack`, `unpack`: the cells of a result folder as one file, and as one file each again."""

from __future__ import annotations

from collections.abc import Callable

import click

from .options import FOLDERS, results_below
from .output import note, say


@click.command()
@FOLDERS
def pack(folders: tuple[str, ...]) -> None:
    """Put the cells of all results at or below DIR into one file each, cells.zip.

    Every command reads it as it reads cells/. A later run adds its cells next to it; pack takes them in.

    \b
    Example: mfr-bench pack results/nvidia-h200
    """
    _each(folders, lambda folder: f"{folder.pack() or 'no'} cells in {folder.pack_path}")


@click.command()
@FOLDERS
def unpack(folders: tuple[str, ...]) -> None:
    """Write the packed cells of all results at or below DIR back into one file each, byte for byte.

    \b
    Example: mfr-bench unpack results/nvidia-h200/kplus2015-fig6
    """
    _each(folders, lambda folder: f"{folder.unpack() or 'no'} cells in {folder.cells_path}")


def _each(folders: tuple[str, ...], work: Callable) -> None:
    """Do the work in every folder while no run measures into it, and say what came of it."""
    for folder in results_below(folders):
        with folder.lock() as unlocked:
            if unlocked:
                note(unlocked)
            say(work(folder))
        for line in folder.damaged:
            note(line)
