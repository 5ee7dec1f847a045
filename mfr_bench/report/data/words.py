"""Names of coordinates, and values, as people write them."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from functools import cache
from typing import Any

ALIASES = {"n": "depth_complexity", "p_d": "pixel_density", "f_p": "fragment_probability"}
SHORT = {"depth_complexity": "n", "pixel_density": "p_d", "fragment_probability": "f_p",
         "memory_mb": "M_b", "hit_ratio": "R_h"}  # in headings


@cache
def bare(name: str) -> str:
    """'scene.pixel_density' and 'p_d' are 'pixel_density'."""
    name = name.rsplit(".", 1)[-1]
    return ALIASES.get(name, name)


def short(name: str) -> str:
    return SHORT.get(bare(name), bare(name).replace("_", " "))


def heading(name: str, value: Any, between: str = " = ") -> str:
    """'k = 8'; without a value 'any k', for a method is the same whatever it is, and 'no n', for scenes lack it."""
    if value is None:
        return f"{'no' if bare(name) in ALIASES.values() else 'any'} {short(name)}"
    return f"{short(name)}{between}{plain(value)}"


def plain(value: Any) -> str:
    """A coordinate as people write it: 640×480, 0.25, 0.1–0.6, random."""
    if isinstance(value, (tuple, list)):
        between = "–" if any(isinstance(v, float) for v in value) else "×"
        return between.join(map(plain, dict.fromkeys(value) if between == "–" else value))
    return f"{value:g}" if isinstance(value, float) else str(value)


def number(value: float | None, digits: int = 3) -> str:
    """`value` to at least `digits` significant digits, no exponent from 1e-4 to 1e7; an int whole, None empty."""
    if value is None or isinstance(value, int):
        return "" if value is None else str(value)
    if value == 0 or not math.isfinite(value):
        return f"{value:g}"
    if not 1e-4 <= abs(value) < 1e7:
        return f"{value:.{digits}g}"
    digits = max(digits, len(str(int(abs(value)))))
    return f"{value:#.{digits}g}".rstrip(".")


def percent(share: float, sign: str = "") -> str:
    """'2.5 %', '38 %', '210 %'; with `sign` '+', also those that grow have theirs."""
    return f"{100 * share:{sign}{'.0f' if abs(share) >= 0.1 else '.2g'}} %"


def listed(labels: Iterable[str]) -> str:
    """Labels, each once, so that they can be told apart: some have commas themselves."""
    found = list(dict.fromkeys(labels))
    return (" and " if any("," in label for label in found) else ", ").join(found)


def figure_of(source: Mapping[str, Any]) -> str:
    """'Fig. 6', 'Table 1', '§4': where in its paper an experiment stands."""
    figure = str(source.get("figure") or "")
    return f"Fig. {figure}" if figure[:1].isdigit() else figure
