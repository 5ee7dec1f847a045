"""The kinds of figures, a file for each: `KIND` declares what a config may ask of it, `draw` draws it."""

from __future__ import annotations

import importlib
import pkgutil
from collections.abc import Callable, Mapping

from ..kind import COMMON, Key, Kind

_FILES = {name: importlib.import_module(f"{__name__}.{name}") for name in sorted(m.name for m in
                                                                                 pkgutil.iter_modules(__path__))}
KINDS: Mapping[str, Kind] = {name: file.KIND for name, file in _FILES.items()}
DRAW: Mapping[str, Callable] = {name: file.draw for name, file in _FILES.items()}


def keys_of(kind: Kind) -> tuple[Key, ...]:
    """The keys of a figure of this kind, besides kind, x and y."""
    return (*COMMON, *kind.keys)


def all_keys() -> tuple[Key, ...]:
    """The keys of all kinds, none twice. Kinds that share the name of a key share the key."""
    return tuple({key.name: key for kind in KINDS.values() for key in keys_of(kind)}.values())


__all__ = ["DRAW", "KINDS", "all_keys", "keys_of"]
