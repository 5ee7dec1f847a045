"""`plot`, `table`, `conformance`, `configs`: from the store and the config files alone, no GL."""

from __future__ import annotations

import json
from pathlib import Path

import click

from .options import FOLDERS, JSON, JUNIT, OUTSIDE, SUMMARY, OutPath
from .output import append_text, note, say, width, write_text


def _results(folders: tuple[str, ...]):
    from ..store import ResultFolder, find_results

    return [ResultFolder(path) for path in find_results(folders)]


def _announce(results) -> None:
    """Name the folders that the command writes into, where there are several."""
    if len(results) > 1:
        note(f"writing into {len(results)} folders:")
        for folder in results:
            note(f"  {folder.path}")


def write_report(folder) -> list[Path]:
    """Everything that is derived from a result folder's cells: CSV, tables, figures."""
    from ..report import write_figures

    return [*write_tables_of(folder), *write_figures(folder)]


def write_tables_of(folder) -> list[Path]:
    """The CSV files and tables of a result folder."""
    from ..report import write_tables
    from ..store import derive

    derive(folder)
    return write_tables(folder)


def hand_over(results, as_json: bool, junit: str | None, summary: str | None) -> None:
    """Print the results as JSON, write a JUnit report, append to a summary: what was asked for of these."""
    from ..report import data, machine, markdown

    if as_json:
        say(json.dumps([machine.record(folder) for folder in results], indent=2, ensure_ascii=False))
    if junit:
        write_text(junit, machine.junit(machine.cases(map(data.load, results))).decode())
    if summary:
        append_text(summary, "\n".join(markdown(data.load(folder)) for folder in results))


@click.command()
@FOLDERS
@click.option("--together", metavar="OUT", type=OutPath(file_okay=False),
              help="Draw each experiment that several results hold once, device beside device, into OUT.")
@OUTSIDE
def plot(folders: tuple[str, ...], together: str | None) -> None:
    """Draw the figures of all results at or below DIR again.

    They go into the folders of the results, which are listed first where there are several.

    \b
    Examples: mfr-bench plot results/nvidia-h200/smoke
              mfr-bench plot results --together results/devices
    """
    from ..report import write_all, write_together

    results = _results(folders)
    if together is None:
        _announce(results)
    notes: list[str] = []
    for paths, damaged in write_all(results) if together is None else ():
        if paths:
            say("\n".join(map(str, paths)))
        notes += damaged
    if together is not None:
        written = write_together(results, Path(together))
        for path in written:
            say(path)
        if not written:
            note("no experiment is in more than one of these results; nothing drawn")
    for line in notes if together is None else (line for folder in results for line in folder.damaged):
        note(line)


def _print_columns(context: click.Context, parameter: click.Parameter, asked: bool) -> None:
    if asked:
        from ..store.page import columns_page

        say(columns_page().rstrip("\n"))
        context.exit()


@click.command()
@FOLDERS
@click.option("--columns", is_flag=True, is_eager=True, expose_value=False, callback=_print_columns,
              help="Print docs/results.md: every file and column of a result folder.")
@JUNIT
@SUMMARY
@JSON
@OUTSIDE
def table(folders: tuple[str, ...], junit: str | None, summary: str | None, as_json: bool) -> None:
    """Print the tables of all results at or below DIR.

    Writes them again, too, with results.csv and passes.csv, into the folders of the results, which are listed first
    where there are several.

    \b
    Examples: mfr-bench table results | less
              mfr-bench table results --json | jq '.[].cells[].time_ms'
    """

    results = _results(folders)
    _announce(results)
    if not as_json:
        from ..report import terminal_table

        say("\n".join(terminal_table(folder, width()) for folder in results).rstrip("\n"))
    hand_over(results, as_json, junit, summary)
    for folder in results:  # after all are shown: a folder may be there only to be read
        write_tables_of(folder)


@click.command()
@click.option("--out", metavar="F.json", type=OutPath(dir_okay=False), help="Write it to this file instead.")
@OUTSIDE
def schema(out: str | None) -> None:
    """Print the JSON Schema of a config, for editors.

    An editor with the YAML language server completes keys, methods and parameters, explains them and underlines what
    is wrong, in a file whose first line names the schema:

    \b
      # yaml-language-server: $schema=schema.json

    \b
    Example: mfr-bench schema --out schema.json
    """
    from ..config.editor import editor_schema
    from ..methods import catalog

    text = json.dumps(editor_schema(catalog()), indent=1, ensure_ascii=False)
    if out is None:
        say(text)
    else:
        write_text(out, text + "\n")
        say(out)


@click.command()
@click.option("--papers", is_flag=True, help="Print only the names of the papers' experiments.")
@click.option("--markdown", "as_markdown", is_flag=True, help="Print docs/experiments.md.")
@click.option("--kinds", is_flag=True, help="Print what the kinds of scenes say of themselves in docs/scenes.md.")
@click.option("--fidelity", is_flag=True, help="Print docs/fidelity.md: the papers' settings beside those here.")
def configs(papers: bool, as_markdown: bool, kinds: bool, fidelity: bool) -> None:
    """List the configs that come with the package.

    \b
    Examples: mfr-bench configs
              mfr-bench configs --markdown >docs/experiments.md
              mfr-bench configs --fidelity >docs/fidelity.md
              mfr-bench run $(mfr-bench configs --papers) --profile smoke
    """
    from ..config import load, shipped
    from ..methods import catalog
    from ..report.data import figure_of
    from ..scene.page import kinds_page

    if kinds:
        say(kinds_page().rstrip("\n"))
        return
    if as_markdown:
        say(_experiments_page().rstrip("\n"))
        return
    if fidelity:
        say(_fidelity_page().rstrip("\n"))
        return
    longest = max(map(len, shipped()))
    for name, path in shipped().items():
        experiment = load(str(path), catalog())[0]
        if papers:
            if experiment.source.get("paper"):
                say(name)
            continue
        source = " ".join(filter(None, (experiment.source.get("paper"), figure_of(experiment.source))))
        say(f"{name:{longest}}  {experiment.title}{f' ({source})' if source else ''}")


def _fidelity_page() -> str:
    from ..claims import CLAIMS
    from ..claims.fidelity import as_markdown
    from ..config import load, shipped
    from ..methods import catalog

    return as_markdown([load(str(path), catalog())[0] for path in shipped().values()], CLAIMS)


def _experiments_page() -> str:
    from ..config import load, shipped
    from ..methods import catalog
    from ..plan import expand
    from ..report import experiments

    def sized(path: Path, profile: str | None) -> experiments.Sized:
        experiment, = load(str(path), catalog(), profile)
        return experiments.Sized(experiment, len(expand(experiment, catalog())))

    return experiments.as_markdown((sized(path, None), sized(path, "smoke")) for path in shipped().values())


@click.command()
@FOLDERS
def conformance(folders: tuple[str, ...]) -> None:
    """Print docs/conformance.md from all results at or below DIR.

    Which images were right, and what each method kept, lost and repeated.

    \b
    Example: mfr-bench run conformance determinism --out out
             mfr-bench conformance out >docs/conformance.md
    """
    from ..methods import catalog
    from ..report import conformance_page
    from ..report.data import load

    say(conformance_page(map(load, _results(folders)), catalog()).rstrip("\n"))
