"""Simulates what methods without a promise lose: shares of schedules with a wrong pixel, by n, k and number in flight.

Simulated means: on the race machine, with its schedules. No measured cell holds any of this, and every file says so.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

from ..environment import usable_cores
from ..errors import MfrError
from ..markdown import markdown_table
from ..methods.spec import Method, Value, Variant
from ..store import csv_text, write_file
from .campaign import run, settings
from .check import Checker, How
from .options import others
from .promise import Kind
from .scenes import row_of

FRAGMENTS = (2, 3, 4, 6, 8)
KEPT = (2, 4, 8)
IN_FLIGHT = (2, 4)  # beside all of a pixel
SCENES = 4
TABLE = "simulated-hazards.csv"
COLUMNS = ("simulated", "method", "params", "n", "k", "in_flight", "schedules", "wrong", "wrong_share")


@dataclass(frozen=True)
class Hazard:
    """Schedules of one pixel with n fragments, at most `in_flight` of them at a time, and how many end wrong."""

    variant: Variant
    n: int
    in_flight: int
    schedules: int
    wrong: int

    @property
    def share(self) -> float:
        return self.wrong / self.schedules

    def row(self) -> dict[str, object]:
        """A row of the table, by column name."""
        params = settings(self.variant, "k")
        return dict(zip(COLUMNS, (True, self.variant.method.id, json.dumps(params), self.n, self.variant.params["k"],
                                  self.in_flight, self.schedules, self.wrong, round(self.share, 6)), strict=True))


def promising_nothing(method: Method, k: int) -> Variant | None:
    """The method where a wrong image breaks no promise: at its defaults, or with the first option that does that."""
    if not method.param("k"):
        return None
    for option in _options(method):
        variant = method.variant({"k": k} | option)
        try:
            if Checker(variant, row_of((max(FRAGMENTS),))).promised.kind is Kind.NONE:
                return variant
        except MfrError:
            continue
    return None


def _options(method: Method) -> Iterator[dict[str, Value]]:
    yield {}
    yield from ({p.name: value} for p in method.params if p.name != "k" for value in others(p))


def hazards(methods: Iterable[Method], schedules: int, seed: int, at_once: int | None = None) -> Iterator[Hazard]:
    """Every method that promises nothing somewhere, by its k, fragments and number in flight, in this order."""
    jobs = [(variant, n, flight) for method in methods for k in KEPT if (variant := promising_nothing(method, k))
            for n in FRAGMENTS for flight in sorted({min(n, most) for most in (*IN_FLIGHT, n)})]
    with ThreadPoolExecutor(at_once or usable_cores()) as pool:
        yield from pool.map(lambda job: _hazard(*job, schedules, seed), jobs)


def _hazard(variant: Variant, n: int, in_flight: int, schedules: int, seed: int) -> Hazard:
    found = run(variant, (n,), How(schedules, seed, in_flight=in_flight), SCENES)
    return Hazard(variant, n, in_flight, found.schedules, found.failed)


def write(found: Iterable[Hazard], folder: Path) -> Path:
    """Write the table. Raises StoreError."""
    write_file(folder / TABLE, csv_text(COLUMNS, [h.row() for h in found]))
    return folder / TABLE


def as_markdown(found: Sequence[Hazard]) -> str:
    """A table of shares, all fragments in flight: a row for each method, a column for each n and k."""
    whole = [h for h in found if h.in_flight == h.n]
    points = sorted({(h.n, int(h.variant.params["k"])) for h in whole}, key=lambda point: (point[1], point[0]))
    shares = {(_name(h), h.n, int(h.variant.params["k"])): h.share for h in whole}
    rows = ((name, *(f"{100 * shares[name, n, k]:.1f} %" if (name, n, k) in shares else "" for n, k in points))
            for name in dict.fromkeys(map(_name, whole)))
    return "\n".join(markdown_table(("method", *(f"n = {n}, k = {k}" for n, k in points)), rows))


def _name(hazard: Hazard) -> str:
    params = [f"`{name}: {value}`" for name, value in settings(hazard.variant, "k").items()]
    return ", ".join([f"`{hazard.variant.method.id}`", *params])
