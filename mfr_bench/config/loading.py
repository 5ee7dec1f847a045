"""Config files, found by path or by the name of a shipped one, read and checked."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from ..errors import UsageError, nearest, one_of
from ..methods.spec import Method
from ..resources import configs_dir
from .axes import R
from .check import check
from .layers import overlay, override_layer, profile_layer
from .model import Experiment
from .source import OVERRIDE, Document, Place, Problem, read

SUFFIXES = (".yaml", ".yml")


def load(reference: str, catalog: Mapping[str, Method], profile: str | None = None,
         overrides: Sequence[str] = ()) -> list[Experiment]:
    """The experiments of a file, of a folder of files, or of a shipped config.

    The profile is laid over each, then the overrides: KEY=VALUE, VALUE in YAML, where KEY is a parameter or a
    dotted key. Raises UsageError with a line for every mistake in any of them, profiles not asked for included.
    """
    settings, problems = override_layer(overrides)
    loader = _Reading(catalog, profile, settings)
    experiments = [loader.experiment(path) for path in find(reference)]
    problems += loader.problems
    if problems:
        raise UsageError(dict.fromkeys(map(str, sorted(problems, key=_reading_order))))
    return experiments


def shipped() -> dict[str, Path]:
    """The configs that come with the package, by name."""
    return {path.stem: path for path in _files(configs_dir())}


def stress_configs() -> dict[str, Path]:
    """The configs that put methods under stress, by name."""
    return {path.stem: path for path in _files(configs_dir() / "stress")}


def find(reference: str) -> list[Path]:
    """The files that a reference stands for, sorted. Raises UsageError where there is none."""
    path = Path(reference)
    try:
        if _is_there(path):
            files = _files(path) if path.is_dir() else [path]
            if not files:
                raise UsageError(f"{reference}: a folder without configs; allowed: a folder with *.yaml files")
            return files
    except OSError as error:  # a name too long, a folder that may not be entered
        raise UsageError(f"{reference}: {error.strerror}") from None
    names = shipped()
    if reference in names:
        return [names[reference]]
    if path.suffix in SUFFIXES or len(path.parts) > 1:
        raise UsageError(f"{reference}: no such file or folder{nearest(path.stem, names)}")
    raise UsageError(f"{reference}: no such file, folder or shipped config; "
                     f"{one_of(reference, names, 'mfr-bench configs')}")


def _is_there(path: Path) -> bool:
    """Whether there is something of this name. Raises OSError where that cannot be told, unlike `Path.exists` of
    Python 3.14."""
    try:
        path.stat()
    except (FileNotFoundError, NotADirectoryError, ValueError):  # the last: a NUL
        return False
    return True


def profile_names(references: Sequence[str]) -> list[str]:
    """The profiles of the configs, each once; none of a config that cannot be found or read."""
    found: dict[str, None] = {}
    for reference in references:
        try:
            texts = [path.read_text() for path in find(reference)]
        except (UsageError, OSError, UnicodeDecodeError):
            continue
        for text in texts:
            found.update(dict.fromkeys(read(text, reference)[0].mapping("profiles")))
    return list(found)


def _files(folder: Path) -> list[Path]:
    return sorted(p for p in folder.iterdir() if p.suffix in SUFFIXES and p.is_file())


def _reading_order(problem: Problem) -> tuple:
    return problem.place.file == OVERRIDE, problem.place.file, problem.place.line


def _new(found: Sequence[Problem], known: Sequence[Problem]) -> list[Problem]:
    """The problems at places that had none: a mistake is reported once, though a layer may change its words."""
    places = {problem.place for problem in known}
    return [problem for problem in found if problem.place not in places]


class _Reading:
    """Reads files with one profile and one set of overrides, and gathers what is wrong with them."""

    def __init__(self, catalog: Mapping[str, Method], profile: str | None, settings: Sequence):
        self.catalog, self.profile, self.settings = catalog, profile, settings
        self.parameters = tuple(dict.fromkeys((R.name, *(p.name for m in catalog.values() for p in m.params))))
        self.problems: list[Problem] = []
        self.names: dict[str, Path] = {}  # names taken, and by which file

    def experiment(self, path: Path) -> Experiment | None:
        document = self._read(path)
        if document is None:
            return None
        experiment, found = check(document, self.catalog, path)
        self.problems += found
        profiles = {name: self._profile(document, name, found, path) for name in document.mapping("profiles")}
        if self.profile is not None:
            if self.profile not in profiles:
                self.problems.append(Problem(document.place(("profiles",)), f"no profile {self.profile!r}; allowed: "
                                     f"{', '.join(profiles) or 'none; leave out --profile'}"
                                     f"{nearest(self.profile, profiles)}"))
                return None
            document, experiment, found = profiles[self.profile]
        if self.settings:
            document, problems = overlay(document, self.settings, self.parameters)
            experiment, all_found = check(document, self.catalog, path)
            self.problems += problems + _new(all_found, found)
        if experiment and self.names.setdefault(experiment.name, path) != path:
            self.problems.append(Problem(document.place(("name",)), f"{experiment.name!r} is also the name in "
                                 f"{self.names[experiment.name]}; allowed: a name of its own"))
        return experiment and replace(experiment, profile=self.profile)

    def _read(self, path: Path) -> Document | None:
        try:
            text = path.read_bytes().decode("utf-8-sig")
        except OSError as error:
            self.problems.append(Problem(Place(str(path), 1, ""), f"cannot be read: {error.strerror}"))
            return None
        except UnicodeDecodeError as error:
            line = error.object.count(b"\n", 0, error.start) + 1
            self.problems.append(Problem(Place(str(path), line, ""), "not UTF-8 text"))
            return None
        document, problems = read(text, str(path))
        self.problems += problems
        return None if document.data is None and problems else document

    def _profile(self, base: Document, name: str, known: Sequence[Problem],
                 path: Path) -> tuple[Document, Experiment | None, list[Problem]]:
        """Check the base under a profile. The profile's own mistakes are reported at its lines."""
        document, problems = overlay(base, profile_layer(base, name), self.parameters)
        experiment, found = check(document, self.catalog, path)
        home = base.place(("profiles", name))
        for problem in problems + _new(found, known):
            inside = problem.place.key.startswith(f"{home.key}.")
            self.problems.append(problem if inside else Problem(home, f"{problem.place.key}: {problem.what}"))
        return document, experiment, found
