"""The look of figures: colours, markers, hatches, type sizes. The one place to restyle every figure."""

from __future__ import annotations

import colorsys
import zlib
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from functools import cache

WIDTH_IN = 7.2  # the text width of a two-column paper
NARROW_IN = 3.5  # one of its columns
DPI = 150  # 1080 pixels across: 100 % on a screen
FONT = "mfr-bench DejaVu Sans"  # see sheet.styled
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
VARIANT_COLOURS = (BLUE, ORANGE, GREEN, VERMILION, SKY, PURPLE, "#5f6368", "#993f00")  # of one method's variants, alone

PASS_COLOURS = {  # the same step of a frame has one colour in every figure; legends keep this order
    "clear": GREY, "bounds": PURPLE, "count": YELLOW, "histogram": "#882255", "referencing": VERMILION,
    "scan": "#993f00", "store": BLUE, "build": "#1c4587", "peel": GREEN, "sort": "#44aa99", "resolve": ORANGE,
    "render": "#b87f00", "composite": "#f5cf80",
}
SPARE_PASS_COLOURS = (SKY, GREEN, PURPLE, VERMILION, YELLOW)  # for passes without a fixed colour
WHOLE_FRAME = "#c4c8cc"  # a frame whose passes were not timed

# A method has one colour in every figure: its family's, in the shade of its place among the family's methods. A
# family's colour is found by the hash of its name, so that a new family changes no other's; where an earlier one of the
# catalog has it, the next free one is taken. The colours come from a search for the largest least difference in CIE Lab
# among methods that figures of the papers show together, for normal sight and without red or green cones.
FAMILY_SALT = 8439
FAMILY_COLOURS = (
    "#b50f7f", "#9a56de", "#146f29", "#c3826b", "#aaaf34", "#0618f7", "#9b2727", "#d1d147", "#170a86", "#e41a1c",
    "#279b27", "#47d1d1", "#bc9089", "#f1b57e", "#5f6368", "#546e7a", "#d03b7a", "#caca98", "#27279b", "#00897b",
    "#ff6f00", "#749156", "#ad8f00", "#d147d1")
SHADES = ((0.0, 1.0), (-0.073, 0.42), (-0.106, 1.5), (0.102, 1.72), (-0.145, 1.78), (-0.037, 1.03), (-0.145, 0.65),
          (0.146, 0.98))  # of hue (turns) and of lightness (factor)

TINTS = (0.0, 0.45, 0.25, 0.62)  # of a method's variants beside other methods: how far on the way to white, or black
LIGHT = 0.45  # the lightness from which variants are darker than their method

MARKERS = ("o", "s", "^", "D", "v", "P", "X", "<", ">", "p", "h", "*", "d", "8", "H")
LINES = ("-", (0, (5, 1.5)), (0, (1.5, 1)), (0, (5, 1, 1.2, 1)), (0, (3, 1, 1, 1, 1, 1)))
HATCHES = ("", "----", "||||", "++++", "////", "\\\\\\\\", "xxxx", "--", "||", "++", "//", "\\\\", "xx", "////----",
           "\\\\\\\\||||")  # straight lines only: dots make vector files large
HISTOGRAM = "#8fa3b8"
MAP_COLOURS = "inferno"  # of maps: grows in lightness, whatever the sight
PRINTED = {"linestyle": "", "marker": "D", "markersize": 4.2, "markerfacecolor": "white", "markeredgecolor": "#1a1a1a",
           "markeredgewidth": 0.9}  # the papers' own numbers
GUIDE = {"color": "#1a1a1a", "linewidth": 0.8, "linestyle": (0, (1, 1.6)), "zorder": 1.2}
OVER = {"linestyle": "", "marker": "X", "markersize": 5.0, "markeredgecolor": "white", "markeredgewidth": 0.4,
        "zorder": 5, "clip_on": False}  # cells without a value for lack of memory
HATCH_INKS = (1.0, 1.0, 1.0, 0.6), (0.1, 0.1, 0.1, 0.5)  # on dark and on light colours
HATCHED_DARK = 0.6  # the lightness from which a bar of one colour is hatched in dark
ALIKE = 0.12  # of lightness, up to which two colours are hard to tell apart in grey

# The outcomes of a method at a level of a stressor: fill and ink.
STATE_COLOURS = {
    "holds": ("#cfe8dc", "#2d5f4a"), "differs": ("#ffe08a", INK), "bound": ("#f5a35c", INK),
    "image": ("#d1495b", "white"), "lost": ("#8e2f7f", "white"), "refused": ("#c4c8cc", INK),
    "ties": ("#a9c8e8", INK), "hung": ("#54606b", "white"), "crashed": ("#101418", "white"),
}

RC = {
    "font.family": FONT, "font.size": 8.0, "axes.titlesize": 8.0, "axes.labelsize": 8.0,
    "xtick.labelsize": 7.5, "ytick.labelsize": 7.5, "legend.fontsize": 7.5,
    "text.color": INK, "axes.labelcolor": INK, "axes.edgecolor": QUIET, "xtick.color": INK, "ytick.color": INK,
    "axes.linewidth": 0.6, "xtick.major.width": 0.6, "ytick.major.width": 0.6, "ytick.minor.width": 0.4,
    "xtick.minor.width": 0.4, "axes.spines.top": False, "axes.spines.right": False, "axes.axisbelow": True,
    "axes.titley": 1.0,  # titles stand where they are put: finding a place clear of ticks lays out every tick twice
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
    return _towards(255, colour, 0.45)


def tint(colour: str, variant: int) -> str:
    """The colour of a method for one of its variants: the first has it as it is, light ones grow darker."""
    return _towards(255 if lightness(colour) < LIGHT else 0, colour, TINTS[variant % len(TINTS)])


def lightness(colour: str) -> float:
    """The luma of a colour, from 0 for black to 1 for white."""
    return sum(weight * c for weight, c in zip((0.299, 0.587, 0.114), _channels(colour), strict=True)) / 255


def hatch_ink(colours: Sequence[str]) -> tuple[float, ...]:
    """The ink of the hatching over pieces of these colours, light unless all of them are."""
    return HATCH_INKS[min(map(lightness, colours)) > HATCHED_DARK]


def hatches(methods: Mapping[str, str], coloured: bool) -> dict[str, str]:
    """A hatching for each label of a chart of bars: the same one in every chart that has these labels.

    Each label has one of its own as far as HATCHES go; beyond that, those differ that are of one method or whose
    methods are alike in grey. Where bars have the colours of their methods, a label that lightness and method tell from
    all others has none.

    methods: by label, in the chart's order. coloured: whether each bar has the colour of its method, and no others.
    """
    shades = {label: lightness(method_colour(method)) for label, method in methods.items()}
    found: dict[str, str] = {}
    for label in methods:
        every = Counter(found.values())
        near = Counter(hatch for other, hatch in found.items() if _alike(methods, shades, label, other))
        found[label] = min(HATCHES, key=lambda hatch, near=near, every=every: (near[hatch], every[hatch]))
    return {label: hatch if not coloured or any(_alike(methods, shades, label, other) for other in methods
                                                if other != label) else "" for label, hatch in found.items()}


def _alike(methods: Mapping[str, str], shades: Mapping[str, float], one: str, other: str) -> bool:
    """Whether the colours of two labels' methods do not tell them apart in grey."""
    return methods[one] == methods[other] or abs(shades[one] - shades[other]) < ALIKE


def _towards(end: int, colour: str, share: float) -> str:
    return "#" + "".join(f"{round(c + share * (end - c)):02x}" for c in _channels(colour))


def _channels(colour: str) -> tuple[int, ...]:
    return tuple(int(colour[i:i + 2], 16) for i in (1, 3, 5))


@cache
def method_colours() -> dict[str, str]:
    """The colour of every method of the catalog by id."""
    from ..methods import catalog

    families: dict[str, list[str]] = {}
    for method in catalog().values():
        families.setdefault(method.family, []).append(method.id)
    colours = family_colours(families)
    return {method: _shade(colours[family], place) for family, members in families.items()
            for place, method in enumerate(members)}


def family_colours(families: Iterable[str]) -> dict[str, str]:
    """A colour for each family; they repeat only where there are more families than colours."""
    slots: dict[int, str] = {}
    for family in families:
        slot = zlib.crc32(f"{FAMILY_SALT}{family}".encode())
        while slot % len(FAMILY_COLOURS) in slots and len(slots) < len(FAMILY_COLOURS):
            slot += 1
        slots[slot % len(FAMILY_COLOURS) if len(slots) < len(FAMILY_COLOURS) else slot] = family
    return {family: FAMILY_COLOURS[slot % len(FAMILY_COLOURS)] for slot, family in slots.items()}


def _shade(colour: str, place: int) -> str:
    turn, factor = SHADES[place % len(SHADES)]
    hue, lightness, saturation = colorsys.rgb_to_hls(*(int(colour[i:i + 2], 16) / 255 for i in (1, 3, 5)))
    return _hex(hue + turn + 0.02 * (place // len(SHADES)), min(0.8, lightness * factor), saturation)


def _hex(hue: float, lightness: float, saturation: float) -> str:
    return "#" + "".join(f"{round(255 * c):02x}" for c in colorsys.hls_to_rgb(hue % 1, lightness, saturation))


def _colour_of_name(name: str) -> str:
    digest = zlib.crc32(name.encode())
    return _hex(digest % 360 / 360, (0.35, 0.5, 0.62)[digest // 360 % 3], 0.7)


def method_colour(method: str) -> str:
    """The colour of a method id; one that the id alone determines where the catalog does not have it."""
    return method_colours().get(method) or _colour_of_name(method)
