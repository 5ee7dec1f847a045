"""Types of the values that a config holds. The annotations are the rules, and carry the words of an error message."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, fields, is_dataclass
from typing import Annotated, Any

from annotated_types import Interval, MinLen, Predicate

MAX_SIDE = 16384  # pixels

STRICT = {"extra": "forbid", "allow_inf_nan": False}  # pydantic's settings for a class of a config


@dataclass(frozen=True)
class Allowed:
    """The values that a field takes, in the words of an error message and of the JSON Schema."""

    text: str

    def __get_pydantic_json_schema__(self, core_schema, handler) -> dict[str, Any]:
        return handler(core_schema) | {"description": self.text}


class Listed(Allowed):
    """The type of a name that stands in a table now: packages from outside may add to the table."""

    def __init__(self, table: Mapping[str, Any], others: str):
        object.__setattr__(self, "table", table)
        object.__setattr__(self, "others", others)  # in words, what may come into the table

    @property
    def text(self) -> str:
        return f"{' | '.join(self.table)}, or {self.others}"

    def __get_pydantic_core_schema__(self, source, handler):
        from pydantic_core import core_schema  # only who validates pays for it
        return core_schema.no_info_after_validator_function(self._known, handler(source))

    def _known(self, name: str) -> str:
        if name not in self.table:
            raise ValueError(self.text)
        return name

    def __get_pydantic_json_schema__(self, core_schema, handler) -> dict[str, Any]:
        return handler(core_schema) | {"enum": list(self.table)}


class OneOrTwo(Allowed):
    """The type of a pair that may be written as the one value that both are."""

    def __get_pydantic_core_schema__(self, source, handler):
        from pydantic_core import core_schema  # only who validates pays for it
        return core_schema.no_info_before_validator_function(self._pair, handler(source))

    @staticmethod
    def _pair(value: Any) -> Any:
        if isinstance(value, (int, float)):
            return value, value
        return tuple(value) if isinstance(value, list) else value

    def __get_pydantic_json_schema__(self, core_schema, handler) -> dict[str, Any]:
        pair = handler(core_schema)
        return {"anyOf": [pair["prefixItems"][0], pair], "description": self.text}


Text = Annotated[str, MinLen(1), Allowed("text")]
Whole = Annotated[int, Interval(ge=1, le=MAX_SIDE), Allowed(f"a whole number from 1 to {MAX_SIDE}")]
Size = Annotated[tuple[Whole, Whole], Allowed(f"two whole numbers from 1 to {MAX_SIDE}")]
Share = Annotated[float, Interval(gt=0, le=1), Allowed("a number above 0, up to 1")]
Unit = Annotated[float, Interval(ge=0, le=1), Allowed("a number from 0 to 1")]
Alpha = Annotated[tuple[Unit, Unit], Predicate(lambda pair: pair[0] <= pair[1]),
                  OneOrTwo("a number from 0 to 1, or two such numbers, the lower first")]
Colours = Annotated[str, Predicate(re.compile(r"any|plane|grass|rock|sand|hues-[1-9][0-9]?").fullmatch),
                    Allowed("any | plane | grass | rock | sand | hues-N with N from 1 to 99")]
Seed = Annotated[int, Interval(ge=0, lt=2**32), Allowed("a whole number from 0 to 4294967295")]


def plain(value: Any) -> Any:
    """The value as JSON knows it: lists instead of tuples, mappings instead of classes."""
    if is_dataclass(value):
        return {key.name: plain(getattr(value, key.name)) for key in fields(value)}
    return [plain(v) for v in value] if isinstance(value, tuple) else value


def told(value: Any) -> Any:
    """A value of an axis as a record stores it: a section of a config, such as a view, as text of the keys it gives."""
    if is_dataclass(value):
        given = [(key.name, found) for key in fields(value) if (found := getattr(value, key.name)) != key.default]
        return ", ".join(f"{name} {_text(found)}" for name, found in given) or "default"
    return tuple(map(told, value)) if isinstance(value, tuple) else value


def _text(value: Any) -> str:
    return " ".join(map(_text, value)) if isinstance(value, tuple) else str(told(value))
