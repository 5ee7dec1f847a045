"""`kind: hairball`, a stand-in for the Hairball (kplus_2015 Fig. 3 and 10, occupancy_2015 Fig. 1 and 4)."""

from __future__ import annotations

from ..spec.kind import CommonKeys, Described
from ..spec.layered import Layered

RINGS = 16  # a hair is a row of strips, one in each ring


def sectors(scene: CommonKeys) -> int:
    """Hairs side by side around a layer."""
    return max(12, min(96, min(scene.size) // 8))


class Hairball(Layered):
    """Hairs from the middle outwards."""

    name = "hairball"
    generator = "hairball.hairball"
    fullest = 0.95
    rows = (Described("`hairball`", "hairs from the middle outwards", "the maximum", "`mean_depth`",
                      "the Hairball: at most 180, mean up to 150"),)

    def silhouette(self, scene: CommonKeys) -> float:
        return 0.78

    def primitives(self, scene: CommonKeys) -> int:
        return scene.depth_complexity * sectors(scene) * RINGS


KIND = Hairball()
