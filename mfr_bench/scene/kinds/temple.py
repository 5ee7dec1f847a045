"""`kind: temple`, a stand-in for the Greek temple (occupancy_2015 Fig. 5): large faces in perspective."""

from __future__ import annotations

from ..spec.kind import CommonKeys, Described
from ..spec.layered import Layered

PIECES = 8 + 1 + 1 + 8 * 4  # strips of a facade: a frieze in eight, a gable, steps, four for each of eight columns


class Temple(Layered):
    """Facades one behind the other."""

    name = "temple"
    generator = "temple.temple"
    fullest = 0.65
    rows = (Described("`temple`", "facades one behind the other, in perspective", "the maximum", "`mean_depth`",
                      "the Greek temple: mean 8"),)

    def silhouette(self, scene: CommonKeys) -> float:
        return 0.57

    def primitives(self, scene: CommonKeys) -> int:
        return scene.depth_complexity * PIECES


KIND = Temple()
