"""Formulas of resources: strings over the names of `SceneStats` and a method's own parameters, e.g. ``"2*k*P"``.

One text is evaluated for allocation, compared with the paper's, and printed.
"""

from __future__ import annotations

import math
from functools import cache

from .params import Params
from .scene_stats import SceneStats


def doubled(start: int, needed: int) -> int:
    """Capacity reached when `start` is doubled until it holds `needed` (gpupro5 §1.5.2)."""
    capacity = max(1, start)
    while capacity < needed:
        capacity *= 2
    return capacity


PURE = {"ceil": math.ceil, "floor": math.floor, "log2": math.log2, "min": min, "max": max, "doubled": doubled}
FUNCTIONS = (*PURE, "bounded", "paged")
PURE_SCOPE = {"__builtins__": {}, **PURE}


@cache
def _compiled(formula: str):
    return compile(formula, f"<formula {formula}>", "eval")


def evaluate(formula: str, stats: SceneStats, params: Params) -> float:
    """Value of a resource formula for one frame. Raises NameError for a name it does not know."""
    scope = {**PURE_SCOPE, "bounded": stats.bounded, "paged": stats.paged, **stats.names, **params}
    if "f_k" in formula and "k" in params:
        scope["f_k"] = stats.bounded(int(params["k"])) / stats.P
    return eval(_compiled(formula), scope)
