"""Claims of occupancy_2015 (Vasilakis & Papaioannou, poster and Eurographics 2015 short paper)."""

from __future__ import annotations

from ..evidence import Bound, between
from ..picks import other_than, pick
from ..rules import Counted, Ratio
from ..verdict import Claim

DISCARDED = "culled_share"  # value of a cell: fragments that never ask for the lock / generated
METHODS = ("kplus-array", "kplus-heap")


def _share(printed: float) -> Bound:
    """Discarded in a stand-in for the paper's model: within 10 percentage points of the printed share."""
    low, high = printed / 100 - 0.1, min(1.0, printed / 100 + 0.1)
    return Bound(f"{low:.2f} to {high:.2f} (printed {printed:g} %, another model)", low, high)


CLAIMS = (
    Claim(
        "oc-discard", "occupancy_2015 Fig. 1",
        "Occupancy culling discards nearly all fragments that are not kept, where k⁺ culling discards two thirds.",
        "98.28 % against 63.66 % (Hairball, 180 layers, k = 8)",
        ("occupancy2015-fig1",),
        (Counted(pick("kplus-array", occupancy=other_than(0), k=8), DISCARDED, _share(98.28)),
         Counted(pick("kplus-array", occupancy=0, k=8), DISCARDED, _share(63.66))),
        remark="the scene stands in for the Hairball; with k = 8 of at most 180 layers no more than 1 - 8/180 = 95.6 % "
               "of a pixel's fragments can be let go, so that the printed share must count something else",
    ),
    Claim(
        "oc-gain", "occupancy_2015 Fig. 4",
        "Occupancy culling with 32 intervals speeds the k⁺-buffer up by 20 to 50 % where pixels have many more than k "
        "fragments.",
        "20 to 50 % for k = 4 … 64, mean depth complexities 150 and 100 (GTX 780 Ti)",
        ("occupancy2015-fig4",),
        tuple(Ratio(pick(m, occupancy=0), pick(m, occupancy=32), between(1.15, 1.55, "20 to 50 %")) for m in METHODS),
        hardware="it has no early depth test in hardware, by which the fragments are refused",
    ),
)
