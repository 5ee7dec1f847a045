"""The shaders that ran, for the page: each line of GLSL once, compressed, with the variants and passes that use it."""

from __future__ import annotations

import base64
import json
import shlex
import zlib
from collections.abc import Iterable
from dataclasses import dataclass

from ..effects import Settings
from ..glsl import stages
from ..glsl.digest import fitted_nominally, glsl_hash
from ..methods import catalog
from ..methods.spec import Variant
from ..report.data import Point

GEOMETRIES = ("quad", "strip", "triangle", "reversed", "masked")  # by which a cell's hash may have been taken


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
    known: dict[tuple, tuple[Point, Variant]] = {}  # by what the text depends on
    for point in points:
        method = catalog().get(point.method)
        if method is None:
            continue
        try:
            variant = method.variant(point.cell["params"])
        except ValueError:  # parameters that the method no longer takes
            continue
        effect = Settings.of(point.cell["scene"])
        known.setdefault((point.method, tuple(sorted(variant.params.items())), effect), (point, variant))
    entries, texts, rows = [], {}, []
    for point, variant in known.values():
        entries.append(_entry(point, variant))
        rows.append([[step.name, stage.entry, texts.setdefault(stage.text, len(texts))]
                     for step in variant.passes if step.kind != "clear" and not step.probes
                     for stage in stages(fitted_nominally(variant, "quad", Settings.of(point.cell["scene"])), step)])
    lines: dict[str, int] = {}
    numbered = [[lines.setdefault(line, len(lines)) for line in text.split("\n")] for text in texts]
    content = json.dumps({"lines": list(lines), "texts": numbered, "rows": rows}, separators=(",", ":")).encode()
    return Shaders(tuple(entries), base64.b64encode(zlib.compress(content, 9)).decode())


def _entry(point: Point, variant: Variant) -> ShaderEntry:
    defaults = variant.method.complete({})
    effect = Settings.of(point.cell["scene"])
    others = {name: value for name, value in variant.params.items() if defaults[name] != value} | effect.keys
    command = ["mfr-bench", "shader", point.method]
    for name, value in others.items():
        command += ["--set", f"{name}={value:g}" if isinstance(value, float) else f"{name}={value}"]
    said = ", ".join(f"{name} {value}" for name, value in others.items())
    ran = str(point.cell.get("glsl_hash") or "")
    return ShaderEntry(f"{point.method} ({said})" if said else point.method, shlex.join(command), ran,
                       any(ran == glsl_hash(variant, geometry, effect) for geometry in GEOMETRIES))
