"""Claims of GPU Pro 5, chapter 1 (Lefebvre, Hornus & Lasram 2014)."""

from __future__ import annotations

from ..evidence import MORE, at_least, at_most, gain, speedup
from ..measures import pass_time
from ..picks import ANY, from_, pick, within
from ..rules import Change, Ratio, Share, Straight
from ..verdict import Claim

FOUR = ("lin-post", "lin-pre", "open-post", "open-pre")
THREE = ("lin-post", "open-post", "open-pre")
OPEN = ("open-post", "open-pre")
NO_ATOMICS_UNIT = "its atomic operations are those of a CPU"


def _plain(*methods: str):
    """The methods as the chapter compares them; early culling has figures of its own."""
    return tuple(pick(m, early_culling="off", atomic64=ANY) if m.endswith("-pre") else pick(m, atomic64=ANY)
                 for m in methods)


def _gain_of_culling(method: str, **where) -> Ratio:
    return Ratio(pick(method, early_culling="off"), pick(method, early_culling="on"), where=where)


CLAIMS = (
    Claim(
        "gp-linear", "gpupro5_ch1 §1.7.2, Fig. 1.5",
        "At a fixed depth complexity the time of a frame is linear in the number of fragments.",
        "linear for all four, at depth complexities 5, 20 and 63",
        ("gpupro5-fig5",),
        tuple(Straight(cells, "fragments", tolerance=0.15, same=("depth_complexity",)) for cells in _plain(*FOUR)),
    ),
    Claim(
        "gp-quadratic", "gpupro5_ch1 §1.7.2, Fig. 1.6",
        "At a fixed number of fragments, time grows with the square of the depth complexity; PRE-OPEN suffers most.",
        "quadratic for all four, most severe for PRE-OPEN (2.5 M fragments, Titan)",
        ("gpupro5-fig6",),
        (*(Straight(cells, "depth_complexity", power=2, tolerance=0.25) for cells in _plain(*FOUR)),
         *(Change(Ratio(_plain("open-pre")[0], other), "depth_complexity", MORE)
           for other in _plain("lin-post", "lin-pre", "open-post"))),
    ),
    Claim(
        "gp-load", "gpupro5_ch1 §1.5.2, Fig. 1.4",
        "Open addressing slows down sharply as the load factor nears 1.",
        "a significant drop as the load factor increases (2.5 M fragments, mean depth complexity 2.9, Titan)",
        ("gpupro5-fig4",),
        tuple(rule for method in OPEN for rule in (
            Ratio(pick(method, load_factor=from_(0.9)), pick(method, load_factor=within(0.4, 0.6)), at_least(1.25)),
            Ratio(pick(method, load_factor=within(0.4, 0.6)), pick(method, load_factor=0.1), at_most(1.25)))),
    ),
    Claim(
        "gp-early", "gpupro5_ch1 §1.7.2, Fig. 1.7",
        "Dropping fragments behind an opaque front pays more as opacity grows.",
        "quickly improves as opacity increases (9.8 M fragments, threshold 0.95, Titan)",
        ("gpupro5-fig7",),
        tuple(rule for method in ("open-pre", "lin-pre") for rule in (
            Change(_gain_of_culling(method), "opacity", MORE), _gain_of_culling(method, opacity=from_(0.8)))),
    ),
    Claim(
        "gp-prelin", "gpupro5_ch1 §1.8, Fig. 1.3",
        "PRE-LIN is the fastest of the four, and open allocation is behind linear allocation.",
        "PRE-LIN has a significant advantage, open allocation falls behind",
        ("gpupro5-fig3",),
        (*(Ratio(other, _plain("lin-pre")[0]) for other in _plain(*THREE)),
         Ratio(*_plain("open-post", "lin-post"))),
        hardware="linear allocation owes its advantage to a GPU's dedicated counter",
    ),
    Claim(
        "gp-clear", "gpupro5_ch1 §1.5.1, Fig. 1.3",
        "The clear pass is negligible for linear allocation and visible for open addressing.",
        "visible for open addressing only, and a small part of the frame",
        ("gpupro5-fig3",),
        (*(Share(cells, "clear", at_most(0.02)) for cells in _plain("lin-post", "lin-pre")),
         *(Share(cells, "clear", at_least(0.02)) for cells in _plain(*OPEN))),
        gpu_timer=True,
    ),
    Claim(
        "gp-array", "gpupro5_ch1 §1.8",
        "A local array of 256 entries makes the render pass much slower than one of 64, for the same image.",
        "57 ms against 20 ms (scene of Fig. 1.3)",
        ("gpupro5-local-array",),
        tuple(Ratio(pick(method, local_array=256), pick(method, local_array=64), speedup(2.85),
                    measure=pass_time("render")) for method in ("open-post", "lin-post")),
        hardware="a local array does not lower the number of threads that run at once",
        remark="the images are the same within 1e-4, or the cells would not be ok",
    ),
    Claim(
        "gp-cas", "gpupro5_ch1 §1.6",
        "Emulating an atomic max by compare-and-swap costs about 30 %.",
        "about 30 %, estimated from 32-bit atomics on a GTX 480",
        ("gpupro5-fig3", "gpupro5-fig5", "gpupro5-fig6", "gpupro5-fig7"),
        (Ratio(pick("lin-pre", insert="cas32"), pick("lin-pre", insert="max64", atomic64="native"), gain(30)),),
        hardware=NO_ATOMICS_UNIT,
        remark="here the whole frame with a 64-bit max and with a list built by 32-bit compare-and-swap",
    ),
)
