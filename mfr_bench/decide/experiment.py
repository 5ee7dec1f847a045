"""The config that lets the candidates race on the question's scene."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping, Sequence
from typing import Any

from ..scene.files import digest_of
from .budget import COMPILING_SHARE
from .candidates import Candidate
from .question import Question

SEED = 1
RACE_SHARE = 0.75  # of the budget; the rest opens the device, draws and checks last frames, writes the results
MOST_FRAMES = 1000  # rounds at most


def scene_of(question: Question) -> dict[str, Any]:
    """The scene that stands for the numbers of a question: rectangles of mixed sizes over a centred block."""
    return {"kind": "quads", "size": list(question.size), "pixel_density": question.covered,
            "depth_complexity": question.layers, "layout": "mixed", "order": "random", "alpha": [0.1, 0.6],
            "seed": SEED}


def config_of(question: Question, scene: Mapping[str, Any], found: Sequence[Candidate], budget_s: float,
              default_memory_mb: float = 3072.0) -> dict[str, Any]:
    """A config as YAML has it.

    budget_s: wall time of the whole answer, not what is left of it: cells that an answer of the same budget measured
    are then the same cells.
    """
    time_limit_s = RACE_SHARE * budget_s / max(1, len(found) + 1)  # the floor is drawn as well
    measure = {"eliminate": True, "max_error": question.max_error, "min_samples": 6, "max_samples": MOST_FRAMES,
               "time_limit_s": round(max(0.05, time_limit_s), 3),
               "hard_limit_s": round(max(1.0, COMPILING_SHARE * budget_s), 3),
               "memory_budget_mb": question.memory_mb or default_memory_mb}
    methods = [{"id": each.method, "label": each.label, **each.params} for each in found]
    identity = repr((sorted(scene.items(), key=str), digest_of(scene), question.memory_mb, question.max_error))
    digest = hashlib.sha256(identity.encode()).hexdigest()[:10]
    return {"name": f"decide-{digest}", "title": f"Decision for {question}", "scene": dict(scene),
            "methods": methods, "measure": measure,
            "figures": [{"kind": "bars", "x": "depth_complexity", "y": "time_ms", "log": "y", "sorted": True}]}


def count_of(scene: Mapping[str, Any], budget_s: float) -> dict[str, Any]:
    """A config that has a device count the fragments of the question's scene: its floor, in one frame."""
    return {"name": "count", "scene": dict(scene), "methods": ["floor"],
            "measure": {"min_samples": 1, "max_samples": 1, "time_limit_s": 0.05,
                        "hard_limit_s": round(max(1.0, COMPILING_SHARE * budget_s), 3)}}
