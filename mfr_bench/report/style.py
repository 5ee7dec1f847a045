"""How figures look: colours, markers, hatches, type sizes. The one place to restyle every figure."""

from __future__ import annotations

import colorsys
import zlib
from collections.abc import Iterable

WIDTH_IN = 7.2  # the text width of a two-column paper
NARROW_IN = 3.5  # one of its columns
DPI = 150  # 1080 pixels across: 100 % on a screen
TITLE_PT, SMALL_PT, NUMBER_PT, SIGN_PT = 10.0, 6.2, 5.6, 6.0

INK = "#1a1a1a"
QUIET = "#5f6368"  # small print, signs
RULE = "#d5d8dc"
BAND = "#f4f5f7"
ALARM = "#b3261e"

# Okabe & Ito's colours, apart for every common colour blindness.
ORANGE, SKY, GREEN, YELLOW, BLUE, VERMILION, PURPLE = (
    "#e69f00", "#56b4e9", "#009e73", "#f0e442", "#0072b2", "#d55e00", "#cc79a7")
GREY = "#9aa0a6"

PASS_COLOURS = {  # the same step of a frame has one colour in every figure; legends keep this order
    "clear": GREY, "bounds": PURPLE, "count": YELLOW, "histogram": "#882255", "referencing": VERMILION,
    "scan": "#993f00", "store": BLUE, "build": "#1c4587", "peel": GREEN, "sort": "#44aa99", "resolve": ORANGE,
    "render": "#b87f00", "composite": "#f5cf80",
}
SPARE_PASS_COLOURS = (SKY, GREEN, PURPLE, VERMILION, YELLOW)  # for passes without a fixed colour
WHOLE_FRAME = "#c4c8cc"  # a frame whose passes were not timed

# A method has one colour in every figure. Related methods have related hues: k+-buffers green, k-buffers blue to
# violet, A-buffers orange to red, peeling pink. A method that is not named here gets a colour from its id.
METHOD_COLOURS = {
    "floor": "#202124", "zbuffer": "#80868b",
    "peel-f2b": "#c2187a", "peel-dual": "#f08cb4", "peel-bucket": "#7b1045", "peel-srab": "#e0529c",
    "peel-kplus": "#a86fb0",
    "ab-array": "#d55e00", "ab-ll": "#e69f00", "ab-ll-paged": "#f0c27a", "ab-ll-bucket": "#8c4a00", "ab-sb": "#b3261e",
    "ab-lbuffer": "#f0806a", "ab-precalc": "#6d1f0f", "ab-precalc-fixed": "#ff6f43", "ab-dfb": "#c49a6c",
    "lin-post": "#6b6b00", "lin-pre": "#c9b400", "open-post": "#4e342e", "open-pre": "#a1887f",
    "kb": "#08306b", "kb-multi": "#6baed6", "kb-sr": "#3f7fbf", "kb-ps": "#0072b2", "kb-mdt32": "#7b5cd6",
    "kb-mdt64": "#b39ddb", "kb-mha": "#4a148c", "kb-ab-array": "#56b4e9", "kb-ab-ll": "#1e3a8a",
    "kb-ab-sb": "#8fa8e8", "kb-ll": "#00a3c4",
    "kplus-array": "#00734f", "kplus-array-r": "#66a61e", "kplus-heap": "#14b8a6", "kplus-sb": "#a8c700",
    "kplus-sb-dynamic": "#3f5f00", "kplus-generic": "#7fd6b0",
}

MARKERS = ("o", "s", "^", "D", "v", "P", "X", "<", ">", "p", "h", "*", "d", "8", "H")
LINES = ("-", (0, (5, 1.5)), (0, (1.5, 1)), (0, (5, 1, 1.2, 1)), (0, (3, 1, 1, 1, 1, 1)))
HATCHES = ("", "////", "\\\\\\\\", "xxxx", "----", "||||", "++++", "//", "\\\\", "xx", "--", "||", "++", "////----",
           "\\\\\\\\||||")  # straight lines only: dots make vector files large
HATCH_INK = (1.0, 1.0, 1.0, 0.6)

RC = {
    "font.family": "DejaVu Sans", "font.size": 8.0, "axes.titlesize": 8.0, "axes.labelsize": 8.0,
    "xtick.labelsize": 7.5, "ytick.labelsize": 7.5, "legend.fontsize": 7.5,
    "text.color": INK, "axes.labelcolor": INK, "axes.edgecolor": QUIET, "xtick.color": INK, "ytick.color": INK,
    "axes.linewidth": 0.6, "xtick.major.width": 0.6, "ytick.major.width": 0.6, "ytick.minor.width": 0.4,
    "xtick.minor.width": 0.4, "axes.spines.top": False, "axes.spines.right": False, "axes.axisbelow": True,
    "grid.color": RULE, "grid.linewidth": 0.5, "hatch.linewidth": 0.35, "lines.linewidth": 1.3,
    "lines.markersize": 4.5, "legend.frameon": False, "text.parse_math": False,  # a $ in a label is a $
    "svg.hashsalt": "mfr-bench", "svg.fonttype": "path", "path.simplify": False,
}


def pass_colours(names: Iterable[str]) -> dict[str, str]:
    """A colour for each pass, in the order of a legend. 'store depth' is a lighter 'store'."""
    rank = {name: i for i, name in enumerate(PASS_COLOURS)}
    ordered = sorted(names, key=lambda name: (rank.get(first_word(name), len(rank)), rank.get(name, len(rank))))
    return {name: _pass_colour(name) for name in ordered}


def first_word(name: str) -> str:
    return name.replace("-", " ").replace("_", " ").split(" ")[0]


def _pass_colour(name: str) -> str:
    if name in PASS_COLOURS:
        return PASS_COLOURS[name]
    if first_word(name) in PASS_COLOURS:
        return lighter(PASS_COLOURS[first_word(name)])
    return SPARE_PASS_COLOURS[zlib.crc32(name.encode()) % len(SPARE_PASS_COLOURS)]


def lighter(colour: str) -> str:
    channels = (int(colour[i:i + 2], 16) for i in (1, 3, 5))
    return "#" + "".join(f"{round(c + 0.45 * (255 - c)):02x}" for c in channels)


def method_colour(method: str) -> str:
    """The colour of a method id: its own, or one that the id alone determines."""
    if method in METHOD_COLOURS:
        return METHOD_COLOURS[method]
    digest = zlib.crc32(method.encode())
    red, green, blue = colorsys.hls_to_rgb(digest % 360 / 360, (0.35, 0.5, 0.62)[digest // 360 % 3], 0.7)
    return f"#{round(255 * red):02x}{round(255 * green):02x}{round(255 * blue):02x}"
