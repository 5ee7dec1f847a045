"""Claims of sbuffer_2012 (Vasilakis & Fudos, Eurographics 2012 short papers)."""

from __future__ import annotations

from ...report.reference import find
from ...store.status import EXACT_ERROR
from ..evidence import MORE, Bound, about, at_least, at_most, between, gain, margin, speedup
from ..measures import MEMORY, pass_time
from ..memory_rules import Memory
from ..picks import from_, if_any, other_than, pick, up_to
from ..rules import CountedValue, Ratio, no_faster_than, no_slower_than
from ..verdict import Claim

ORDER = 0

FEW_THREADS = "few threads share the counters, which a GPU's pixels contend for"
PRECALC = pick("ab-precalc", scan="compute")  # the stand-in for PreCalc_OpenCL
COUNTED = if_any("atomic")  # fragments, where additive blending is a further series
AT_30 = pick("ab-sb", counters=30, counting=COUNTED)
INVERSE = pick("ab-sb", counters=30, mapping="inverse", counting=COUNTED)
REFERENCING = pass_time("referencing", "scan")
LAYERS = {"kb": {"per_pass": 8}, "peel-srab": {"samples": 8}}  # fragments per pass of the paper's bounded methods
OWN_RATIOS = Bound("4.45 to 7.5 (printed: 5 to 7, and times whose ratios are 4.49 to 6.98)", 4.45, 7.5)
SIZES = ((640, 480), (1024, 768), (1600, 1200))

CLAIMS = (
    Claim(
        "sb-peak", "sbuffer_2012 §4, Fig. 3",
        "S-buffer is fastest with about 30 shared counters, slower with one and slower with many more.",
        "peak at about 30 counters (GTX 480, 1024×1024, 12 layers)",
        ("sbuffer2012-fig3",),
        (no_faster_than(pick("ab-sb", counters=other_than(30)), AT_30, slack=0.05),
         Ratio(pick("ab-sb", counters=1), AT_30, margin(0.05)),
         Ratio(pick("ab-sb", counters=from_(512)), AT_30, margin(0.05))),
        hardware=FEW_THREADS,
    ),
    Claim(
        "sb-two", "sbuffer_2012 §4, Fig. 3",
        "Two shared counters are enough to match PreCalc with the parallel scan while most pixels are empty.",
        "matched with two counters at high sparsity",
        ("sbuffer2012-fig3",),
        (no_slower_than(pick("ab-sb", counters=2), PRECALC, slack=0.05, where={"pixel_density": up_to(0.25)}),),
        hardware=FEW_THREADS,
        remark="the parallel scan is a compute shader here, OpenCL in the paper",
    ),
    Claim(
        "sb-full", "sbuffer_2012 §4, Fig. 3",
        "Where every pixel is covered, S-buffer is still about 7 % faster than PreCalc with the parallel scan.",
        "7 % faster",
        ("sbuffer2012-fig3",),
        (Ratio(PRECALC, AT_30, gain(7), where={"pixel_density": 1}),),
        hardware=FEW_THREADS,
    ),
    Claim(
        "sb-optimal", "sbuffer_2012 §4, Fig. 4",
        "S-buffer with 30 counters reaches 85 to 90 % of PreCalc_Fixed's frame rate.",
        "85 to 90 % at three sizes",
        ("sbuffer2012-fig4",),
        (Ratio(pick("ab-precalc-fixed"), INVERSE, between(0.825, 0.925, "85 to 90 %")),),
        hardware=FEW_THREADS,
    ),
    Claim(
        "sb-inverse", "sbuffer_2012 §4, Fig. 4",
        "Mapping half of the counters from the end of memory speeds S-buffer up, less so at larger sizes.",
        "13, 10 and 6 % at 640×480, 1024×768 and 1600×1200",
        ("sbuffer2012-fig4",),
        tuple(Ratio(pick("ab-sb", counters=30, mapping="forward"), INVERSE, gain(percent), where={"size": size})
              for size, percent in zip(SIZES, (13, 10, 6), strict=True)),
        hardware=FEW_THREADS,
    ),
    Claim(
        "sb-ref", "sbuffer_2012 §4",
        "S-buffer's referencing takes about ten times as long as PreCalc_Fixed's and a fifth to a seventh of the "
        "parallel scan; linked lists take longest.",
        "0.215, 0.425, 1.08 ms; PreCalc_Fixed 0.027, 0.05, 0.11; scan 1.5, 2.45, 4.85; lists 4.66, 10.4, 21.98 "
        "(ratios of these times: 8.0, 8.5, 9.8 and 7.0, 5.8, 4.49)",
        ("sbuffer2012-referencing",),
        (Ratio(INVERSE, pick("ab-precalc-fixed"), about(10), measure=REFERENCING),
         Ratio(PRECALC, INVERSE, OWN_RATIOS, measure=REFERENCING),
         Ratio(pick("ab-ll"), PRECALC, MORE, measure=pass_time("referencing", "scan", "store"))),
        hardware=FEW_THREADS, gpu_timer=True,
        remark="linked lists have no referencing pass: their store, which takes cells as it goes, stands for it",
    ),
    Claim(
        "sb-memory", "sbuffer_2012 §4",
        "Fixed arrays need most memory by far, linked lists slightly more than S-buffer, and nothing less than it.",
        "MB at three sizes, which follow from bytes per pixel and fragment; of these formulas' results two differ from "
        "the print: 156.0 MB (printed 159) for fixed arrays at 1024×768, 54.5 MB (printed 51.7) for lists at 1600×1200",
        ("sbuffer2012-memory",),
        (Memory(tuple((pick(row.method, **LAYERS.get(row.method, {})), row.formula)
                      for row in find(paper="sbuffer2012", quantity="memory", width=640) if row.method != "peel-srab"),
                1, "bytes", Bound("0.667 to 1.05 (two thirds of the print to 5 % more)", 2 / 3, 1.05)),
         *(Ratio(pick(method), AT_30, speedup(8.72), measure=MEMORY) for method in ("ab-array", "ab-precalc-fixed")),
         Ratio(pick("ab-ll"), AT_30, Bound("1 to 1.5 (slightly; printed: 1.18 to 1.25)", 1.0, 1.5), measure=MEMORY),
         Ratio(PRECALC, AT_30, at_least(0.99), measure=MEMORY)),
        remark="the table is for another scene: each formula is taken with the pixels, n and fragments of the cell. "
               "PreCalc needs as much as S-buffer here but for its counters; what the printed 3.5 bytes per pixel more "
               "are for the paper does not say. SRAB is left out: it holds every pass's layers here",
    ),
    Claim(
        "sb-ll", "sbuffer_2012 §4, Fig. 3",
        "Linked lists are the slowest of the A-buffers that allocate only what they need.",
        "worst behaviour of Fig. 3",
        ("sbuffer2012-fig3",),
        tuple(Ratio(pick("ab-ll"), rival) for rival in (AT_30, PRECALC, pick("ab-sb", counters=1))),
        hardware="all fragments take cells from one counter, for which few threads contend",
    ),
    Claim(
        "sb-effects", "sbuffer_2012 §3.3, Fig. 2",
        "The sorted fragments of the S-buffer give transparency, translucency and CSG.",
        "pictures of the three",
        ("sbuffer2012-fig2",),
        (CountedValue(pick("ab-sb"), "max_error_all", at_most(EXACT_ERROR)),),
        remark="compared with a float64 model of each effect, since the paper prints pictures of models without names",
    ),
)
