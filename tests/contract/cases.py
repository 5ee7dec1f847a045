"""The cases of every method: its variants, and the scenes of mfr_bench.contract."""

from __future__ import annotations

from mfr_bench.contract import variants as of_any
from mfr_bench.contract.cases import (
    ALIKE,
    DEEP,
    KS,
    SCENES,
    SLANTED,
    TWO_CLASSES,
    Drawn,
    N,
    layers_for,
    runs_here,
    stage,
    stats_in,
)
from mfr_bench.contract.variants import label, with_k
from mfr_bench.methods import catalog
from mfr_bench.methods.spec import Method, Variant

__all__ = [
    "ALIKE",
    "DEEP",
    "KS",
    "SCENES",
    "SLANTED",
    "TWO_CLASSES",
    "Drawn",
    "N",
    "every_method",
    "label",
    "layers_for",
    "options",
    "runs_here",
    "stage",
    "stats_in",
    "variants",
    "with_k",
]

# Of real parameters, values that switch something on or off.
NUMBERS = {"adaptive": {"max_error": 0.01, "memory_mb": 0.15, "spare_memory": 0.0}}


def every_method() -> list[Method]:
    return list(catalog().values())


def variants(method: Method) -> list[Variant]:
    """The variants of a method that are tested, those of NUMBERS included."""
    return of_any.variants(method, NUMBERS.get(method.id))


def options(method: Method) -> list[Variant]:
    """Every variant but the default."""
    return variants(method)[1:]
