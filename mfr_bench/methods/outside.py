"""Methods, effects and scenes of packages and folders outside: found, and declared without their code running here.

A package names itself by an entry point of the group `mfr_bench.methods`; a folder is named by `--methods` or the
environment variable MFR_BENCH_METHODS. A process of its own imports the declarations (`mfr_bench.outside.loader`) and
sends them here as data, so that one which crashes or hangs costs itself alone. A config names neither.
"""

from __future__ import annotations

import io
import os
import pickle
import subprocess
import sys
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cache
from importlib.metadata import entry_points
from pathlib import Path
from typing import Any

from ..effects import Case, Effect
from ..errors import UsageError
from .spec import Method
from .spec.maker import Maker

GROUP = "mfr_bench.methods"
VARIABLE = "MFR_BENCH_METHODS"  # folders, with the system's separator of paths between
PROGRAM = ("import sys; sys.path[:] = sys.argv.pop().split(':'); from mfr_bench.orphans import die_with; "
           "die_with(int(sys.argv.pop())); from mfr_bench.outside.{} import main; main()")
LONGEST_S = 60.0  # for a package to declare its methods
PLAIN = {"builtins": {"set", "frozenset", "slice", "complex", "bytearray"}, "functools": {"partial"}}
OF_EFFECTS = {"Effect": Effect, "Case": Case}  # the words of an effect's entry


@dataclass(frozen=True)
class Source:
    """The source of methods: an entry point's module, or a folder. `name` is that of its package."""

    name: str
    version: str | None
    module: str = ""
    folder: str = ""


@dataclass(frozen=True)
class Loaded:
    """The declarations of a source: its methods in order, its effects and scenes by name, its folder of GLSL, and a
    line for each mistake."""

    source: Source
    methods: tuple[Method, ...] = ()
    effects: Mapping[str, Effect] = field(default_factory=dict)
    scenes: Mapping[str, Maker] = field(default_factory=dict)
    shaders: Path | None = None
    mistakes: tuple[str, ...] = ()


def use(folders: Sequence[str]) -> None:
    """Let this process and those that it starts find methods in these folders too.

    Raises UsageError for a folder whose path the environment variable cannot hold.
    """
    for folder in folders:
        if os.pathsep in str(Path(folder).resolve()):
            raise UsageError(f"--methods {folder}: its path has a {os.pathsep!r}, which separates folders in "
                             f"{VARIABLE}; allowed: a path without")
    given = [*filter(None, os.environ.get(VARIABLE, "").split(os.pathsep)), *(str(Path(f).resolve()) for f in folders)]
    os.environ[VARIABLE] = os.pathsep.join(dict.fromkeys(given))
    loaded.cache_clear()


@cache
def loaded() -> tuple[Loaded, ...]:
    """The declarations of every source, the installed packages first."""
    return tuple(_loaded(source) for source in sources())


def scene_makers() -> dict[str, Maker]:
    """The makers of scenes, by name; a name that several sources have is that of the first."""
    return {name: maker for each in reversed(loaded()) for name, maker in each.scenes.items()}


def program(main: str, *arguments: str) -> list[str]:
    """The command of a child that runs code from outside, by a module of mfr_bench.outside, as long as this lives."""
    return [sys.executable, "-c", PROGRAM.format(main), *arguments, str(os.getpid()), ":".join(sys.path)]


def shader_folders() -> list[Path]:
    """The folders of GLSL that the sources bring."""
    return [each.shaders for each in loaded() if each.shaders]


def sources() -> list[Source]:
    """The entry points of all installed packages, and the folders that the user names."""
    found = {(point.dist.name, point.value): Source(point.dist.name, point.dist.version, module=point.module)
             for point in entry_points(group=GROUP)}
    folders = filter(None, os.environ.get(VARIABLE, "").split(os.pathsep))
    return [*(found[key] for key in sorted(found)),
            *(Source(Path(folder).name, None, folder=folder) for folder in dict.fromkeys(folders))]


def _loaded(source: Source) -> Loaded:
    """Ask a process of its own what the source declares; whatever becomes of that process is one line."""
    place = source.folder or source.module
    with tempfile.TemporaryFile() as answer:
        command = program("loader", str(answer.fileno()), "folder" if source.folder else "module", place)
        try:
            ended = subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True,
                                   pass_fds=[answer.fileno()], timeout=LONGEST_S, check=False)
        except subprocess.TimeoutExpired:
            return Loaded(source, mistakes=(f"{place}:1: does not end within {LONGEST_S:g} s when it is imported",))
        answer.seek(0)
        content = answer.read()
    try:
        return _checked(source, Reader(io.BytesIO(content)).load())
    except Exception:  # noqa: BLE001 - half an answer, or none
        said = ended.stderr.decode(errors="replace").strip().splitlines()
        last = f": {said[-1]}" if said else ""
        return Loaded(source, mistakes=(f"{place}:1: its import ends the process (status {ended.returncode}){last}",))


def _checked(source: Source, answer: Any) -> Loaded:
    package = {"name": source.name, "version": source.version, "hash": str(answer["hash"])}
    methods = tuple(replace(method, package=package) for method in answer["methods"] if isinstance(method, Method))
    effects = {str(name): replace(effect, package=package) for name, effect in answer["effects"].items()
               if isinstance(effect, Effect)}
    scenes = {str(name): replace(maker, package=package) for name, maker in answer["scenes"].items()
              if isinstance(maker, Maker)}
    shaders = Path(answer["shaders"]) if answer["shaders"] else None
    return Loaded(source, methods, effects, scenes, shaders, tuple(map(str, answer["mistakes"])))


class Reader(pickle.Unpickler):  # noqa: S301 - `find_class` lets nothing else in
    """Reads declarations: data of this package's vocabulary, and its own functions by name."""

    def find_class(self, module: str, name: str):
        if name in PLAIN.get(module, ()):
            return super().find_class(module, name)
        if module == Effect.__module__ and name in OF_EFFECTS:
            return OF_EFFECTS[name]
        if module.startswith("mfr_bench.methods.") and "." not in name:
            found = super().find_class(module, name)
            if getattr(found, "__module__", "").startswith("mfr_bench.methods."):  # not what a module has imported
                return found
        raise pickle.UnpicklingError(f"{module}.{name} is no part of a declaration")
