"""The catalog of methods, found by scanning this package: a family file lists its own in `METHODS`."""

from __future__ import annotations

import pkgutil
from functools import lru_cache
from types import ModuleType

from .loading import DeclarationError, family, order_of, twice
from .spec import Method

NO_FAMILIES = ("loading", "checking")  # which this module imports itself
FLOOR = "floor"  # id of the method that is measured for every scene: no method can be faster


# A line for each mistake in a declaration that `catalog` met: file, line, what is wrong, allowed and nearest.
MISTAKES: list[str] = []


@lru_cache(maxsize=1)
def catalog() -> dict[str, Method]:
    """Every declared method by id, in the order of the family files' `ORDER`; families without it come last.

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
    return methods
