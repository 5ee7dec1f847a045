"""The section `scene` of a config as a frozen value: the keys of every kind, and those of each kind."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Any, ClassVar, Literal

from .kinds import FIRST, KINDS, own_keys, owners
from .spec.kind import LATE, LOCAL, CommonKeys
from .spec.values import STRICT, plain

# A class stands before the one that it is made from, as Python's inheritance asks.
KEY_CLASSES = tuple(sorted(dict.fromkeys(kind.Keys for kind in KINDS.values()), key=lambda keys: -len(keys.__mro__)))


@dataclass(frozen=True, kw_only=True)
class Scene(*KEY_CLASSES, CommonKeys):
    """A scene; docs/scenes.md describes every kind and its keys."""

    __pydantic_config__: ClassVar[dict] = STRICT

    kind: Literal[tuple(KINDS)] = FIRST

    def as_dict(self) -> dict[str, Any]:
        """The keys as JSON knows them.

        A key that has its default is left out where only other kinds have it, or where it was added later.
        """
        kind = KINDS[self.kind]
        mine = own_keys(kind) | (set() if kind.measured else own_keys(KINDS[FIRST]))
        unused = {*kind.unused, "depth_complexity"} if kind.measured else ()
        found = {}
        for key in fields(self):
            if key.metadata.get(LOCAL) or key.name in unused:
                continue
            value = getattr(self, key.name)
            optional = key.metadata.get(LATE) or (owners(key.name) and key.name not in mine)
            if not (optional and value == key.default):
                found[key.name] = plain(value)
        return found | kind.record(self)
