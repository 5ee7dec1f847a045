"""The experiments as Markdown: docs/experiments.md, which a test compares with the configs."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

from ..config.model import Experiment
from ..markdown import filled, markdown_table
from .data import figure_of, plain, short

HEAD = """# The experiments

Every experiment of the papers that mfr-bench runs, taken from its config (`mfr-bench configs --markdown` prints this
page). Sizes are those of the config, which are the paper's, and of its profile `smoke`, which ends in seconds on two
CPU cores. Where a paper used a mesh that is not free, the scene is a stand-in of the same depth complexity and density.
The numbers that the papers print are in `results/reference/`; tables and figures show them with the measured ones.

`mfr-bench run NAME` runs one of them, `make papers` or `mfr-bench run $(mfr-bench configs --papers)` all. Then
`mfr-bench claims results` says which of the papers' sentences hold.
"""
READINGS = "Where a paper leaves a setting open, this is how it is read; the small print of the figures says the same."
COLUMNS = ("config", "source", "shows", "scene", "full size", "smoke")


@dataclass(frozen=True)
class Sized:
    """An experiment and how many cells its profile has."""

    experiment: Experiment
    cells: int


def as_markdown(pairs: Iterable[tuple[Sized, Sized]]) -> str:
    """The page; each pair is an experiment at full size and in its profile `smoke`."""
    pairs = list(pairs)
    rows = [_row(full, smoke) for full, smoke in pairs if full.experiment.source.get("paper")]
    readings = _readings([full.experiment for full, _ in pairs])
    return "\n".join([HEAD, *markdown_table(COLUMNS, rows), "", *readings]) + "\n"


def _readings(experiments: Iterable[Experiment]) -> list[str]:
    """A list of how each config reads what its paper leaves open."""
    found = [filled(f"`{e.name}`: {' '.join(e.source['readings'])}", "- ")
             for e in experiments if e.source.get("readings")]
    return ["## Readings", "", READINGS, "", *found] if found else []


def _row(full: Sized, smoke: Sized) -> tuple[str, ...]:
    e = full.experiment
    source = f"{e.source['paper']} {figure_of(e.source)}".strip()
    return f"`{e.name}`", source, f"{e.title}: {_shown(e)}", _scene(e), _size(full), _size(smoke)


def _shown(experiment: Experiment) -> str:
    """'time_ms by k, bars by pass; …': each kind of figure in a few words, once."""
    return "; ".join(dict.fromkeys(_figure(f) for f in experiment.figures)) or "a table"


def _figure(figure: Any) -> str:
    y = f"gain of {figure.gain_of}" if figure.gain_of else f"{figure.passes[0]} pass" if figure.passes else figure.y
    if figure.kind == "histogram":
        return "histograms of the fragments per pixel"
    if figure.kind == "maps":
        return f"maps of {y}"
    kind = {"stacked_passes": "bars by pass"}.get(figure.kind, figure.kind)
    fit = f" with {figure.fit} fit" if figure.fit else ""
    scale = f", log{figure.log_base} {figure.log}" if figure.log else ""
    return f"{y} by {short(figure.x)}, {kind}{fit}{scale}"


def _scene(experiment: Experiment) -> str:
    scene = experiment.scene
    what = scene.kind if scene.kind != "quads" else f"quads, {scene.layout}"
    return str(experiment.source.get("stand_in") or what)


def _size(sized: Sized) -> str:
    """Viewport, n where the config says it, k and the number of cells; an axis as its first and last value."""
    e = sized.experiment
    axes = {**e.sweep, **e.zip}
    viewport = _span(axes.get("scene.size") or [e.scene.size])
    depth = axes.get("scene.depth_complexity") or [e.scene.depth_complexity]
    k = axes.get("k") or ([e.params["k"]] if "k" in e.params else [])
    r = axes.get("r") or ([e.params["r"]] if "r" in e.params else [])
    n = (f"n {_span(depth)}" if any(depth) else "") if not r else "n = k" if list(r) == [1] else f"n = {plain(r[0])} k"
    parts = (viewport, n, f"k {_span(k)}" if k else "", f"{sized.cells} cells")
    return ", ".join(filter(None, parts))


def _span(values: Sequence[Any]) -> str:
    ordered = sorted(set(values))
    return plain(ordered[0]) if len(ordered) == 1 else f"{plain(ordered[0])} … {plain(ordered[-1])}"
