"""A profile or `--set` strings laid over a config, each value keeping the place it was written at."""

from __future__ import annotations

import copy
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, fields
from typing import Any

from ..errors import nearest
from ..scene import Scene
from .model import Source
from .settings import Measure
from .source import OVERRIDE, Document, Path, Place, Problem, read

TOP = ("name", "title", "source", "scene", "params", "methods", "sweep", "zip", "measure", "figures", "profiles")
REPLACEABLE = TOP[:-1]
SECTIONS = ("source", "scene", "params", "sweep", "zip", "measure")
AXES = ("sweep", "zip")
SWEPT = ("scene", "measure")  # sections whose keys are no axis by their names alone
KEYS = tuple(f"{section}.{f.name}" for section, cls in (("source", Source), ("scene", Scene), ("measure", Measure))
             for f in fields(cls))


@dataclass(frozen=True)
class Setting:
    """A value for a key, `k` or dotted; the document's places are relative to the value."""

    key: str
    value: Document


def profile_layer(document: Document, name: str) -> list[Setting]:
    """The settings of a profile of the document."""
    return [Setting(key, Document(value, document.below(("profiles", name, key))))
            for key, value in document.mapping("profiles", name).items()]


def override_layer(overrides: Sequence[str]) -> tuple[list[Setting], list[Problem]]:
    """The settings in KEY=VALUE strings; VALUE is YAML."""
    layer, problems = [], []
    for text in overrides:
        key, equals, value = text.partition("=")
        if not key.strip() or not equals:
            problems.append(Problem(Place(OVERRIDE, 0, text), "not a setting; allowed: KEY=VALUE, such as k=8"))
            continue
        document, found = read(value, OVERRIDE, key.strip())
        problems += found
        if not found:
            layer.append(Setting(key.strip(), document))
    return layer, problems


def overlay(base: Document, layer: Iterable[Setting], parameters: Sequence[str]) -> tuple[Document, list[Problem]]:
    """A new document with the layer's values in place; `parameters` are the names that need no `params.`.

    A key set to one value stops being an axis, unless the same layer gives it one; where a figure draws along it, it
    stays one with a single value. What is zipped with it keeps its values at the points that had this value, if any.
    """
    document = Document(copy.deepcopy(base.data) if isinstance(base.data, dict) else {}, dict(base.places))
    problems = []
    for setting in sorted(layer, key=lambda s: s.key.startswith(AXES)):
        path = _target(setting.key, parameters)
        if path is None:
            known = (*REPLACEABLE, *KEYS, *parameters)
            problems.append(Problem(setting.value.place(()), "unknown key; allowed: a key of the config, dotted "
                                    f"(scene.size), or a parameter{nearest(setting.key, known)}"))
        else:
            dropped = _drop_rivals(document, path, setting.value.data)
            _put(document, path, setting.value)
            for axis in dropped & _drawn(document):
                _put(document, ("sweep", axis), _listed(setting.value))
    return document, problems


def _target(key: str, parameters: Sequence[str]) -> Path | None:
    section, _, rest = key.partition(".")
    if section in SECTIONS and rest:
        return section, rest
    if key in REPLACEABLE:
        return (key,)
    return ("params", key) if key in parameters else None


def _put(document: Document, path: Path, value: Document) -> None:
    holder = document.data
    for key in path[:-1]:
        if not isinstance(holder.get(key), dict):
            holder[key] = {}
            document.places.setdefault(path[:1], value.place(()))
        holder = holder[key]
    holder[path[-1]] = copy.deepcopy(value.data)
    _forget(document, path)
    document.places.update({path + below: place for below, place in value.places.items()})


def _drop_rivals(document: Document, path: Path, value: Any) -> set[str]:
    """Remove what would decide the same thing as `path`, and return the axis of that name if it was one.

    This is an axis of that name, and r where the scene's n is set.
    """
    if len(path) == 1:
        return set()
    section, key = path
    axis = key if section in ("params", *AXES) else f"{section}.{key}"
    if section not in AXES:
        _narrow(document, axis, value)
    rivals = [(s, axis) for s in AXES]
    if axis == "scene.depth_complexity":
        rivals += [(s, "r") for s in ("params", *AXES)]
    if axis == "r":
        rivals += [(s, "scene.depth_complexity") for s in AXES] + [("params", "r")]
    dropped = {(s, k) for s, k in rivals if document.mapping(s).pop(k, None) is not None}
    for rival in dropped:
        _forget(document, rival)
    return {axis} if section in SWEPT and dropped & {(s, axis) for s in AXES} else set()


def _narrow(document: Document, axis: str, value: Any) -> None:
    """Leave of all that is zipped with the axis the points at which it has the value, if there are any."""
    zipped = document.mapping("zip")
    lists = [values for values in zipped.values() if isinstance(values, list)]
    if axis not in zipped or len(lists) < len(zipped) or len({len(values) for values in lists}) > 1:
        return
    kept = [i for i, at in enumerate(zipped[axis]) if at == value]
    for key in zipped if kept else ():
        place = document.place(("zip", key))
        zipped[key] = [zipped[key][i] for i in kept]
        _forget(document, ("zip", key))
        document.places["zip", key] = place


def _drawn(document: Document) -> set[str]:
    """The names that figures of the document draw along."""
    figures = document.data.get("figures")
    return {named for figure in (figures if isinstance(figures, list) else []) if isinstance(figure, dict)
            for named in figure.values() if isinstance(named, str)}


def _listed(value: Document) -> Document:
    """A list of the one value, in its place."""
    return Document([value.data], {(): value.place(()), **{(0, *path): place for path, place in value.places.items()}})


def _forget(document: Document, path: Path) -> None:
    for known in [p for p in document.places if p[:len(path)] == path]:
        del document.places[known]
