"""`plot`, `table`, `configs`: from the store and the config files alone, no GL."""

from __future__ import annotations

from pathlib import Path

import click

FOLDERS = click.argument("folders", nargs=-1, required=True, metavar="DIR...", type=click.Path())


def _results(folders: tuple[str, ...]):
    from ..store import ResultFolder, find_results

    return [ResultFolder(path) for path in find_results(folders)]


def write_report(folder) -> list[Path]:
    """Everything that is derived from a result folder's cells: CSV, tables, figures."""
    from ..report import write_figures, write_tables
    from ..store import derive

    derive(folder)
    return [*write_tables(folder), *write_figures(folder)]


@click.command()
@FOLDERS
def plot(folders: tuple[str, ...]) -> None:
    """Draw the figures of every result at or below DIR again.

    \b
    Example: mfr-bench plot results/llvmpipe/smoke
    """
    from ..report import write_figures

    for folder in _results(folders):
        for path in write_figures(folder, processes=2):
            click.echo(path)
        _name_damaged(folder)


@click.command()
@FOLDERS
def table(folders: tuple[str, ...]) -> None:
    """Print the tables of every result at or below DIR, and write them with results.csv and passes.csv.

    \b
    Example: mfr-bench table results | less
    """
    from ..report import terminal_table, write_tables
    from ..store import derive

    for number, folder in enumerate(_results(folders)):
        derive(folder)
        write_tables(folder)
        click.echo(("\n" if number else "") + terminal_table(folder), nl=False)


def _name_damaged(folder) -> None:
    for line in folder.damaged:
        click.echo(line, err=True)


@click.command()
def configs() -> None:
    """List the configs that come with the package, by the names that `run` takes."""
    from ..config import load, shipped
    from ..methods import catalog

    width = max(map(len, shipped()))
    for name, path in shipped().items():
        experiment = load(str(path), catalog())[0]
        source = " ".join(filter(None, (experiment.source.get("paper"), f"figure {experiment.source['figure']}"
                                        if experiment.source.get("figure") else "")))
        click.echo(f"{name:{width}}  {experiment.title}{f' ({source})' if source else ''}")


COMMANDS = (plot, table, configs)
