"""The section of docs/conformance.md on triangles: every mesh, view and effect, and how many of its pixels are tied."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence

from ..methods.spec import Variant
from . import data
from .data import Point, number
from .data.words import percent
from .tables import Grid

SECTION = """## Triangles

Results of `mfr-bench run conformance-triangles`, a row for each mesh, view and effect. Tied is the share of covered
pixels in which fragments of equal depth leave the image open (see [Equal depths](scenes.md#equal-depths)); those of
equal colours leave nothing open, whatever their opacities. The error is the largest of all exact methods outside of
tied pixels, the tied error that among them. Methods that lose all but one of the fragments of a depth are wrong where
faces coincide, of one colour too."""
HEADER = ("mesh", "view", "pixels", "effect", "fragments", "most", "tied", "exact methods", "max error", "tied error",
          "wrong")
OF_KIND = "mesh"


def is_of_mesh(point: Point) -> bool:
    """Whether the point is one of a mesh, which stands in this section alone."""
    return point.cell["scene"].get("kind") == OF_KIND


def section(series: Mapping[str, Sequence[Point]], variants: Mapping[str, Variant], about: Sequence[str],
            left_out: Sequence[str]) -> list[str]:
    """The parts of the section; `about` tells where the results are from, `left_out` what was not run."""
    scenes: dict[str, list[tuple[Variant, Point]]] = {}
    for label, points in series.items():
        for p in points:
            scenes.setdefault(json.dumps(p.cell["scene"], sort_keys=True), []).append((variants[label], p))
    if not scenes:
        return []
    rows = [_row(found) for found in scenes.values()]
    return [SECTION, *about, Grid("", "", HEADER, tuple(rows), left=4).markdown(),
            "Of what was not run on triangles:", "\n".join(left_out)]


def _row(found: Sequence[tuple[Variant, Point]]) -> tuple[str, ...]:
    """A scene: what its exact methods, of all layers or of the k nearest, made of it."""
    first = found[0][1]
    exact = [p for variant, p in found if variant.guarantee.startswith("exact") and p.ending.timed]
    right = sum(p.ending.image == "right" for p in exact)
    wrong = [p.label for _, p in found if p.ending.image == "wrong"]
    return (", ".join(f"`{name}`" for name in first.cell["scene"]["files"]), _view(first),
            data.plain(tuple(first.cell["scene"]["size"])), _effect(first),
            _most(exact, "fragments"), _most(exact, "max_fragments"), percent(max(map(_tied, exact), default=0.0)),
            f"{right} of {len(exact)}", _most(exact, "max_abs_error"), _most(exact, "tied_error"), ", ".join(wrong))


def _most(points: Sequence[Point], column: str) -> str:
    """The largest value of a column; empty where no point has one."""
    values = [p.row[column] for p in points if p.ending.image != "wrong" and p.row[column] is not None]
    return number(max(values, default=None), 2)


def _tied(point: Point) -> float:
    return point.measure("tied_share")[1] or 0.0


def _view(point: Point) -> str:
    """The view, and the range of depths where it is not the default."""
    view, depths = point.cell["scene"].get("view") or {}, point.cell["scene"].get("depth_range")
    seen = f"from {' '.join(f'{x:g}' for x in view['eye'])}" if view.get("eye") else str(view.get("direction", ""))
    words = (f"{view.get('projection', '')} {seen}".strip(), f"{depths} depths" if depths else "")
    return ", ".join(filter(None, words))


def _effect(point: Point) -> str:
    scene = point.cell["scene"]
    if (msaa := scene.get("msaa", 1)) > 1:
        return f"{msaa} samples, coverage {scene.get('coverage', 'samples')}"
    effect = scene.get("effect", "transparency")
    return f"{effect}, {scene.get('operation', 'union')}" if effect == "csg" else effect
