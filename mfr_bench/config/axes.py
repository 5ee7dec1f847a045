"""The points of a sweep: what each axis is at, and the scene and settings that this makes."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Any

from ..methods.spec import Param
from ..scene import Scene
from .settings import Measure

# Names that work without any method: n = r·k (kplus_2015 §5.1), and the k that r multiplies.
R = Param("r", 1, "depth complexity over k: n = r·k")
K = Param("k", 8, "what r multiplies")

Axes = Mapping[str, tuple]


def point_count(sweep: Axes, zipped: Axes) -> int:
    """The number of points, without making them."""
    return math.prod(len(v) for v in sweep.values()) * (len(next(iter(zipped.values()))) if zipped else 1)


def points(sweep: Axes, zipped: Axes) -> Iterator[dict[str, Any]]:
    """Every point of the axes' product, the last axis fastest; the zipped axes are one axis, the last."""
    together = list(zip(*zipped.values(), strict=True)) if zipped else [()]
    for *values, zip_values in itertools.product(*sweep.values(), together):
        yield dict(zip(sweep, values, strict=True)) | dict(zip(zipped, zip_values, strict=True))


def scene_at(scene: Scene, params: Mapping[str, Any], point: Mapping[str, Any]) -> Scene:
    """The scene of a point: its `scene.` keys, and depth_complexity = r·k where there is an r."""
    changes = section_at("scene", point)
    given = {**params, **point}
    if "r" in given:
        changes["depth_complexity"] = given["r"] * given["k"]
    return replace(scene, **changes) if changes else scene


def measure_at(measure: Measure, point: Mapping[str, Any]) -> Measure:
    """The measurement settings of a point."""
    changes = section_at("measure", point)
    return replace(measure, **changes) if changes else measure


def section_at(section: str, point: Mapping[str, Any]) -> dict[str, Any]:
    return {key.partition(".")[2]: value for key, value in point.items() if key.startswith(f"{section}.")}
