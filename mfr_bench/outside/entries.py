"""Entries that modules from outside declare under one name: an EFFECT, a SCENE."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace
from types import ModuleType
from typing import Generic, TypeVar

from ..methods.loading import line_of

Entry = TypeVar("Entry")


@dataclass(frozen=True)
class Declared(Generic[Entry]):
    """A kind of entry: the constant of a module that has it, its type, the function that the module needs beside it.

    what: the kind in a message. gives: the function's signature and result. more: yields the mistakes of an entry of
    the right type, given it and its module's name.
    """

    constant: str
    type: type[Entry]
    what: str
    function: str
    gives: str
    more: Callable[[Entry, str], Iterator[str]]

    def of(self, modules: Iterable[ModuleType], place: str, mistakes: list[str]) -> Iterator[tuple[str, Entry]]:
        """The entries of modules that have one, by the modules' names; each mistake costs the entry that has it."""
        for module in modules:
            name = module.__name__.rpartition(".")[2]
            if mistake := next(self._mistakes(module, name), None):
                mistakes.append(f"{line_of(module, self.constant)}: {mistake}")
            else:
                yield name, replace(getattr(module, self.constant), place=place)

    def _mistakes(self, module: ModuleType, name: str) -> Iterator[str]:
        """The reasons why an entry cannot be used."""
        entry = getattr(module, self.constant)
        if not isinstance(entry, self.type):
            yield f"{self.constant} is a {type(entry).__name__}; allowed: {self.constant} = {self.type.__name__}(...)"
            return
        if hasattr(module, "__path__"):
            yield f"{self.constant} of a whole package; allowed: in a file of its own, which has the {self.what}'s name"
        if not callable(getattr(module, self.function, None)):
            yield f"{self.what} {name} has no {self.function}; allowed: def {self.gives}"
        yield from self.more(entry, name)
