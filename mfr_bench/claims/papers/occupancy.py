"""Claims of occupancy_2015 (Vasilakis & Papaioannou, poster and Eurographics 2015 short paper)."""

from __future__ import annotations

from ..evidence import Bound, between
from ..picks import ANY, pick
from ..rules import CountedValue, Ratio
from ..verdict import Claim, Reading

ORDER = 3

OF_ALL, OF_UNKEPT = "culled_share", "culled_of_unkept"  # fragments that never ask for the lock, of these
METHODS = ("kplus-array", "kplus-heap")


def _share(printed: float) -> Bound:
    """Discarded in a stand-in for the paper's model: within 10 percentage points of the printed share."""
    low, high = printed / 100 - 0.1, min(1.0, printed / 100 + 0.1)
    return Bound(f"{low:.2f} to {high:.2f} (printed {printed:g} %, another model)", low, high)


def _discarded(intervals: int, of: str) -> tuple[CountedValue, ...]:
    return (CountedValue(pick("kplus-array", occupancy=intervals, occupancy_bounds="box", k=8), of, _share(98.28)),
            CountedValue(pick("kplus-array", occupancy=0, k=8), of, _share(63.66)))


def _gain(intervals: int, *methods: str, bounds: str = "box") -> tuple[Ratio, ...]:
    return tuple(Ratio(pick(m, occupancy=0, occupancy_bounds=ANY),
                       pick(m, occupancy=intervals, occupancy_bounds=bounds), between(1.195, 1.505, "20 to 50 %"))
                 for m in methods or METHODS)


CLAIMS = (
    Claim(
        "oc-discard", "occupancy_2015 Fig. 1",
        "Occupancy culling discards nearly all fragments that are not kept, where k⁺ culling discards two thirds.",
        "98.28 % against 63.66 % (Hairball, 180 layers, k = 8)",
        ("occupancy2015-fig1",),
        _discarded(32, OF_UNKEPT),
        remark="the scene stands in for the Hairball, and the share of k⁺ culling depends on the order in which "
               "fragments arrive; with k = 8 of at most 180 layers no more than 1 - 8/180 = 95.6 % of all fragments of "
               "the deepest pixel can be let go",
        reading="a share of the fragments that are not kept, by 32 intervals",
        otherwise=(Reading("a share of those not kept by 128 intervals", _discarded(128, OF_UNKEPT)),
                   Reading("a share of all fragments by 32 intervals", _discarded(32, OF_ALL)),
                   Reading("a share of all fragments by 128 intervals", _discarded(128, OF_ALL))),
    ),
    Claim(
        "oc-gain", "occupancy_2015 Fig. 4",
        "Occupancy culling with d = 32 speeds the k⁺-buffer up by 20 to 50 % where pixels have many more than k "
        "fragments.",
        "20 to 50 % for k = 4 … 64, mean depth complexities 150 and 100 (GTX 780 Ti)",
        ("occupancy2015-fig4",),
        _gain(32),
        hardware="it has no early depth test in hardware, by which the fragments are refused",
        reading="d is the number of intervals, between the depths of a box",
        otherwise=(Reading("128 intervals", _gain(128)),
                   Reading("32 intervals between the depths of each pixel",
                           _gain(32, "kplus-array", bounds="geometry"))),
    ),
)
