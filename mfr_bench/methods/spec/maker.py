"""The declaration of a scene that a package from outside makes: its fragments are computed by a function there."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from ...errors import nearest


@dataclass(frozen=True)
class Number:
    """A key of a scene from outside: whole where its default is, and its bounds."""

    default: float
    least: float
    most: float

    def parse(self, text: str) -> float:
        """The number in a text. Raises ValueError with what is allowed."""
        whole = isinstance(self.default, int)
        try:
            found = int(text) if whole else float(text)
        except ValueError:
            found = None
        if found is None or not self.least <= found <= self.most:
            kind = "whole number" if whole else "number"
            raise ValueError(f"{text!r} is not allowed; allowed: a {kind} from {self.least} to {self.most}")
        return found


@dataclass(frozen=True)
class Maker:
    """The function that makes the fragments of a scene from outside.

    keys: what its options may set. package: name, version and hash of what brings it, and place, its module or its
    folder; the loader of packages fills in both.
    """

    what: str
    keys: Mapping[str, Number] = field(default_factory=dict)
    package: Mapping[str, str | None] | None = None
    place: str = ""

    def values(self, options: str | None) -> dict[str, float]:
        """The keys with their values, after options such as 'arms=5 spread=0.3'. Raises ValueError."""
        found = {name: number.default for name, number in self.keys.items()}
        for option in (options or "").split():
            name, equals, value = option.partition("=")
            if not equals or name not in self.keys:
                raise ValueError(f"{option!r} is no option; allowed: KEY=VALUE with KEY of "
                                 f"{', '.join(self.keys) or 'none'}{nearest(name, self.keys)}")
            try:
                found[name] = self.keys[name].parse(value)
            except ValueError as error:
                raise ValueError(f"{name}: {error}") from None
        return found
