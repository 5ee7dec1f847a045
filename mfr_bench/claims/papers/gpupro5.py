"""Claims of GPU Pro 5, chapter 1 (Lefebvre, Hornus & Lasram 2014)."""

from __future__ import annotations

from dataclasses import replace

from ..evidence import MORE, Bound, at_most, gain, speedup
from ..measures import pass_time
from ..picks import ANY, from_, pick, within
from ..rules import PassShare, Ratio, RatioChange, Rule, Straight
from ..verdict import Claim, Reading

ORDER = 2

FOUR = ("lin-post", "lin-pre", "open-post", "open-pre")
THREE = ("lin-post", "open-post", "open-pre")
OPEN = ("open-post", "open-pre")
NO_ATOMICS_UNIT = "its atomic operations are those of a CPU"
AS_COMPARED = {  # bubble sort (§1.4.1), packed lists (§1.2.2), an emulated 64-bit maximum (§1.6), no early culling
    "lin-post": {"packed": "on", "sort": "bubble", "atomic64": ANY},
    "lin-pre": {"insert": "max64", "early_culling": "off", "atomic64": "emulated"},
    "open-post": {"sort": "bubble", "atomic64": "emulated"},
    "open-pre": {"early_culling": "off", "atomic64": "emulated"},
}


def _plain(*methods: str):
    """The methods as the chapter compares them; early culling has figures of its own."""
    return tuple(pick(m, **AS_COMPARED[m]) for m in methods)


def _gain_of_culling(method: str, **where) -> Ratio:
    off, on = (AS_COMPARED[method] | {"early_culling": chosen} for chosen in ("off", "on"))
    return Ratio(pick(method, **off), pick(method, **on), where=where)


def _grows_by_depth(power: int) -> tuple[Rule, ...]:
    """All four by this power of the depth complexity; PRE-OPEN grows more with it than each of the others."""
    return (*(Straight(cells, "depth_complexity", power=power, tolerance=0.25, grows=3) for cells in _plain(*FOUR)),
            *(RatioChange(Ratio(_plain("open-pre")[0], other), "depth_complexity", MORE)
              for other in _plain("lin-post", "lin-pre", "open-post")))


CLAIMS = (
    Claim(
        "gp-linear", "gpupro5_ch1 §1.7.2, Fig. 1.5",
        "At a fixed depth complexity the time of a frame is linear in the number of fragments.",
        "linear for all four, at depth complexities 5, 20 and 63",
        ("gpupro5-fig5",),
        tuple(Straight(cells, "fragments", tolerance=0.15, grows=2, same=("depth_complexity",))
              for cells in _plain(*FOUR)),
    ),
    Claim(
        "gp-quadratic", "gpupro5_ch1 §1.7.2, Fig. 1.6",
        "At a fixed number of fragments, time grows with the square of the depth complexity; PRE-OPEN suffers most.",
        "quadratic for all four, most severe for PRE-OPEN (2.5 M fragments, Titan)",
        ("gpupro5-fig6",),
        _grows_by_depth(power=2),
        remark="a time that hardly grows is no square: the deepest has to take three times as long, a limit of ours",
        reading="the time of a frame is quadratic in the depth complexity, as the text says",
        otherwise=(Reading(
            "a cost of each pixel that is quadratic, which at a fixed number of fragments makes a line",
            _grows_by_depth(power=1)),),
    ),
    Claim(
        "gp-load", "gpupro5_ch1 §1.5.2, Fig. 1.4",
        "Open addressing slows down sharply as the load factor nears 1.",
        "a significant drop as the load factor increases (2.5 M fragments, mean depth complexity 2.9, Titan)",
        ("gpupro5-fig4",),
        tuple(rule for cells in _plain(*OPEN) for rule in (
            Ratio(replace(cells, where=cells.where | {"load_factor": from_(0.9)}),
                  replace(cells, where=cells.where | {"load_factor": within(0.4, 0.6)})),
            Straight(cells, "load_factor", below=True, cut={"load_factor": within(0.4, 0.6)}))),
        remark="the text prints no limit: slower near 1, and by more than a straight line from the lowest load there",
    ),
    Claim(
        "gp-early", "gpupro5_ch1 §1.7.2, Fig. 1.7",
        "Dropping fragments behind an opaque front pays more as opacity grows.",
        "quickly improves as opacity increases (PRE-OPEN, 9.8 M fragments, threshold 0.95, Titan)",
        ("gpupro5-fig7",),
        tuple(rule for method in ("open-pre", "lin-pre") for rule in (
            RatioChange(_gain_of_culling(method), "opacity", MORE), _gain_of_culling(method, opacity=1))),
        remark="the figure is of PRE-OPEN; PRE-LIN affords early culling as well",
    ),
    Claim(
        "gp-prelin", "gpupro5_ch1 §1.8, Fig. 1.3",
        "PRE-LIN is the fastest of the four, and open allocation is behind linear allocation.",
        "PRE-LIN has a significant advantage, open allocation falls behind",
        ("gpupro5-fig3",),
        (*(Ratio(other, _plain("lin-pre")[0]) for other in _plain(*THREE)),
         Ratio(*_plain("open-post", "lin-post")), Ratio(*_plain("open-pre", "lin-pre"))),
        hardware="linear allocation owes its advantage to a GPU's dedicated counter",
        remark='the text adds that this is "not a strong conclusion": all but POST-LIN pay for an emulated maximum',
    ),
    Claim(
        "gp-clear", "gpupro5_ch1 §1.5.1, Fig. 1.3",
        "The clear pass is negligible for linear allocation, and for open addressing visible, a small part of it.",
        "visible for open addressing only, and a small percentage of the frame",
        ("gpupro5-fig3",),
        (*(PassShare(cells, "clear", at_most(0.02)) for cells in _plain("lin-post", "lin-pre")),
         *(PassShare(cells, "clear", Bound("0.02 to 0.25 (visible and small; the limits are ours)", 0.02, 0.25))
           for cells in _plain(*OPEN))),
        gpu_timer=True,
    ),
    Claim(
        "gp-array", "gpupro5_ch1 §1.8",
        "A local array of 256 entries makes the render pass much slower than one of 64, for the same image.",
        "57 ms against 20 ms (scene of Fig. 1.3)",
        ("gpupro5-local-array",),
        tuple(Ratio(pick(method, local_array=256, sort="bubble"), pick(method, local_array=64, sort="bubble"),
                    speedup(2.85), measure=pass_time("render")) for method in ("open-post", "lin-post")),
        hardware="a local array does not lower the number of threads that run at once",
        remark="the images are the same within 1e-4, or the cells would not be ok",
    ),
    Claim(
        "gp-cas", "gpupro5_ch1 §1.6",
        "Emulating an atomic max by compare-and-swap costs about 30 %.",
        "about 30 %, estimated from 32-bit atomics on a GTX 480",
        ("gpupro5-cas",),
        (Ratio(pick("ab-ll-bucket", maximum="compare_and_swap"), pick("ab-ll-bucket", maximum="atomic"), gain(30),
               measure=pass_time("bounds")),),
        hardware=NO_ATOMICS_UNIT,
        remark="32 bits as in the text: the pass that finds each pixel's depth bounds by an atomic minimum and maximum",
    ),
)
