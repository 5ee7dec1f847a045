"""Fills the page's template."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Sequence
from importlib.resources import files
from pathlib import Path

from .. import __version__
from ..claims import CLAIMS, judge_all, runs_of
from ..report import data, style
from ..report.data import Result
from ..store import ResultFolder, write_file
from .content import MEASURED, Experiment, experiment, without_paths
from .shaders import shaders_of

MOST_BYTES = 5 * 2**20
STYLES = ("vendor/uPlot.min.css", "page.css")
SCRIPTS = ("vendor/uPlot.iife.min.js", "page.js")


def write_page(folders: Sequence[ResultFolder], target: Path, draw: bool = True) -> str | None:
    """Write the page of all results to `target`. Returns a line where it is larger than a page should be to be sent.

    draw: figures that a folder lacks are drawn first. Raises StoreError.
    """
    content = page_text(folders, draw).encode()
    write_file(target, content)
    if len(content) <= MOST_BYTES:
        return None
    size = math.ceil(100 * len(content) / 2**20) / 100  # rounded up: never what is allowed
    return (f"{target}: {size:.2f} MiB; a page of up to {MOST_BYTES // 2**20} MiB is easily sent and opened: report "
            "fewer folders at a time")


def page_text(folders: Sequence[ResultFolder], draw: bool = True) -> str:
    """The HTML of the page."""
    results = [data.load(folder) for folder in folders]
    experiments = [_experiment(result, f"e{i}", draw) for i, result in enumerate(results, 1)]
    shaders = shaders_of(point for result in results for point in result.points)
    methods = list(dict.fromkeys(line.method for e in experiments for line in e.lines))
    return template("page.html.j2").render(
        experiments=experiments, columns=MEASURED, verdicts=_verdicts(results), version=__version__,
        colours=list(map(style.method_colour, methods)), methods={name: at for at, name in enumerate(methods)},
        styles=[_file(name) for name in STYLES], scripts=[_file(name) for name in SCRIPTS], policy=_policy(),
        shaders=shaders,
        titled=next((e.anchor for e in experiments if e.lines), None))


def template(name: str):
    """A template of this package, which has the text of the style sheet."""
    import jinja2

    environment = jinja2.Environment(autoescape=True, trim_blocks=True, lstrip_blocks=True,
                                     undefined=jinja2.StrictUndefined, loader=jinja2.FunctionLoader(_file))
    return environment.get_template(name, globals={"style": _file("page.css")})


def _experiment(result: Result, anchor: str, draw: bool) -> Experiment:
    from ..report.figures import figure_paths, write_figures

    paths = figure_paths(result)
    if draw and not all(path.is_file() for path in paths):
        write_figures(result.folder)
    return experiment(result, anchor, paths)


def _verdicts(results: Sequence[Result]) -> list[dict[str, object]]:
    """The verdicts on the papers' sentences, untestable ones last; none where none is about what was measured."""
    measured = {result.manifest.get("name") for result in results}
    if not any(measured.intersection(claim.experiments) for claim in CLAIMS):
        return []
    found = [verdict.record() | {"findings_text": [finding.text for finding in verdict.findings]}
             for verdict in judge_all(CLAIMS, [run for result in results for run in runs_of(result)])]
    tested = [v for v in found if v["verdict"] in ("holds", "does not hold")]
    return [{name: without_paths(value) if isinstance(value, str) else value for name, value in v.items()}
            for v in (*tested, *(v for v in found if v not in tested))]


def _file(name: str) -> str:
    return files(__package__).joinpath(*name.split("/")).read_text(encoding="utf-8")


def _policy() -> str:
    """The Content-Security-Policy of the page: its own scripts by hash, and nothing from anywhere."""
    import base64

    hashes = " ".join(f"'sha256-{base64.b64encode(hashlib.sha256(_file(name).encode()).digest()).decode()}'"
                      for name in SCRIPTS)
    return f"default-src 'none'; img-src data:; style-src 'unsafe-inline'; script-src {hashes}"
