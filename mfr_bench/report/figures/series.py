"""Selects the points that a figure shows, by panel and by label."""

from __future__ import annotations

import json
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import replace
from functools import cache
from typing import Any

from ...stats import Interval
from .. import data
from ..data import LOSES_TIES, Point, Result
from .kind import NothingToDraw

Options = Mapping[str, Any]


def series_of(result: Result, options: Options) -> list[Point]:
    """The points of a figure, labelled so that each label is one line or one bar per group.

    Raises NothingToDraw where there is none.
    """
    points = chosen(result, options)
    used = [n for n in (options["x"], options.get("panels")) if n]
    labelled = data.series(result, points, [*used, *_beside(options.get("panels"), options)])
    if options.get("gain_of"):
        return _gains(labelled, str(options["gain_of"]))
    passes = options.get("passes")
    return [replace(p, drawn=p.pass_ms(passes)) for p in labelled] if passes else labelled


def chosen(result: Result, options: Options) -> list[Point]:
    """The points of a figure's methods, else of all but the floor. Raises NothingToDraw where there is none."""
    wanted = options.get("methods")
    found = [p for p in result.points if (of_methods(p, wanted) if wanted else not data.is_floor(p))]
    if found:
        return found
    if not result.points:
        raise NothingToDraw("no cell was measured")
    if wanted:
        raise NothingToDraw(f"no cell is of a method of this figure: {data.listed(wanted)}")
    raise NothingToDraw("no cell is of another method than the floor")


def of_methods(point: Point, wanted: Collection[str]) -> bool:
    """Whether a point is of one of these methods, which are told by id or by label."""
    return point.method in wanted or point.label in wanted or point.cell["label"] in wanted


def _gains(points: Sequence[Point], name: str) -> list[Point]:
    """The points at any but the first value of a parameter, with what they gain over it, in percent of its speed."""
    first = next((p.at(name) for p in points if p.at(name) is not None), None)
    bases = {_but(p, name): p for p in points if p.at(name) == first}
    return [replace(p, drawn=_gain(bases.get(_but(p, name)), p)) for p in points if p.at(name) not in (first, None)]


def _but(point: Point, name: str) -> str:
    """All that makes a point but a parameter and those of how it acts: of `occupancy` also `occupancy_bounds`."""
    params = {key: value for key, value in point.cell["params"].items()
              if key != name and not key.startswith(f"{name}_")}
    return json.dumps([point.method, params, point.cell["scene"], point.row["device"]], sort_keys=True)


def _gain(base: Point | None, point: Point) -> Interval:
    if base is None or base.status != "ok" or point.status != "ok":
        return data.NOTHING
    return tuple(None if end is None else 100 * (end - 1) for end in data.time_ratio(base.cell, point.cell))


def y_text(options: Options) -> str:
    """The label of the y axis."""
    if options.get("y_label"):
        return str(options["y_label"])
    if options.get("gain_of"):
        return f"gain by {data.short(options['gain_of'])} (%)"
    passes = options.get("passes")
    return f"time of the {passes[0]} pass (ms)" if passes else data.MEASURES[options["y"]]


def _beside(name: str | None, options: Options) -> list[str]:
    """The axes that the config zips with this one, but for x: points of other values there are other points."""
    zipped = options.get("zip") or ()
    if not name or data.bare(name) not in map(data.bare, zipped):
        return []
    return [n for n in zipped if data.bare(n) not in (data.bare(name), data.bare(options["x"]))]


def panels_of(points: Sequence[Point], options: Options) -> list[tuple[str, list[Point]]]:
    """Points by panel, with its heading; methods that the panel's parameter does not touch are in each.

    Axes that are zipped with that of the panels split them further, but for one that x goes along with. A heading has
    their numbers, and whatever else tells panels of one value apart.
    """
    name = options.get("panels")
    if not name:
        return [("", list(points))]
    axes = [name, *(n for n in _beside(name, options) if not _along(points, name, n, options["x"]))]
    places = [tuple(p.at(n) for n in axes) for p in points]
    found = [v for value in data.values(points, name) for v in dict.fromkeys(v for v in places if v[0] == value)]
    whole = [v for v in found if None not in v] or found
    if not whole:  # no cell has the axis: meshes have no n
        return [("", list(points))]
    return [(_heading(axes, v, [other for other in whole if other[0] == v[0]]),
             [p for p, at in zip(points, places, strict=True) if _within(at, v)]) for v in whole]


def _along(points: Sequence[Point], panels: str, axis: str, x: str) -> bool:
    """Whether the values of x are one to one with those of an axis, in each panel and label that has several."""
    found: dict[tuple[Any, str], set[tuple[Any, Any]]] = {}
    for p in points:
        found.setdefault((p.at(panels), p.label), set()).add((p.at(axis), p.at(x)))
    several = [pairs for pairs in found.values() if len({value for value, _ in pairs}) > 1]
    return bool(several) and all(len({pair[side] for pair in pairs}) == len(pairs)
                                 for pairs in several for side in (0, 1))


def _within(place: Sequence[Any], panel: Sequence[Any]) -> bool:
    """Whether a point belongs to a panel: None stands for each value of its axis."""
    return all(at in (value, None) for at, value in zip(place, panel, strict=True))


def _heading(axes: Sequence[str], place: Sequence[Any], alike: Sequence[Sequence[Any]]) -> str:
    """A panel in words; `alike` are the places that share its first value."""
    told = [at for at in range(1, len(axes))
            if isinstance(place[at], (int, float)) or len({other[at] for other in alike}) > 1]
    return ", ".join(data.heading(axes[at], place[at]) for at in (0, *told))


def labels_of(points: Iterable[Point]) -> list[str]:
    return list(dict.fromkeys(p.label for p in points))


def is_drawn(point: Point, y: str) -> bool:
    return point.ending.timed and point.shown(y)[1] is not None


def hold_drawn(points: Sequence[Point], y: str) -> None:
    """Raise NothingToDraw where none of the points of a figure has a value of y; with what kept them from it."""
    if not any(is_drawn(p, y) for p in points):
        raise NothingToDraw(" ".join([f"no cell has {data.column_of(y)}.", *refusals(points)]).rstrip("."))


def hold_along(points: Sequence[Point], axis: str) -> None:
    """Raise NothingToDraw where no point of a figure lies along its axis, as meshes do not along n."""
    if not data.values(points, axis):
        raise NothingToDraw(f"no cell has a value of {axis}, its axis")


def axis_label(name: str) -> str:
    names = {"n": "fragments per pixel, n", "k": "fragments kept per pixel, k", "p_d": "pixel density, p_d",
             "f_p": "fragment probability, f_p", "alpha": "opacity"}
    return names.get(data.short(name), data.short(name))


def gaps(points: Sequence[Point], x: str, panels: str | None) -> list[str]:
    """A sentence on the cells that are no points of a line: methods of which the same is to say are named together."""
    missing: dict[tuple[str, str], list[Point]] = {}
    for p in points:
        if p.status != "ok":
            missing.setdefault((p.label, p.sign), []).append(p)
    told: dict[str, list[str]] = {}
    for (label, sign), cells in missing.items():
        where = _at(x, cells, panels, [p for p in points if p.label == label])
        told.setdefault(f"{sign}{where}", []).append(label)
    texts = [f"{data.listed(labels)}: {what}" for what, labels in told.items()]
    return [f"Not drawn: {'; '.join(texts)}."] if texts else []


def _at(x: str, missing: Sequence[Point], panels: str | None, cells: Sequence[Point]) -> str:
    """Name the places where cells of a label are missing, unless all are: panels that lack all of them, then others."""
    if all(p.status != "ok" for p in cells):
        return ""
    parts, whole = [], []
    for panel in data.values(missing, panels) if panels else []:
        here = [p for p in missing if p.at(panels) == panel]
        if len(here) == sum(p.at(panels) == panel for p in cells):
            whole.append(panel)
        else:
            parts.append(f"{data.heading(panels, panel)}, {_places(x, here)}")
    lone = _places(x, [p for p in missing if not panels or p.at(panels) is None])
    if whole:
        parts.insert(0, f"{data.short(panels)} = {', '.join(map(data.plain, whole))}")
    parts = [part.removesuffix(", ") for part in (*parts, lone) if part]
    return f" at {' and at '.join(parts)}" if parts else ""


def _places(x: str, points: Sequence[Point]) -> str:
    found = data.values(points, x)
    return f"{data.short(x)} = {', '.join(map(data.plain, found))}" if found else ""


def refusals(points: Iterable[Point]) -> list[str]:
    """Sentences on what the device cannot run, with what it lacks, and on wrong images, with what may explain them."""
    lacking: dict[str, list[str]] = {}
    wrong: dict[str, list[str]] = {}
    for p in points:
        reason = str(p.cell.get("reason") or "")
        if p.ending.refused and not p.ending.over_memory and reason:
            lacking.setdefault(reason, []).append(p.label)
        elif p.ending.image == "wrong":
            wrong.setdefault(LOSES_TIES if p.method in tie_losers() else "", []).append(p.label)
    told = [f"{data.listed(labels)}{f' ({reason})' if reason else ''}" for reason, labels in lacking.items()]
    said = [f"{data.listed(labels)}{f' ({why})' if why else ''}" for why, labels in wrong.items()]
    return [f"{sign}: {'; '.join(found)}." for sign, found in (("Unsupported", told), ("Wrong image", said)) if found]


@cache
def tie_losers() -> frozenset[str]:
    """The methods of the catalog that lose fragments of equal depth by nature."""
    from ...methods import catalog

    return frozenset(name for name, method in catalog().items() if method.loses_ties)
