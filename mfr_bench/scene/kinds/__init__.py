"""The kinds of scenes, found by scanning this package: a file declares its kind as KIND."""

from __future__ import annotations

import importlib
import pkgutil
from dataclasses import fields
from functools import cache

from ..spec.kind import CommonKeys, Fault, Kind

FIRST = "quads"  # the kind of a scene that names none; older records of every kind have its keys


def _found() -> dict[str, Kind]:
    """Every declared kind by name, the first kind first."""
    modules = [importlib.import_module(f"{__name__}.{m.name}") for m in pkgutil.iter_modules(__path__)]
    kinds = sorted((module.KIND for module in modules), key=lambda kind: (kind.name != FIRST, kind.name))
    return {kind.name: kind for kind in kinds}


KINDS = _found()


def kind_of(scene: CommonKeys) -> Kind:
    """The kind of a scene."""
    return KINDS[scene.kind]


@cache
def own_keys(kind: Kind) -> frozenset[str]:
    """The keys that the kind has in addition to those of every kind."""
    return frozenset(key.name for key in fields(kind.Keys))


@cache
def owners(key: str) -> tuple[str, ...]:
    """The kinds that have a key of their own by this name; none where every kind has it."""
    return tuple(name for name, kind in KINDS.items() if key in own_keys(kind))


def faults(scene: CommonKeys) -> list[Fault]:
    """The faults of a scene whose values are each allowed: keys of other kinds, and the rules of its kind."""
    return [*_keys_of_other_kinds(scene), *kind_of(scene).faults(scene)]


def _keys_of_other_kinds(scene: CommonKeys) -> list[Fault]:
    found = []
    for key in fields(scene):
        kinds = owners(key.name)
        if kinds and scene.kind not in kinds and getattr(scene, key.name) != key.default:
            what = f"{key.name} has no use in kind {scene.kind}; allowed: with kind {' | '.join(kinds)}"
            found.append(((f"scene.{key.name}", "scene.kind"), what))
    return found
