"""YAML text -> plain values that remember the file, line and key that each came from."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any, ClassVar

import yaml

OVERRIDE = "--set"
MAX_NODES, MAX_DEPTH = 200_000, 32  # aliases of aliases can make a short text endless

Path = tuple[str | int, ...]  # keys and list indices from the top of a config


@dataclass(frozen=True)
class Place:
    """The place where a value was written. The file is `--set`, without a line, for an override."""

    file: str
    line: int
    key: str

    def __str__(self) -> str:
        if self.file == OVERRIDE:
            return f"{OVERRIDE} {self.key}"
        return f"{self.file}:{self.line}" + (f": {self.key}" if self.key else "")


@dataclass(frozen=True)
class Problem:
    """One mistake, as the user reads it."""

    place: Place
    what: str

    def __str__(self) -> str:
        line = f"{self.place}: {self.what}"
        return "".join(c if c.isprintable() else repr(c)[1:-1] for c in line)


def dotted(path: Path, start: str = "") -> str:
    """The path as a user writes it: scene.size[0]."""
    text = start
    for part in path:
        text += f"[{part}]" if isinstance(part, int) else f".{part}" if text else str(part)
    return text


@dataclass
class Document:
    """Plain values, and the place of every one that was written."""

    data: Any
    places: dict[Path, Place] = field(default_factory=dict)

    def place(self, path: Path) -> Place:
        """The place where `path` was written; for what is missing, the line of what should hold it."""
        for length in range(len(path), -1, -1):
            found = self.places.get(path[:length])
            if found:
                return Place(found.file, found.line, dotted(path[length:], found.key))
        raise KeyError(path)

    def mapping(self, *path: str) -> dict[str, Any]:
        """The mapping at `path`, empty where there is none."""
        value = self.data
        for key in path:
            value = value.get(key) if isinstance(value, dict) else None
        return value if isinstance(value, dict) else {}

    def below(self, path: Path) -> dict[Path, Place]:
        """Places of `path` and of what it holds, relative to it."""
        return {p[len(path):]: place for p, place in self.places.items() if p[:len(path)] == path}


class _Loader(yaml.SafeLoader):
    """YAML 1.1 as PyYAML reads it, but 1e-3 is a number, 010 is ten, and 2015-01-01 and 1:30 are texts."""

    yaml_implicit_resolvers: ClassVar = {
        first: [(tag, pattern) for tag, pattern in known
                if tag not in ("tag:yaml.org,2002:timestamp", "tag:yaml.org,2002:int")]
        for first, known in yaml.SafeLoader.yaml_implicit_resolvers.items()}


_Loader.add_implicit_resolver("tag:yaml.org,2002:float",
                              re.compile(r"[-+]?(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)[eE][-+]?[0-9]+$"),
                              list("-+.0123456789"))
_Loader.add_implicit_resolver("tag:yaml.org,2002:int", re.compile(r"[-+]?(?:[0-9][0-9_]*|0x[0-9a-fA-F_]+)$"),
                              list("-+0123456789"))
_Loader.add_constructor("tag:yaml.org,2002:int", lambda loader, node: _whole_number(node.value.replace("_", "")))


def _whole_number(text: str) -> int:
    """The number, in decimal but for 0x; YAML 1.1 would read 010 as eight."""
    return int(text, 16 if "0x" in text else 10)


def read(text: str, file: str, key: str = "") -> tuple[Document, list[Problem]]:
    """The document in `text`, and what is wrong with it as YAML; `key` is that of the whole document."""
    top = Place(file, 1, key)
    try:
        loader = _Loader(text)
        node = loader.get_single_node()
        reader = _Reader(loader, file, key)
        data = reader.value(node, ()) if node is not None else None
    except yaml.MarkedYAMLError as error:
        return Document(None, {(): top}), [_syntax_problem(error, top)]
    except yaml.reader.ReaderError as error:
        line = text.count("\n", 0, error.position) + 1
        return Document(None, {(): top}), [Problem(Place(file, line, key), f"not valid YAML: {error.reason}")]
    except (RecursionError, _TooLargeError):
        return Document(None, {(): top}), [Problem(top, "nested or repeated too deeply to be a config")]
    return Document(data, reader.places | {(): top}), reader.problems


def _syntax_problem(error: yaml.MarkedYAMLError, top: Place) -> Problem:
    mark = error.problem_mark or error.context_mark
    what = " ".join(filter(None, (error.context, error.problem)))
    return Problem(Place(top.file, mark.line + 1 if mark else 1, top.key), f"not valid YAML: {what}")


class _TooLargeError(Exception):
    pass


class _Reader:
    """Turns nodes into values, noting places, repeated keys and values that no config needs."""

    def __init__(self, loader: yaml.SafeLoader, file: str, key: str):
        self.loader, self.file, self.key = loader, file, key
        self.places: dict[Path, Place] = {}
        self.problems: list[Problem] = []
        self.nodes = 0

    def value(self, node: yaml.Node, path: Path) -> Any:
        self.nodes += 1
        if self.nodes > MAX_NODES or len(path) > MAX_DEPTH:
            raise _TooLargeError
        if isinstance(node, yaml.ScalarNode):
            return self._scalar(node, path)
        if node.tag not in ("tag:yaml.org,2002:map", "tag:yaml.org,2002:seq"):
            self._problem(node, path, f"the tag {node.tag} is not allowed")
            return None
        if isinstance(node, yaml.SequenceNode):
            return [self._item(child, (*path, i)) for i, child in enumerate(node.value)]
        return {key: self._item(child, (*path, key), line) for key, child, line in self._pairs(node, path)}

    def _item(self, node: yaml.Node, path: Path, line: int | None = None) -> Any:
        self.places[path] = Place(self.file, line or node.start_mark.line + 1, dotted(path, self.key))
        return self.value(node, path)

    def _scalar(self, node: yaml.ScalarNode, path: Path) -> Any:
        try:
            node.value.encode()
            return self.loader.construct_object(node)
        except (yaml.constructor.ConstructorError, ValueError) as error:
            self._problem(node, path, getattr(error, "problem", None) or str(error))
            return None

    def _pairs(self, node: yaml.MappingNode, path: Path) -> Iterator[tuple[str, yaml.Node, int]]:
        """Key, value and line of the key; a `<<` merge counts where the mapping itself lacks the key."""
        first: dict[str, int] = {}
        for key, _ in node.value:
            if not isinstance(key, yaml.ScalarNode):
                self._problem(key, path, "a key must be a single word")
            elif key.value in first:
                where = f"{dotted(path, self.key)}.{key.value}".lstrip(".")
                self.problems.append(Problem(Place(self.file, key.start_mark.line + 1, where),
                                             f"the key is repeated, first on line {first[key.value]}"))
            else:
                first[key.value] = key.start_mark.line + 1
        self.loader.flatten_mapping(node)
        for key, child in node.value:
            if isinstance(key, yaml.ScalarNode):
                yield key.value, child, key.start_mark.line + 1

    def _problem(self, node: yaml.Node, path: Path, what: str) -> None:
        self.problems.append(Problem(Place(self.file, node.start_mark.line + 1, dotted(path, self.key)), what))
