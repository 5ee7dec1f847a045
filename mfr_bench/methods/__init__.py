"""The catalog of methods: a family file of this package, or a package or folder outside, lists its own in `METHODS`."""

from __future__ import annotations

import pkgutil
from collections.abc import Mapping
from functools import lru_cache
from types import ModuleType

from ..effects import OWN_EFFECTS, Effect, bring
from . import outside
from .loading import DeclarationError, family, order_of, twice
from .spec import Method

NO_FAMILIES = ("loading", "checking", "outside")  # which this module imports itself
FLOOR = "floor"  # id of the method that is measured for every scene: no method can be faster


# A line for each mistake in a declaration that `catalog` met: file, line, what is wrong, allowed and nearest.
MISTAKES: list[str] = []


@lru_cache(maxsize=1)
def catalog() -> dict[str, Method]:
    """Every declared method by id, in the order of the family files' `ORDER`; families without it come last.

    Behind them stand the methods from outside, which bear their package. EFFECTS gets the effects from outside.

    A family whose declaration has a mistake is left out, and MISTAKES gets a line for it.
    """
    families: list[ModuleType] = []
    MISTAKES.clear()
    for module in pkgutil.iter_modules(__path__):
        try:
            found = None if module.ispkg or module.name in NO_FAMILIES else family(f"{__name__}.{module.name}")
        except DeclarationError as error:
            MISTAKES.append(str(error))
        else:
            families += [found] if found else []
    owners: dict[str, ModuleType] = {}
    methods: dict[str, Method] = {}
    for each in sorted(families, key=order_of):
        for method in each.METHODS:
            if method.id in methods:
                MISTAKES.append(twice(each, method, owners[method.id]))
            else:
                methods[method.id], owners[method.id] = method, each
    bring(_effects_from_outside())
    MISTAKES.extend(_twice_as_scenes())
    return methods | _from_outside(methods)


def _from_outside(taken: Mapping[str, Method]) -> dict[str, Method]:
    """The methods that packages and folders bring; an id that is `taken` stays with whom it is."""
    found: dict[str, Method] = {}
    for each in outside.loaded():
        MISTAKES.extend(each.mistakes)
        for method in each.methods:
            if method.id in taken or method.id in found:
                MISTAKES.append(f"{each.source.name}: the id {method.id!r} is declared twice, first in "
                                f"{_owner(taken.get(method.id) or found[method.id])}; allowed: an id of its own")
            else:
                found[method.id] = method
    return found


def _effects_from_outside() -> dict[str, Effect]:
    """The effects that packages and folders bring; a name that is taken stays with whom it is."""
    found: dict[str, Effect] = {}
    for each in outside.loaded():
        for name, effect in each.effects.items():
            if name in OWN_EFFECTS or name in found:
                MISTAKES.append(f"{each.source.name}: the effect {name!r} is declared twice, first in "
                                f"{_owner(found.get(name))}; allowed: a name of its own")
            else:
                found[name] = effect
    return found


def _twice_as_scenes() -> list[str]:
    """A line for each scene from outside whose name an earlier source has."""
    first: dict[str, outside.Loaded] = {}
    return [f"{each.source.name}: the scene {name!r} is declared twice, first in {first[name].source.name}; allowed: a "
            "name of its own" for each in outside.loaded() for name in each.scenes
            if first.setdefault(name, each) is not each]


def _owner(declared: Method | Effect | None) -> str:
    return declared.package["name"] if declared and declared.package else "mfr-bench"
