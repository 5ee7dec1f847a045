"""A config file's shape, by pydantic: its rules as messages, and as a JSON Schema for editors."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from dataclasses import MISSING, dataclass, field, fields, is_dataclass
from functools import cache
from types import NoneType, UnionType
from typing import Annotated, Any, ClassVar, Literal, Union, get_args, get_origin, get_type_hints

from annotated_types import MinLen, Predicate

from ..errors import SHORT, nearest, not_allowed, one_of
from ..scene import Scene
from ..scene.spec.values import STRICT, Allowed, Listed, Text
from .model import Figure, Source
from .settings import Measure
from .source import Path


@dataclass(frozen=True)
class Shape:
    """The JSON Schema of a value that `check` looks into by itself."""

    schema: Mapping[str, Any]

    def __get_pydantic_json_schema__(self, core_schema, handler) -> dict[str, Any]:
        return dict(self.schema)


Name = Annotated[str, Predicate(re.compile(r"[A-Za-z0-9][A-Za-z0-9._+-]{0,99}").fullmatch),
                 Allowed("letters, digits, . _ + -, at most 100, as in a folder's name")]
Axis = Annotated[Any, Shape({"type": "array", "minItems": 1})]
Axes = Annotated[dict[str, Axis], Allowed("a mapping of keys to lists of values, such as {k: [4, 8]}")]
Params = Annotated[dict[str, Any], Allowed("a mapping of parameters to values, such as {k: 8}")]
Entry = Annotated[Any, Shape({"anyOf": [
    {"type": "string"},
    {"type": "object", "required": ["id"], "properties": {"id": {"type": "string"}, "label": {"type": "string"}}}]})]


@dataclass(frozen=True, kw_only=True)
class ConfigFile:
    """A config of mfr-bench: one experiment."""

    __pydantic_config__: ClassVar[dict] = STRICT

    name: Name
    title: Text | None = None
    source: Source = Source()
    scene: Scene
    params: Params = field(default_factory=dict)
    methods: Annotated[list[Entry], MinLen(1), Allowed("a list of at least one method")]
    sweep: Axes = field(default_factory=dict)
    zip: Axes = field(default_factory=dict)
    measure: Measure = Measure()
    figures: tuple[Figure, ...] = ()
    profiles: dict[str, dict[str, Any]] = field(default_factory=dict)


@cache
def _adapter(cls: type):
    from pydantic import TypeAdapter  # a quarter of a second, for those who read a config only

    return TypeAdapter(cls)


def schema() -> dict[str, Any]:
    """JSON Schema of a config file. It cannot know which parameters a method has."""
    found = _adapter(ConfigFile).json_schema()
    found["$defs"]["Scene"]["required"].remove("depth_complexity")  # r may stand for it
    return found


def parse(cls: type, data: Any) -> tuple[Any, list[tuple[Path, str]]]:
    """An instance of a class of `model` or None, and what is wrong: the path of each wrong field, and why.

    JSON is the form in which pydantic's strict mode takes lists for tuples but no text for a number.
    """
    from pydantic import ValidationError

    try:
        return _adapter(cls).validate_json(json.dumps(data, default=str), strict=True), []
    except ValidationError as error:
        found = {}
        for e in error.errors(include_url=False):
            path, what = _explain(cls, data, e["loc"])
            found.setdefault(path, what)
        return None, list(found.items())


def _explain(cls: Any, data: Any, loc: Path, path: Path = ()) -> tuple[Path, str]:
    """The path of the first field on the way to `loc` that has no fields of its own, and what is wrong there."""
    if not loc or not isinstance(data, dict if is_dataclass(cls) else list):
        return path, f"{not_allowed(data)}; allowed: {allowed(cls)}"
    key, *rest = loc
    if not is_dataclass(cls):
        return _explain(get_args(cls)[0], data[key], tuple(rest), (*path, key))
    hints = _hints(cls)
    if key not in hints:
        return (*path, key), f"unknown key; {one_of(str(key), hints)}"
    if key not in data:
        return (*path, key), f"missing; allowed: {allowed(hints[key])}"
    if is_dataclass(hints[key]) or key == "figures":
        return _explain(hints[key], data[key], tuple(rest), (*path, key))
    if get_origin(hints[key]) is dict and rest:
        value = data[key][rest[0]]
        return (*path, key, rest[0]), f"{not_allowed(value)}; allowed: {allowed(get_args(hints[key])[1])}"
    close = nearest(str(data[key]), map(str, _choices(hints[key])))
    return (*path, key), f"{not_allowed(data[key])}; allowed: {allowed(hints[key])}{close}"


@cache
def _hints(cls: type) -> dict[str, Any]:
    hints = get_type_hints(cls, include_extras=True)
    return {f.name: hints[f.name] for f in fields(cls)}


def _choices(hint: Any) -> tuple:
    if get_origin(hint) in (Union, UnionType):
        return tuple(c for part in get_args(hint) for c in _choices(part))
    if get_origin(hint) is Annotated:
        return tuple(name for rule in hint.__metadata__ if isinstance(rule, Listed) for name in rule.table)
    return get_args(hint) if get_origin(hint) is Literal else ()


def allowed(hint: Any) -> str:
    """The values that a field's annotation allows, in words."""
    if get_origin(hint) is Annotated:
        return next(m.text for m in hint.__metadata__ if isinstance(m, Allowed))
    if get_origin(hint) in (Union, UnionType):
        return " | ".join(allowed(part) for part in get_args(hint) if part is not NoneType)
    if get_origin(hint) is Literal:
        return " | ".join(map(str, get_args(hint)))
    if is_dataclass(hint):
        return f"a mapping with {_keys(hint)}"
    return {bool: "true | false", dict: "a mapping", tuple: "a list of mappings"}[get_origin(hint) or hint]


def _keys(cls: type) -> str:
    """The keys of a mapping; of many only those that it must have, and where the others are listed."""
    names = _hints(cls)
    if len(names) <= SHORT:
        return ", ".join(names)
    needed = [f.name for f in fields(cls) if f.default is MISSING and f.default_factory is MISSING]
    return f"{', '.join(needed)} and any of {len(names) - len(needed)} other keys, which 'mfr-bench schema' lists"
