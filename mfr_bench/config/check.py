"""A document -> an experiment, or every mistake in it at once."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import fields, replace
from pathlib import Path as FilePath
from typing import Any

from ..errors import not_allowed, one_of, shown
from ..methods.spec import Method, Value
from ..report.figures.kinds import KINDS, all_keys, keys_of
from ..scene import Scene
from ..scene.kinds import KINDS as SCENE_KINDS
from ..scene.kinds import faults, kind_of, own_keys
from ..scene.spec.kind import LOCAL, Fault
from .axes import K, R, measure_at, point_count, points, scene_at
from .columns import IDENTITY, MEASURED
from .json_schema import ConfigFile, allowed, parse
from .layers import AXES
from .model import Experiment
from .settings import KEPT, Measure, MethodEntry
from .source import Document, Path, Problem, dotted

EVERY_KEY = frozenset(key.name for key in all_keys())  # of figures of any kind
MAX_CELLS = 100_000
EVERY_METHOD = "all"  # in `methods:`, stands for each method of the catalog at its defaults
SWEPT_SECTIONS = {"scene": Scene, "measure": Measure}
LOCAL_KEYS = {f.name for f in fields(Scene) if f.metadata.get(LOCAL)}
SWEPT_KEYS = tuple(f"{section}.{f.name}" for section, cls in SWEPT_SECTIONS.items() for f in fields(cls)
                   if f.name not in LOCAL_KEYS)


def check(document: Document, catalog: Mapping[str, Method], path: FilePath) -> tuple[Experiment | None, list[Problem]]:
    """The experiment, None where there is any problem."""
    if not isinstance(document.data, dict):
        what = f"{shown(document.data)} is not a config; allowed: {allowed(ConfigFile)}"
        return None, [Problem(document.place(()), what)]
    checker = _Checker(document, catalog, str(path.parent))
    experiment = checker.experiment(path)
    return (None if checker.problems else experiment), checker.problems


class _Checker:
    """Goes through a document once, part by part; a part that is wrong does not hide mistakes in the next."""

    def __init__(self, document: Document, catalog: Mapping[str, Method], folder: str):
        self.document, self.catalog, self.folder = document, catalog, folder
        self.problems: list[Problem] = []
        self.entries: list[MethodEntry | None] = []  # None where the id is not known
        self.entry_paths: list[Path] = []  # where each entry is written
        self.params: dict[str, Value] = {}
        self.axes: dict[str, dict[str, tuple]] = {section: {} for section in AXES}

    def problem(self, path: Path, what: str) -> None:
        self.problems.append(Problem(self.document.place(path), what))

    def experiment(self, path: FilePath) -> Experiment | None:
        config, scene, measure = self._shape()
        methods_sound = self._adds_none(self._methods)
        axes_sound = self._adds_none(self._params, self._axes, self._zip_lengths, self._depth_complexity, self._cells)
        self._figures()
        self._contradictions(scene, measure, points(*self.axes.values()) if axes_sound else ())
        if axes_sound and methods_sound:
            self._labels()
        if self.problems:
            return None
        first = next(points(self.axes["sweep"], self.axes["zip"]))
        return Experiment(
            config.name, config.title or config.name,
            {key: value for key, value in config.source.as_dict().items() if value},
            scene_at(scene, self.params, first) if self._has("r") else scene, self.params, tuple(self.entries),
            self.axes["sweep"], self.axes["zip"], measure, config.figures, path)

    def _adds_none(self, *steps: Callable[[], None]) -> bool:
        """Whether the steps, all taken, find no problem."""
        before = len(self.problems)
        for step in steps:
            step()
        return len(self.problems) == before

    def _shape(self) -> tuple[ConfigFile | None, Scene | None, Measure | None]:
        """Keys, types and ranges of everything but methods, parameters and axes; what is sound of it."""
        data = dict(self.document.data)
        if isinstance(data.get("scene"), dict):
            kind = SCENE_KINDS.get(str(data["scene"].get("kind")))
            if self._has("r") or (kind and kind.measured):
                data["scene"] = {"depth_complexity": 0} | data["scene"]
        config, wrong = parse(ConfigFile, data)
        for path, what in wrong:
            self.problem(path, what)
        for key in LOCAL_KEYS & set(self.document.mapping("scene")):
            self._unknown(("scene", key), "unknown key", [f.name for f in fields(Scene) if f.name not in LOCAL_KEYS])
        scene = parse(Scene, data.get("scene"))[0]
        if scene and "folder" in own_keys(kind_of(scene)):
            scene = replace(scene, folder=self.folder)
        return config, scene, parse(Measure, data.get("measure", {}))[0]

    def _has(self, key: str) -> bool:
        return any(key in self.document.mapping(section) for section in ("params", *AXES))

    # methods

    def _methods(self) -> None:
        listed = self.document.data.get("methods")
        for i, entry in enumerate(listed if isinstance(listed, list) else []):
            path = ("methods", i)
            if entry == EVERY_METHOD:
                made = [MethodEntry(m.id, m.name, {}) for m in self.catalog.values()]
            else:
                made = [self._entry(path, {"id": entry} if isinstance(entry, str) else entry)]
            self.entries += made
            self.entry_paths += [path] * len(made)

    def _entry(self, path: Path, entry: Any) -> MethodEntry | None:
        if not isinstance(entry, dict) or "id" not in entry:
            self.problem(path, f"{not_allowed(entry)}; allowed: a method's id, '{EVERY_METHOD}', "
                               "or a mapping with id")
            return None
        method = self.catalog.get(entry["id"]) if isinstance(entry["id"], str) else None
        if method is None:
            self.problem(path, f"unknown method {shown(entry['id'])}; "
                               f"{one_of(str(entry['id']), self.catalog, 'mfr-bench methods')}")
            return None
        label = entry.get("label", method.name)
        if not isinstance(label, str) or not label:
            self.problem((*path, "label"), f"{not_allowed(label)}; allowed: text")
            label = method.name
        names = [p.name for p in method.params]
        params = {}
        for key, value in entry.items():
            if key in names:
                params[key] = self._value((*path, key), [method], key, value)
            elif key not in ("id", "label"):
                self._unknown((*path, key), f"unknown parameter of {method.id}", ("id", "label", *names))
        return MethodEntry(method.id, label, params)

    @property
    def _listed(self) -> list[Method]:
        """The methods listed, once each; all that there are where one is unknown, so that one mistake stays one."""
        if None in self.entries or not self.entries:
            return list(self.catalog.values())
        return [self.catalog[i] for i in dict.fromkeys(e.id for e in self.entries)]

    # parameters and axes

    def _known(self) -> dict[str, list[Method]]:
        """The methods that have each parameter, by its name: the listed ones where any of them has it."""
        known: dict[str, list[Method]] = {}
        for method in self._listed:
            for param in method.params:
                known.setdefault(param.name, []).append(method)
        listed = {entry.id for entry in self.entries if entry}
        known = {name: [m for m in methods if m.id in listed] or methods for name, methods in known.items()}
        return known | {"r": []} | ({"k": known.get("k", [])} if self._has("r") else {})

    def _params(self) -> None:
        known = self._known()
        for key, value in self.document.mapping("params").items():
            if key in known:
                self.params[key] = self._value(("params", key), known[key], key, value)
            else:
                self._unknown(("params", key), "no listed method has this parameter", known)

    def _axes(self) -> None:
        known = self._known()
        for section in AXES:
            for key, values in self.document.mapping(section).items():
                path = (section, key)
                if key not in known and key not in SWEPT_KEYS:
                    self._unknown(path, "nothing has this key to sweep", (*known, *SWEPT_KEYS))
                elif not isinstance(values, list):
                    self.problem(path, f"{not_allowed(values)}; allowed: a list of values")
                elif not values:
                    self.problem(path, "a sweep over nothing; allowed: a list of at least one value")
                elif section == "zip" and key in self.axes["sweep"]:
                    self.problem(path, "already an axis of sweep; allowed: one of the two")
                else:
                    self.axes[section][key] = tuple(self._axis_value((*path, i), key, value, known)
                                                    for i, value in enumerate(values))

    def _axis_value(self, path: Path, key: str, value: Any, known: Mapping[str, list[Method]]) -> Any:
        if key in known:
            return self._value(path, known[key], key, value)
        section, _, name = key.partition(".")
        rest = {"size": [1, 1], "depth_complexity": 1} if section == "scene" else {}
        parsed, wrong = parse(SWEPT_SECTIONS[section], rest | {name: value})
        for _, what in wrong:
            self.problem(path, what)
        return getattr(parsed, name, value)

    def _value(self, path: Path, methods: Iterable[Method], key: str, value: Any) -> Any:
        """The value as the methods that have the parameter take it."""
        params = [(m.id, m.param(key)) for m in methods] or [("", {"r": R, "k": K}[key])]
        refusals: dict[str, list[str]] = {}
        for owner, param in params:
            try:
                canonical = param.parse(value)
            except ValueError as error:
                refusals.setdefault(str(error), []).append(owner)
        for what, owners in refusals.items():
            self.problem(path, what if len(owners) == len(params) else f"{', '.join(owners)}: {what}")
        return value if refusals else canonical

    def _unknown(self, path: Path, what: str, names: Iterable[str]) -> None:
        self.problem(path, f"{what}; {one_of(str(path[-1]), names)}")

    def _zip_lengths(self) -> None:
        lengths = {key: len(values) for key, values in self.axes["zip"].items()}
        if len(set(lengths.values())) > 1:
            each = ", ".join(f"{key} has {n}" for key, n in lengths.items())
            self.problem(("zip",), f"lists of unequal length: {each}; allowed: one length for all")

    def _depth_complexity(self) -> None:
        """r needs a k to multiply, and sets what a sweep of the scene's own depth complexity would."""
        for section in ("params", *AXES):
            if "r" in self.document.mapping(section):
                if not self._has("k"):
                    self.problem((section, "r"), "no k for n = r·k; allowed: k in params, sweep or zip")
                if any("scene.depth_complexity" in self.document.mapping(axes) for axes in AXES):
                    self.problem((section, "r"), "the sweep of scene.depth_complexity sets n too; allowed: one of them")

    # figures

    def _figures(self) -> None:
        figures = self.document.data.get("figures")
        for i, figure in enumerate(figures if isinstance(figures, list) else []):
            if isinstance(figure, dict):
                self._figure(("figures", i), figure)

    def _figure(self, path: Path, figure: dict[str, Any]) -> None:
        kind = KINDS.get(str(figure.get("kind")))
        if kind is None:
            return
        axes = [key for section in AXES for key in self.document.mapping(section)]
        along = tuple(dict.fromkeys((*axes, *self._known(), *IDENTITY, *MEASURED)))
        names = {"": (), "column": along, "parameter": tuple(self._known())}
        columns = {"x": kind.x or along, "y": (*(kind.y or MEASURED), *kind.other_y)} | {
            key.name: names[key.names] for key in keys_of(kind) if key.names}
        for key, allowed_names in columns.items():
            if key in kind.needs and key not in figure:
                self.problem((*path, key), f"missing; allowed: {', '.join(allowed_names)}")
            elif isinstance(figure.get(key), str) and figure[key] not in allowed_names:
                self.problem((*path, key), _no_column(figure[key], allowed_names))
        drawn = ["kind", "x", "y", *(key.name for key in keys_of(kind))]
        for key in [key for key in figure if key not in drawn and key in EVERY_KEY]:
            self._unknown((*path, key), f"no use in a figure of kind {figure['kind']}", drawn)
        kept = self.document.mapping("measure").get("keep") or ()
        array = figure.get("y")
        if kind.arrays and array in KEPT and array not in kept:
            self.problem((*path, "y"), f"no cell keeps the array {array}; allowed: with {array} in measure.keep")
        if self.entries and None not in self.entries:
            self._picked((*path, "methods"), figure.get("methods"))

    def _picked(self, path: Path, picked: Any) -> None:
        """The labels that a figure picks have to be those of methods; all that are not make one problem."""
        labels = [entry.label for entry in self.entries if entry]
        unknown = {j: label for j, label in enumerate(picked if isinstance(picked, list) else [])
                   if isinstance(label, str) and label not in labels}
        if len(unknown) == 1:
            (j, label), = unknown.items()
            self.problem((*path, j), f"no method has the label {shown(label)}; {one_of(label, labels)}")
        elif unknown:
            self.problem(path, f"no method has any of the labels {', '.join(map(shown, unknown.values()))}; "
                               f"allowed: {', '.join(labels)}")

    # cells

    def _cells(self) -> None:
        cells = point_count(self.axes["sweep"], self.axes["zip"]) * len(self.entries)
        if cells > MAX_CELLS:
            where = next((section for section in AXES if self.axes[section]), "methods")
            self.problem((where,), f"{cells} cells; allowed: at most {MAX_CELLS}")

    def _labels(self) -> None:
        for i, entry in enumerate(self.entries):
            for j, other in enumerate(self.entries[:i]):
                if entry.label == other.label and not self._alike(entry, other):
                    self.problem(self.entry_paths[i],
                                 f"the label {entry.label!r} is also that of {dotted(self.entry_paths[j])}; "
                                                 "allowed: a label of its own (label: ...)")
                    break

    def _alike(self, entry: MethodEntry, other: MethodEntry) -> bool:
        """Whether the entries make the same cells."""
        if entry.id != other.id:
            return False
        method = self.catalog[entry.id]
        return entry.params == other.params or all(
            method.complete({**self.params, **point, **entry.params})
            == method.complete({**self.params, **point, **other.params})
            for point in points(self.axes["sweep"], self.axes["zip"]))

    def _contradictions(self, scene: Scene | None, measure: Measure | None, along: Iterable[Mapping[str, Any]]) -> None:
        """The faults of values that are each allowed, at the points or, without any, in the config itself."""
        along = list(along)
        scenes = {scene_at(scene, self.params, point) for point in along} or {scene} if scene else ()
        measures = {measure_at(measure, point) for point in along} or {measure} if measure else ()
        found = [fault for scene in scenes for fault in faults(scene)]
        found += [fault for rule in MEASURE_RULES for fault in map(rule, measures) if fault]
        for keys, what in dict(sorted(found)).items():  # one point of each kind is enough
            self.problem(self._written(keys), what)

    def _written(self, keys: Iterable[str]) -> Path:
        """The path of the first of these keys that the config has, an axis before a fixed value."""
        paths = [(section, key) for key in keys for section in (*AXES, "params")]
        paths += [tuple(key.split(".")) for key in keys]
        return next(path for path in paths if path[-1] in self.document.mapping(*path[:-1]))


def _no_column(name: str, allowed_names: Iterable[str]) -> str:
    """The mistake of a figure along a name that is no column: a key that could be swept, and is not, or none."""
    if name in SWEPT_KEYS:
        return f"nothing sweeps {name}; allowed: a list of values for it in sweep or zip, or a figure along another key"
    return f"unknown column {shown(name)}; {one_of(name, allowed_names)}"


def _too_few_samples(measure: Measure) -> Fault | None:
    what = f"{measure.min_samples} to {measure.max_samples} samples; allowed: min_samples up to max_samples"
    return (("measure.max_samples", "measure.min_samples"), what) if measure.min_samples > measure.max_samples else None


def _ended_early(measure: Measure) -> Fault | None:
    if measure.longest_s >= measure.time_limit_s:
        return None
    what = f"{measure.longest_s:g} s for a cell, {measure.time_limit_s:g} s for its frames; allowed: at least as much"
    return ("measure.hard_limit_s", "measure.time_limit_s"), what


MEASURE_RULES = (_too_few_samples, _ended_early)
