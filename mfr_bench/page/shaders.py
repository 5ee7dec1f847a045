"""The shaders that ran, for the page: each line of GLSL once, compressed, with the variants and passes that use it."""

from __future__ import annotations

import base64
import json
import shlex
import zlib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, fields
from typing import Any

from ..effects import EFFECTS, Settings
from ..glsl.digest import hash_of, stages_by_pass
from ..methods import catalog
from ..methods.spec import Variant
from ..report.data import Point
from ..scene import Scene
from ..scene.kinds import KINDS
from ..scene.spec.kind import Kind
from ..store import Cell


@dataclass(frozen=True)
class ShaderEntry:
    """A method with parameters: the command that prints its shaders, their hash, and whether today's are the same."""

    name: str
    command: str
    hash: str
    current: bool


@dataclass(frozen=True)
class Shaders:
    """The shaders that the page shows.

    packed: zlib, base64 and JSON of `lines`, of `texts` as numbers of lines, and for each entry its rows of pass, stage
    and number of the text. Stages share most of their lines, further apart than zlib looks back.
    """

    entries: tuple[ShaderEntry, ...]
    packed: str


def shaders_of(points: Iterable[Point]) -> Shaders:
    """The shaders of every method and set of parameters among the points, in their order."""
    entries, texts, rows = [], {}, []
    for ran in _distinct(points):
        passes = stages_by_pass(ran.variant, _geometry(ran.cell["scene"]), ran.effect)
        entries.append(_entry(ran, hash_of(passes)))
        rows.append([[step.name, stage.entry, texts.setdefault(stage.text, len(texts))]
                     for step, found in passes if not step.probes for stage in found])
    lines: dict[str, int] = {}
    numbered = [[lines.setdefault(line, len(lines)) for line in text.split("\n")] for text in texts]
    content = json.dumps({"lines": list(lines), "texts": numbered, "rows": rows}, separators=(",", ":")).encode()
    return Shaders(tuple(entries), base64.b64encode(zlib.compress(content, 9)).decode())


@dataclass(frozen=True)
class _Ran:
    """A method with parameters and an effect, and the first cell that ran them."""

    variant: Variant
    effect: Settings
    cell: Cell


def _distinct(points: Iterable[Point]) -> list[_Ran]:
    """The methods with parameters and effects among the points, each once."""
    seen: set[tuple] = set()
    found: dict[tuple[Variant, Settings], _Ran] = {}
    for point in points:
        effect = Settings.of(point.cell["scene"])
        recorded = point.method, tuple(sorted(point.cell["params"].items())), effect
        if recorded in seen:
            continue
        seen.add(recorded)
        variant = _variant(point)
        if variant is None or effect.name not in EFFECTS:  # of a package that is not here
            continue
        # Records that differ in parameters added since are of one variant.
        found.setdefault((variant, effect), _Ran(variant, effect, point.cell))
    return list(found.values())


def _variant(point: Point) -> Variant | None:
    """The variant that the point ran; None where today's catalog has no such method or value."""
    method = catalog().get(point.method)
    try:
        return method and method.variant(point.cell["params"])
    except ValueError:
        return None


def _geometry(record: Mapping[str, Any]) -> str:
    """The geometry that a recorded scene is drawn with. Keys that the record leaves out have their defaults."""
    known = {key.name: record[key.name] for key in fields(Scene) if key.name in record}
    scene = Scene(**{"depth_complexity": 0} | known)
    kind = KINDS.get(scene.kind)
    return kind.geometry_of(scene) if kind else Kind.geometry


def _entry(ran: _Ran, hash_today: str) -> ShaderEntry:
    defaults = ran.variant.method.complete({})
    others = {name: value for name, value in ran.variant.params.items() if defaults[name] != value} | ran.effect.keys
    command = ["mfr-bench", "shader", ran.variant.method.id]
    for name, value in others.items():
        command += ["--set", f"{name}={value:g}" if isinstance(value, float) else f"{name}={value}"]
    said = ", ".join(f"{name} {value}" for name, value in others.items())
    name, recorded = ran.variant.method.id, str(ran.cell.get("glsl_hash") or "")
    return ShaderEntry(f"{name} ({said})" if said else name, shlex.join(command), recorded, recorded == hash_today)
