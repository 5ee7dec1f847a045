"""Loads the declarations of families one by one: a family with a mistake costs itself alone, and one line."""

from __future__ import annotations

import hashlib
import importlib
import re
import sys
import traceback
from collections.abc import Sequence
from dataclasses import fields
from importlib.machinery import ModuleSpec
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from types import ModuleType

from ..errors import nearest
from . import spec
from .checking import mistakes_of
from .spec import Method

LAST = float("inf")  # the place of a family without ORDER


class DeclarationError(Exception):
    """A mistake in a family's file, as the line that a user reads."""


def family(name: str, file: Path | None = None) -> ModuleType | None:
    """The module of a family; None for a module that declares no methods and uses nothing of a declaration.

    file: of a family outside this package. Raises DeclarationError with the file and line of a mistake, what is
    allowed, and the nearest allowed name.
    """
    try:
        module = importlib.import_module(name)
    except Exception as error:
        at = file or Path(__file__).with_name(f"{name.rpartition('.')[2]}.py")
        raise DeclarationError(_explained(at, error)) from error
    if not hasattr(module, "METHODS"):
        if hasattr(module, "ORDER") or any(isinstance(value, Method) for value in vars(module).values()):
            raise DeclarationError(f"{module.__file__}:1: no METHODS; allowed: METHODS = [Method(...), ...]")
        return None
    methods = module.METHODS
    if not isinstance(methods, Sequence) or not all(isinstance(method, Method) for method in methods):
        raise DeclarationError(f"{line_of(module, 'METHODS')}: METHODS holds what is no Method; "
                               "allowed: a list of Method(...)")
    for method in methods:
        for mistake in mistakes_of(method):
            where = line_of(module, f'"{mistake.text}"', mistake.text)
            raise DeclarationError(f"{where}: {method.id}: {mistake.what}")
    return module


def import_folder(folder: Path, name: str) -> None:
    """Make the folder a package of this name, with its `__init__.py` where there is one."""
    init = folder / "__init__.py"
    spec = ModuleSpec(name, None, is_package=True)
    if init.is_file():
        spec = spec_from_file_location(name, init, submodule_search_locations=[str(folder)])
    else:
        spec.submodule_search_locations = [str(folder)]
    sys.modules[name] = module_from_spec(spec)
    if spec.loader:
        spec.loader.exec_module(sys.modules[name])


def module_of(name: str, place: str) -> ModuleType:
    """The module `name` of what brings declarations from outside: an installed one, or an absolute path of a folder."""
    if Path(place).is_absolute():
        package = f"outside_{hashlib.sha256(place.encode()).hexdigest()[:16]}"
        if package not in sys.modules:
            import_folder(Path(place), package)
        return importlib.import_module(f"{package}.{name}")
    module = importlib.import_module(place)
    return importlib.import_module(f"{place}.{name}") if hasattr(module, "__path__") else module


def order_of(module: ModuleType) -> float:
    """The place of a family in the catalog: its ORDER, else the last."""
    return getattr(module, "ORDER", LAST)


def twice(module: ModuleType, method: Method, other: ModuleType) -> str:
    """The line for an id that another family, or the same one, has declared before."""
    where = line_of(module, f'id="{method.id}"', f'"{method.id}"')
    return (f"{where}: the id {method.id!r} is declared twice, "
            f"first in {Path(other.__file__).name}; allowed: an id of its own")


def line_of(module: ModuleType, *texts: str) -> str:
    """File and line where one of the texts stands first; line 1 where none does."""
    lines = Path(module.__file__).read_text().splitlines()
    found = next((i for i, line in enumerate(lines, 1) if any(text in line for text in texts)), 1)
    return f"{module.__file__}:{found}"


def _explained(file: Path, error: Exception) -> str:
    """The line for an exception that a family's file raised: where, what, and the arguments or names allowed."""
    if isinstance(error, SyntaxError):
        return f"{error.filename}:{error.lineno}: {error.msg}"
    frames = [frame for frame in traceback.extract_tb(error.__traceback__) if frame.filename == str(file)]
    where = f"{file}:{frames[-1].lineno if frames else 1}"
    what = " ".join(f"{error}".split()) or type(error).__name__
    if allowed := _allowed(what):
        what = re.sub(r"\. Did you mean .*\?$", "", what)  # as Python 3.14 ends it
    return f"{where}: {what}{allowed}"


def _allowed(what: str) -> str:
    """The arguments of the class that a TypeError names, the unexpected one's nearest among them."""
    called = re.match(r"(\w+)\.__init__\(\)", what)
    cls = getattr(spec, called[1], None) if called else None
    if cls is None:
        return ""
    names = [field.name for field in fields(cls)]
    wrong = re.search(r"unexpected keyword argument '(\w+)'", what)
    return f"; allowed: {', '.join(names)}{nearest(wrong[1], names) if wrong else ''}"
