"""Parameters of a method: their values, defaults, and what a choice needs, asks of a scene, or weakens."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from ...errors import nearest, not_allowed

Value = int | float | str
Params = Mapping[str, Value]
ON_OFF = ("on", "off")


@dataclass(frozen=True)
class Param:
    """One parameter of a method: a whole number in [low, high] or `of` a list, one of `choices`, or a `real` number.

    A real number lies between the bounds, of which it reaches none, or with `closed` the upper one. `off` is allowed
    beside them.
    """

    name: str
    default: Value
    doc: str
    choices: tuple[str, ...] = ()
    low: float = 1
    high: float = 1024
    real: bool = False
    closed: bool = False
    off: float | None = None
    of: tuple[int, ...] = ()
    needs: Mapping[str, str] = field(default_factory=dict)  # choice, or a range "5-8" -> feature the device must have
    needs_where: When | None = None  # where `needs` holds; elsewhere every value can be had. None: everywhere
    asks: Mapping[str, str] = field(default_factory=dict)  # choice or range -> what it asks of a scene: SCENE_FACTS
    weakens: Mapping[str, str] = field(default_factory=dict)  # choice or range -> the known failure that it brings
    counts_losses: bool = False  # values which weaken may lose fragments, but every one that is lost is counted
    error: str | None = None  # the largest error of a channel that values which weaken bring, a formula; None: unknown
    acts: When | Above | None = None  # where it has an effect; elsewhere it stands at its default

    @property
    def allowed(self) -> str:
        if self.real:
            off = "" if self.off is None else f"{self.off:g} or "
            return off + (f"a number above {self.low}, up to {self.high}" if self.closed
                          else f"a number between {self.low} and {self.high}")
        if self.choices or self.of:
            return " | ".join(map(str, self.choices or self.of))
        return f"a whole number from {self.low} to {self.high}"

    def need(self, chosen: Params) -> str | None:
        """The feature that a device must have for the chosen value together with those of other parameters."""
        holds = self.needs_where is None or self.needs_where.holds(chosen)
        return self._said(self.needs, chosen[self.name]) if holds else None

    def weakness(self, value: Value) -> str | None:
        """The known failure that the value brings."""
        return self._said(self.weakens, value)

    def asked(self, value: Value) -> str | None:
        """The fact of a scene that the value asks for, a key of SCENE_FACTS."""
        return self._said(self.asks, value)

    def _said(self, of: Mapping[str, str], value: Value) -> str | None:
        if self.choices:
            return of.get(str(value))
        ranges = ((*map(float, key.split("-")), text) for key, text in of.items())
        return next((text for low, *high, text in ranges if low <= float(value) <= (high or [low])[0]), None)

    def at(self, value: Value) -> Param:
        """The same parameter with another default, for `Method.fixed`."""
        return replace(self, default=value)

    def parse(self, value: Any) -> Value:
        """The canonical value, or ValueError saying what is allowed. YAML's bare on/off are booleans."""
        if self.choices:
            if isinstance(value, bool) and (word := "on" if value else "off") in self.choices:
                return word
            if value in self.choices:
                return value
            close = nearest(str(value), self.choices)
            raise ValueError(f"{not_allowed(value)}; allowed: {self.allowed}{close}")
        number = isinstance(value, (int, float) if self.real else int) and not isinstance(value, bool)
        inside = number and self.low <= value <= self.high
        if self.real:
            inside = inside and value != self.low and (self.closed or value != self.high)
            inside = inside or (number and value == self.off)
        if not inside or (self.of and value not in self.of):
            raise ValueError(f"{not_allowed(value)}; allowed: {self.allowed}")
        return float(value) if self.real else value


@dataclass(frozen=True)
class When:
    """Holds where the parameter `name` has one of `values`."""

    name: str
    values: tuple[Value, ...]
    also: When | None = None

    def holds(self, params: Params) -> bool:
        return params[self.name] in self.values and (self.also is None or self.also.holds(params))

    def __and__(self, other: When) -> When:
        return replace(self, also=self.also & other if self.also else other)


@dataclass(frozen=True)
class Above:
    """Holds where the parameter `name` is greater than the parameter `other`."""

    name: str
    other: str

    def holds(self, params: Params) -> bool:
        return params[self.name] > params[self.other]


def when(name: str, *values: Value) -> When:
    return When(name, values)
