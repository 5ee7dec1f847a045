"""Claims of kplus_2014 (Vasilakis & Fudos, I3D 2014) and kplus_2015 (with Papaioannou, TVCG 2015)."""

from __future__ import annotations

from ...report.reference import find
from ..evidence import LESS, MORE, Bound, BoundByMaker, speedup
from ..measures import COST, pass_time
from ..picks import ALL_LAYERS, ANY, fastest_of, from_, if_any, other_than, pick, up_to
from ..rules import Change, Memory, Ratio, RunsOut
from ..verdict import Claim

IN_ORDER = "it draws the fragments of a pixel one by one, so that none waits for another or collides"
LOCAL_MEMORY = "its local arrays are ordinary memory, which no other thread needs"
VARIANTS = ("kplus-array", "kplus-heap")
SPIN_KPLUS = fastest_of(*VARIANTS, culling="on", sync="spin")
HEAP = pick("kplus-heap", culling="on", sync="spin")
ARRAY = pick("kplus-array", culling="on", sync="spin")
MDT64 = pick("kb-mdt64", atomic64="native")
SPARSE = {"pixel_density": 0.25, "fragment_probability": 0.25}
DENSE = {"pixel_density": 0.75, "fragment_probability": 0.75}
PEELERS = pick("peel-f2b", "peel-dual")
SORTING = pass_time("resolve")


def _table_1():
    """Bytes allocated are within 1 % of the table's words; with an interlock the semaphores are left out."""
    rows = find(paper="kplus2015", quantity="words_per_pixel", condition=None)
    plain = {"sync": if_any("spin"), "atomic64": if_any("native")}
    return Memory(tuple((pick(row.method, **plain), row.formula) for row in rows), 4, "32-bit words",
                  Bound("within 1 % of 1", 0.99, 1.01))


CLAIMS = (
    Claim(
        "k-bounded", "kplus_2015 §5.1.1, Fig. 6",
        "At every k, the fastest k-buffer of bounded memory is a k⁺-buffer.",
        "faster than KB-PS, KB-MDT_32 and KB-MDT_64 at k = 4 … 64 (n = 128, GTX 780 Ti)",
        ("kplus2015-fig6",),
        (Ratio(pick("kb-ps", "kb-mdt32", "kb-mdt64", atomic64=if_any("native")), SPIN_KPLUS),),
        hardware=IN_ORDER,
        remark="KB, KB-SR and KB-MHA are not exact and stay out",
    ),
    Claim(
        "k-heap", "kplus_2015 §5.1.1, Fig. 6; kplus_2014_slides 'Impact of k'",
        "The max-heap is faster than the max-array at large k, the array at small k.",
        "heap at large k (the framework changes over at k = 16)",
        ("kplus2015-fig6", "kplus2014-k"),
        (Ratio(ARRAY, HEAP, where={"k": from_(32)}), Ratio(HEAP, ARRAY, where={"k": up_to(8)})),
    ),
    Claim(
        "k-heap64", "kplus_2015 §5.1.1, Fig. 6",
        "Keeping 64 of 128 fragments, K⁺B-Heap is several times faster than KB-PS with spin locks and than KB-MDT_32.",
        "up to 3.5 and 4 times",
        ("kplus2015-fig6",),
        tuple(Ratio(rival, HEAP, speedup(times), where={"k": 64, "n": 128})
              for rival, times in ((pick("kb-ps", sync="spin"), 3.5), (pick("kb-mdt32"), 4))),
        hardware=IN_ORDER,
    ),
    Claim(
        "k-mdt64", "kplus_2015 §5.1.1, Fig. 6",
        "KB-MDT_64 is faster than KB-MDT_32 at k = 4 and slower at larger k.",
        "faster at k = 4; held up by 64-bit atomics beyond",
        ("kplus2015-fig6",),
        (Ratio(pick("kb-mdt32"), MDT64, where={"k": 4}), Ratio(MDT64, pick("kb-mdt32"), where={"k": from_(8)})),
        hardware="it has no 64-bit atomics, and draws the fragments of a pixel one by one",
    ),
    Claim(
        "k-culling", "kplus_2015 §5.1.1, Fig. 7",
        "Refusing fragments before the lock speeds K⁺B-Array up, less so as k grows.",
        "significant at k = 4, fading towards k = 64",
        ("kplus2015-fig7", "kplus2015-fig6"),
        (Ratio(pick("kplus-array", culling="off"), pick("kplus-array", culling="on")),
         Change(Ratio(pick("kplus-array", culling="off"), pick("kplus-array", culling="on")), "k", LESS,
                same=("size", "depth_complexity"))),
    ),
    Claim(
        "k-memory", "kplus_2015 §5.1.1, Fig. 8",
        "Where memory counts as much as time, K⁺B-AB_SB is best on sparse scenes; KB-AB_Array, KB-AB_SB and KB-LL "
        "run out of 3 GB at k = 64.",
        "best at p_d = f_p = 0.25; the three fail at n = 640",
        ("kplus2015-fig8",),
        (Ratio(pick("kplus-array", "kplus-heap", "kb-mdt32", "kb-ab-array", "kb-ab-ll", "kb-ab-sb", "kb-ll", hash=ANY),
               pick("kplus-sb", hash=ANY), where=SPARSE, measure=COST),
         *(RunsOut(pick(method, k=64, n=640, **DENSE)) for method in ("kb-ab-array", "kb-ab-sb", "kb-ll"))),
        remark="ms per MB is read as ms × MB, the inverse of kplus_2014's fps per MB; out of memory is a budget of "
               "3072 MiB, which the cells' configuration sets",
    ),
    Claim(
        "k-sync", "kplus_2015 §5.1.1, Fig. 9 left",
        "A hardware interlock beats the spin lock, and with it K⁺B-Array is faster than KB-PS.",
        "about 2 times on a GTX 970, 1.5 times on an Iris Pro 5200",
        ("kplus2015-fig9-sync",),
        (*(Ratio(pick(m, sync="spin"), pick(m, sync="interlock")) for m in ("kplus-array", "kb-ps")),
         Ratio(pick("kb-ps", sync="interlock"), pick("kplus-array", sync="interlock"),
               BoundByMaker({"NVIDIA": speedup(2), "Intel": speedup(1.5)}, MORE))),
        hardware=IN_ORDER,
    ),
    Claim(
        "k-sorted", "kplus_2014_slides 'Impact of Sorting'",
        "On depth-sorted scenes, as k asks for more passes, K⁺B is faster than KB-SR and KB-SR than KB.",
        "K⁺B > KB-SR > KB",
        ("kplus2014-sorting",),
        tuple(Ratio(slower, faster, where={"k": from_(16), "order": other_than("random")})
              for slower, faster in ((pick("kb-sr"), fastest_of(*VARIANTS)), (pick("kb"), pick("kb-sr")))),
        remark="KB and KB-SR keep to one pass here, with k up to 16 and 32",
    ),
    Claim(
        "k-peel", "kplus_2015 §5.1.2, Fig. 9 right",
        "Peeling 8 or 32 layers a pass with K⁺B-Array is faster than front-to-back and dual depth peeling.",
        "faster at k = 8 and 32",
        ("kplus2015-fig9-abuffer",),
        tuple(Ratio(PEELERS, pick("peel-kplus", k=k)) for k in (8, 32)),
    ),
    Claim(
        "k-revised", "kplus_2015 §5.1.2, Fig. 9 right",
        "With k = n, K⁺B-Array-R is faster than every A-buffer that allocates what it needs, and slightly slower than "
        "AB_Array.",
        "better than all of them, slightly worse than AB_Array",
        ("kplus2015-fig9-abuffer",),
        (Ratio(pick("ab-ll", "ab-ll-bucket", "ab-sb"), pick("kplus-array-r", k=ALL_LAYERS)),
         Ratio(pick("kplus-array-r", k=ALL_LAYERS), pick("ab-array"), Bound("1 to 1.25 (slightly)", 1.0, 1.25))),
        hardware=IN_ORDER,
    ),
    Claim(
        "k-absb", "kplus_2015 §5.1.2, Fig. 9 right; kplus_2014_slides 'Impact of k, A-buffer'",
        "With k = n, K⁺B-AB_SB is slower than AB_SB.",
        "slower in all cases",
        ("kplus2015-fig9-abuffer", "kplus2014-abuffer"),
        (Ratio(pick("kplus-sb", k=ALL_LAYERS, hash=ANY), pick("ab-sb", hash=ANY)),),
        hardware=IN_ORDER,
    ),
    Claim(
        "k-lsort", "kplus_2015 §5.1.2",
        "l⁺-depth-sorting makes the sort of deep pixels several times faster than the hybrid sort.",
        "3.1 times at n = 64, 4.64 times at n = 128",
        ("kplus2015-lsort",),
        tuple(Ratio(pick(sort="hybrid"), pick(sort="lplus"), speedup(times), where={"n": n}, measure=SORTING)
              for n, times in ((64, 3.1), (128, 4.64))),
        hardware=LOCAL_MEMORY,
    ),
    Claim(
        "k-words", "kplus_2015 Table 1",
        "The k-buffers need the 32-bit words per pixel that Table 1 gives for them.",
        "2k to 4k words of bounded memory, 2k + 2 for K⁺B, 2n + 1, 3f + 1, 3f + 6, 2f + 2 and 2f_k + 3 for the others",
        ("kplus2015-table1",),
        (_table_1(),),
        remark="without attribute packing, and with spin locks, for which KB-PS takes a word that the table leaves out",
    ),
)
