"""Claims of GPU Pro 5, chapter 2 (Kluczek 2014)."""

from __future__ import annotations

from ..evidence import MORE, at_most
from ..measures import counted
from ..picks import pick
from ..rules import Counted, Ratio
from ..verdict import Claim

LUMINANCE, HUE = "luminance_error", "hue_error"  # values of a cell: largest and mean error of decoded colours
ROUNDING = round(1 / 255, 5)  # of a luminance in [0, 1] stored in 8 bits with gamma 2: d(v²) <= 2 · 0.5 / 255

CLAIMS = (
    Claim(
        "tc-error", "gpupro5_ch2 §2.4, §2.5",
        "Two-channel colour keeps luminance to rounding, and its error of hue grows with the variety of the colours.",
        "luminance unaffected except for rounding; hues off where a texture mixes materials",
        ("twochannel-fig4",),
        (Counted(pick(payload="two_channel"), LUMINANCE, at_most(ROUNDING)),
         *(Ratio(pick(payload="two_channel", colours=many), pick(payload="two_channel", colours="plane"), MORE,
                 measure=counted(HUE)) for many in ("hues-6", "hues-12", "any"))),
        remark="the least variety is that of one plane through black; six hues, twelve, or any are more",
    ),
)
