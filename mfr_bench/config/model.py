"""A config as frozen values; the annotations are the rules by which `check` checks them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, make_dataclass
from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal

from ..methods.spec import Value
from ..report.figures.kind import Key
from ..report.figures.kinds import KINDS, all_keys
from ..scene import Scene
from ..scene.spec.values import STRICT, Allowed, Text
from .settings import Measure, MethodEntry, Plain


def _rule(key: Key) -> Any:
    """The annotation of a key that kinds of figures declare."""
    if isinstance(key.takes, tuple):
        return Literal[key.takes] if key.default in key.takes else Literal[key.takes] | None
    return {"text": Text | None, "flag": bool,
            "texts": Annotated[tuple[Text, ...], Allowed(f"a list of {key.of}")]}[key.takes]


Figure = make_dataclass(
    "Figure", [("kind", Literal[tuple(KINDS)]), ("x", Text), ("y", Text, "time_ms"),
               *((key.name, _rule(key), key.default) for key in all_keys())],
    bases=(Plain,), frozen=True, kw_only=True, namespace={
        "__module__": __name__, "__pydantic_config__": STRICT,
        "__doc__": "One figure; x and y are columns of results.csv, parameters or axes. The kinds are: "
                   + "; ".join(f"`{name}`: {kind.meaning}" for name, kind in KINDS.items()) + "."})


@dataclass(frozen=True, kw_only=True)
class Source(Plain):
    """The origin of an experiment: paper and figure, what stands for its scene, quantities in results/reference.

    readings: how a text that leaves something open was read, and what differs from the paper; a sentence each.
    """

    __pydantic_config__: ClassVar[dict] = STRICT

    paper: Text | None = None
    figure: Text | None = None
    stand_in: Text | None = None
    prints: Annotated[tuple[Text, ...], Allowed("a list of quantities of results/reference")] = ()
    readings: Annotated[tuple[Text, ...], Allowed("a list of sentences")] = ()


@dataclass(frozen=True)
class Experiment:
    """A checked config. `sweep` and `zip` hold the values of each axis by key; `source` what it says of Source."""

    name: str
    title: str
    source: Mapping[str, Any]
    scene: Scene
    params: Mapping[str, Value]
    methods: tuple[MethodEntry, ...]
    sweep: Mapping[str, tuple]
    zip: Mapping[str, tuple]
    measure: Measure
    figures: tuple[Figure, ...]
    path: Path
    profile: str | None = None
