"""Claims of GPU Pro 5, chapter 2 (Kluczek 2014)."""

from __future__ import annotations

from itertools import pairwise

from ..evidence import MORE, at_most
from ..measures import counted
from ..picks import pick
from ..rules import CountedValue, Ratio
from ..verdict import Claim, Reading

ORDER = 4

LUMINANCE, HUE = "luminance_error", "hue_error"  # values of a cell: largest and mean error of decoded colours
ROUNDING = round(1 / 255, 5)  # of a luminance in [0, 1] stored in 8 bits with gamma 2: d(v²) <= 2 · 0.5 / 255

FEW, MANY = ("plane", "hues-1", "hues-2"), ("hues-6", "hues-12", "any")  # what one plane holds, and what it does not
KEPT = CountedValue(pick(payload="two_channel"), LUMINANCE, at_most(ROUNDING))


def _worse(more: str, less: str) -> Ratio:
    return Ratio(pick(payload="two_channel", colours=more), pick(payload="two_channel", colours=less), MORE,
                 measure=counted(HUE))


CLAIMS = (
    Claim(
        "tc-error", "gpupro5_ch2 §2.4, §2.5",
        "Two-channel colour keeps luminance to rounding, and its error of hue grows with the variety of the colours.",
        "luminance unaffected except for rounding; hues off where a texture mixes materials",
        ("twochannel-fig4",),
        (KEPT, *(_worse(more, less) for less, more in pairwise(("hues-2", *MANY)))),
        reading="each step from 2 hues over 6 and 12 to any adds error",
        otherwise=(Reading("the colours of many hues have more error than those that one plane holds",
                           (KEPT, *(_worse(more, less) for more in MANY for less in FEW))),),
    ),
)
