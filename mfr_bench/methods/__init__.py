"""The catalog of methods, found by scanning this package: a family file lists its own in `METHODS`."""

from __future__ import annotations

import importlib
import pkgutil
from functools import lru_cache

from .spec import Method

FLOOR = "floor"  # id of the method that is measured for every scene: no method can be faster
NO_FAMILIES = ("catalog_text",)


@lru_cache(maxsize=1)
def catalog() -> dict[str, Method]:
    """Every declared method by id, in the order of the family files' `ORDER`."""
    families = [importlib.import_module(f"{__name__}.{m.name}") for m in pkgutil.iter_modules(__path__)
                if not m.ispkg and m.name not in NO_FAMILIES]
    families.sort(key=lambda family: family.ORDER)
    found: dict[str, Method] = {}
    for family in families:
        for method in family.METHODS:
            if method.id in found:
                raise ValueError(f"{family.__name__}: method id {method.id!r} is declared twice")
            found[method.id] = method
    return found
