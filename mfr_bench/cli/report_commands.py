"""`plot`, `table`, `conformance`, `configs`: from the store and the config files alone, no GL."""

from __future__ import annotations

import json
from pathlib import Path

import click

from .options import FOLDERS, JSON, JUNIT, OUTSIDE, SUMMARY, NumberRange, OneOf, OutPath, hold_one_form, results_below
from .output import append_text, note, say, say_lines, width, write_text


def _announce(results) -> None:
    """Name the folders that the command writes into, where there are several."""
    if len(results) > 1:
        note(f"writing into {len(results)} folders:")
        for folder in results:
            note(f"  {folder.path}")


def write_tables_of(folder, cells=None) -> list[Path]:
    """The CSV files and tables of a result folder; cells: its records, which are read unless given."""
    from ..report import write_tables
    from ..store import derive

    cells = folder.cells() if cells is None else cells
    derive(folder, cells)
    return write_tables(folder, cells)


def hand_over(results, as_json: bool, junit: str | None, summary: str | None) -> None:
    """Print the results as JSON, write a JUnit report, append to a summary: what was asked for of these."""
    from ..report import data, machine, markdown

    if as_json:
        say(json.dumps([machine.record(folder) for folder in results], indent=2, ensure_ascii=False))
    if junit:
        write_text(junit, machine.junit(machine.cases(map(data.load, results))).decode())
    if summary:
        append_text(summary, "\n".join(markdown(data.load(folder)) for folder in results))


def _inches(context, param, value: str | None) -> float | None:
    """A length as 89mm, 18cm, 3.5in or 250pt, in inches."""
    units = {"mm": 1 / 25.4, "cm": 1 / 2.54, "in": 1.0, "pt": 1 / 72.27}
    try:
        inches = None if value is None else float(value[:-2]) * units[value[-2:]]
    except (KeyError, ValueError):
        inches = 0.0
    if inches is not None and not 1 <= inches <= 100:
        raise click.BadParameter(f"{value!r} is no width; allowed: 1in to 100in, as 89mm, 18cm, 3.5in or 250pt")
    return inches


def _formats(context, param, value: str | None) -> tuple[str, ...] | None:
    from ..errors import one_of
    from ..report.look import FORMATS

    found = None if value is None else tuple(dict.fromkeys(name.strip() for name in value.split(",")))
    for name in found or ():
        if name not in FORMATS:
            raise click.BadParameter(f"{name!r} is no format; {one_of(name, FORMATS)}")
    return found


def _look(name: str | None, width_in: float | None, font_pt: float | None, dpi: float | None,
          formats: tuple[str, ...] | None):
    """The look that the options ask for; None without a style. Raises UsageError where it cannot be had."""
    from dataclasses import replace

    from ..errors import UsageError
    from ..report.look import STYLES

    given = {"width_in": width_in, "font_pt": font_pt, "dpi": dpi, "formats": formats}
    chosen = {key: value for key, value in given.items() if value is not None}
    if name is None:
        if chosen:
            raise UsageError("plot: --width, --font-size, --dpi and --format are of a --style; allowed: --style paper "
                             "or --style slides with them")
        return None
    look = replace(STYLES[name], **chosen)
    if look.font_pt > look.largest_font_pt:
        raise UsageError(f"plot: labels of {look.font_pt:g} points in figures of {look.width_in:.3g} inches; allowed: "
                         f"--font-size up to {look.largest_font_pt:.2g}, or a larger --width")
    return look


def _plot_scaled(results, look) -> None:
    from ..report import write_scaled

    for folder in results:
        for path in write_scaled(folder, look):
            say(path)
        for line in folder.damaged:
            note(line)


@click.command()
@FOLDERS
@click.option("--together", metavar="OUT", type=OutPath(file_okay=False),
              help="Draw each experiment that several results have once into OUT: its devices side by side, ratios and "
                   "ranks by device, and a page on how the devices differ.")
@click.option("--style", "look", type=OneOf(("paper", "slides")), help="Draw for a paper or for slides, into "
              "figures/paper or figures/slides. paper: 7.2in wide, labels of 8 points, as pdf, pgf and png. slides: "
              "12in, 16 points, as png, svg and pdf.")
@click.option("--width", "width_in", metavar="LENGTH", callback=_inches, help="Of --style: the width of every figure, "
              "as 89mm, 18cm or 3.5in.")
@click.option("--font-size", "font_pt", metavar="POINTS", type=NumberRange(3, 60),
              help="Of --style: the size of labels in every figure, in points; other texts keep their ratio to it.")
@click.option("--dpi", metavar="N", type=NumberRange(30, 2400),
              help="Of --style: dots per inch of png, and of images in pdf.")
@click.option("--format", "formats", metavar="F,...", callback=_formats, help="Of --style: png, svg, pdf, pgf.")
@click.option("--force", is_flag=True, help="Draw figures again that are up to date.")
@OUTSIDE
def plot(folders: tuple[str, ...], together: str | None, look: str | None, width_in: float | None,
         font_pt: float | None, dpi: float | None, formats: tuple[str, ...] | None, force: bool) -> None:
    """Draw the figures of all results at or below DIR that are not up to date.

    They go into the folders of the results, which are listed first where there are several. A figure is up to date
    where its files say that they were drawn from the same results, config, code and libraries. With --together or
    --style all are drawn.

    \b
    Examples: mfr-bench plot results/nvidia-h200/smoke
              mfr-bench plot results --together results/devices
              mfr-bench plot results --style paper --width 89mm --font-size 6
    """
    from ..report import write_all

    results = results_below(folders)
    if look := _look(look, width_in, font_pt, dpi, formats):
        _plot_scaled(results, look)
        return
    if together is not None:
        _plot_together(results, Path(together))
        return
    _announce(results)
    notes, kept = [], 0
    for drawn in write_all(results, force=force):
        if drawn.paths:
            say("\n".join(map(str, drawn.paths)))
        notes += [*drawn.damaged, *drawn.empty]
        kept += drawn.kept
    for line in notes:
        note(line)
    if kept:
        note(f"{kept} {'figure was' if kept == 1 else 'figures were'} up to date; --force draws all again")


def _plot_together(results, out: Path) -> None:
    from ..report import write_together

    written = write_together(results, out)
    for path in written:
        say(path)
    if not written:
        note("no experiment is in more than one of these results; nothing drawn")
    for folder in results:
        for line in folder.damaged:
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
@click.option("--devices", is_flag=True, help="Print one table of each experiment over all devices instead: ranks and "
              "ratios of its methods, and how the devices differ. Writes nothing.")
@click.option("--latex", metavar="OUT", type=OutPath(file_okay=False), help="Write every measured cell to OUT instead: "
              "for each result a .tex file for booktabs and a .csv file for siunitx.")
@click.option("--parquet", metavar="OUT", type=OutPath(file_okay=False), help="Write cells, passes and samples of all "
              "results to OUT as Parquet files instead, with units in their metadata; needs mfr-bench[parquet].")
@OUTSIDE
def table(folders: tuple[str, ...], junit: str | None, summary: str | None, as_json: bool, devices: bool,
          latex: str | None, parquet: str | None) -> None:
    """Print the tables of all results at or below DIR.

    Writes them again, too, with results.csv and passes.csv, into the folders of the results, which are listed first
    where there are several.

    \b
    Examples: mfr-bench table results | less
              mfr-bench table results --json | jq '.[].cells[].time_ms'
              mfr-bench table results --devices
              mfr-bench table results/nvidia-h200/smoke --latex paper/tables
              mfr-bench table results --parquet analysis
    """
    from ..report import terminal_table, write_for_paper

    hold_one_form("table", json=as_json, devices=devices, latex=bool(latex), parquet=bool(parquet))
    if parquet:
        _as_parquet(folders, Path(parquet))
        return
    results = results_below(folders)
    if latex:
        for path in write_for_paper(results, Path(latex)):
            say(path)
        return
    if devices:
        _over_devices(results)
        return
    _announce(results)
    if not as_json:
        say("\n".join(terminal_table(folder, width()) for folder in results).rstrip("\n"))
    hand_over(results, as_json, junit, summary)
    for folder in results:  # after all are shown: a folder may be there only to be read
        write_tables_of(folder)


def _as_parquet(folders: tuple[str, ...], out: Path) -> None:
    """Write everything that the API loads of these folders to one folder of Parquet files."""
    import warnings

    from ..api import DamagedWarning, load
    from ..parquet import write_parquet

    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always", DamagedWarning)
        found = load(*folders)
    for each in told:
        note(each.message)
    frames = {"cells": found.cells, "passes": found.passes, "samples": found.samples}
    for path in write_parquet(frames, found.manifests, out):
        say(path)


def _over_devices(results) -> None:
    """Print how methods stand over the devices of each experiment."""
    from ..report.devices import as_text, read_experiments

    found = read_experiments(results)
    say("\n".join(as_text(experiment, width()) for experiment in found).rstrip("\n"))
    if not found:
        note("no method has a time with the right image in these results")


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
@click.option("--fidelity", is_flag=True, help="Print docs/fidelity.md: the papers' settings and those here.")
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
    from ..scene.page import kinds_page

    hold_one_form("configs", papers=papers, markdown=as_markdown, kinds=kinds, fidelity=fidelity)
    if kinds:
        say(kinds_page().rstrip("\n"))
        return
    if as_markdown:
        say(_experiments_page().rstrip("\n"))
        return
    if fidelity:
        say(_fidelity_page().rstrip("\n"))
        return
    known = {name: load(str(path), catalog())[0] for name, path in shipped().items()}
    if papers:
        say("\n".join(name for name, experiment in known.items() if experiment.source.get("paper")))
        return
    longest = max(map(len, known))
    say_lines("\n".join(f"{name:{longest}}  {experiment.title}{_source(experiment)}"
                        for name, experiment in known.items()))


def _source(experiment) -> str:
    """The paper and the figure of an experiment, in brackets; empty without a paper."""
    from ..report.data import figure_of

    source = " ".join(filter(None, (experiment.source.get("paper"), figure_of(experiment.source))))
    return f" ({source})" if source else ""


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

    say(conformance_page(map(load, results_below(folders)), catalog()).rstrip("\n"))
