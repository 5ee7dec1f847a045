"""Claims of kplus_2014 (Vasilakis & Fudos, I3D 2014) and kplus_2015 (with Papaioannou, TVCG 2015)."""

from __future__ import annotations

from ...report.reference import find
from ...store.status import EXACT_ERROR
from ..evidence import LESS, MORE, Bound, BoundByMaker, at_most, speedup
from ..measures import COST, PRINTED_COST, Quantity, pass_time
from ..memory_rules import Memory, RunsOut
from ..picks import ALL_LAYERS, ANY, UNSET, Pick, fastest_of, from_, if_any, other_than, pick, up_to
from ..rules import CountedValue, Ratio, RatioChange, Rule
from ..verdict import Claim, Reading

ORDER = 1

IN_ORDER = "it draws the fragments of a pixel one by one, so that none waits for another or collides"
LOCAL_MEMORY = "its local arrays are ordinary memory, which no other thread needs"
VARIANTS = ("kplus-array", "kplus-heap")
SPIN_KPLUS = fastest_of(*VARIANTS, culling="on", sync="spin")
HEAP = pick("kplus-heap", culling="on", sync="spin")
ARRAY = pick("kplus-array", culling="on", sync="spin")
MDT32 = pick("kb-mdt32", culling="off")
MDT64 = pick("kb-mdt64", atomic64="native")
PS = pick("kb-ps", sync="spin", culling="off")  # before K⁺B nothing had its culling test (§5.1.1)
KB, ROUTED = pick("kb", per_pass=ANY), pick("kb-sr", per_pass=other_than(4))  # 0 where a pass holds k
SPARSE = {"pixel_density": 0.25, "fragment_probability": 0.25}
DENSE = {"pixel_density": 0.75, "fragment_probability": 0.75}
DRAWN, ALL_ALIKE = {"least_depth": 0.1}, {"least_depth": UNSET}  # n from k to 10 k, or 10 k in every covered pixel
KPLUS_BOUNDED = pick("kplus-array", "kplus-heap", sort=ANY, hash=ANY, culling=ANY)
AWARE = pick("kb-ab-array", "kb-ab-ll", "kb-ab-sb", "kb-ll", sort=ANY, hash=ANY)
KPLUS_SB = pick("kplus-sb", sort="lplus", hash=ANY, culling=ANY)
PEELERS = pick("peel-f2b", "peel-dual")
SORTING = pass_time("resolve")


LEFT_OUT_OF_TABLE_1 = ("kb-multi",)  # two words of ours that its source does not have


def _table_1():
    """Bytes allocated are within 1 % of the table's words; KB-PS with an interlock, which needs no semaphore."""
    rows = find(paper="kplus2015", quantity="words_per_pixel", condition=None)
    plain = {"sync": if_any("spin"), "atomic64": if_any("native")}
    own = {"kb-ps": {"sync": "interlock"}}
    return Memory(tuple((pick(row.method, **plain | own.get(row.method, {})), row.formula) for row in rows
                        if row.method not in LEFT_OUT_OF_TABLE_1),
                  4, "32-bit words", Bound("within 1 % of 1", 0.99, 1.01))


def _memory_and_time(scenes: dict, measure: Quantity) -> tuple[Rule, ...]:
    """Fig. 8: K⁺B-AB_SB against bounded methods where sparse and dense, against memory-aware ones where dense."""
    return (Ratio(KPLUS_BOUNDED, KPLUS_SB, where=SPARSE | scenes, measure=measure),
            Ratio(pick("kb-mdt32", culling="off"), pick("kplus-sb", sort="lplus", culling=ANY), where=SPARSE | scenes,
                  measure=measure),
            Ratio(AWARE, KPLUS_SB, where=DENSE | scenes, measure=measure),
            Ratio(KPLUS_SB, KPLUS_BOUNDED, where=DENSE | scenes, measure=measure))


def _runs_out(scenes: dict, *methods: str) -> tuple[RunsOut, ...]:
    return tuple(RunsOut(pick(method, k=64, n=640, **DENSE | scenes)) for method in methods)


def _interlocked(sync: str, culls: str) -> tuple[Ratio, ...]:
    """Fig. 9 left: the interlock beats the spin lock, and K⁺B-Array with it KB-PS, of which `culls` says how."""
    return (Ratio(pick("kplus-array", sync="spin"), pick("kplus-array", sync=sync)),
            Ratio(pick("kb-ps", sync="spin", culling=culls), pick("kb-ps", sync=sync, culling=culls)),
            Ratio(pick("kb-ps", sync=sync, culling=culls), pick("kplus-array", sync=sync, culling="on"),
                  BoundByMaker({"NVIDIA": speedup(2), "Intel": speedup(1.5)}, MORE)))


def _presorted(routed: Pick, **at) -> tuple[Ratio, ...]:
    """The order of speed where fragments come sorted: KB before KB-PS `at` these k, `routed` is KB-SR."""
    by_speed = ((HEAP, ARRAY, {}), (PS, KB, at),
                *((slower, faster, {"k": from_(16)}) for slower, faster in (
                    (KB, fastest_of(*VARIANTS)), (routed, fastest_of(*VARIANTS)), (KB, routed))))
    return tuple(Ratio(slower, faster, where={"order": other_than("random"), **where})
                 for slower, faster, where in by_speed)


CLAIMS = (
    Claim(
        "k-bounded", "kplus_2015 §5.1.1, Fig. 6",
        "At every k, the fastest k-buffer of bounded memory is a k⁺-buffer.",
        "faster than KB-PS, KB-MDT_32 and KB-MDT_64 at k = 4 … 64 (n = 128, GTX 780 Ti)",
        ("kplus2015-fig6",),
        tuple(Ratio(rival, SPIN_KPLUS) for rival in (PS, MDT32, MDT64)),
        hardware=IN_ORDER,
        remark="KB, KB-SR and KB-MHA are not exact and stay out",
        reading="KB-PS and KB-MDT_32 as they were, without the culling test of K⁺B",
        otherwise=(Reading("both with that test", tuple(
            Ratio(rival, SPIN_KPLUS) for rival in (pick("kb-ps", sync="spin", culling="on"),
                                                   pick("kb-mdt32", culling="on"), MDT64))),),
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
              for rival, times in ((PS, 3.5), (MDT32, 4))),
        hardware=IN_ORDER,
        reading='KB-PS and KB-MDT_32 as they were ("current implementations"), without the culling test of K⁺B',
        otherwise=(Reading("both with that test", tuple(
            Ratio(rival, HEAP, speedup(times), where={"k": 64, "n": 128})
            for rival, times in ((pick("kb-ps", sync="spin", culling="on"), 3.5),
                                 (pick("kb-mdt32", culling="on"), 4)))),),
    ),
    Claim(
        "k-mdt64", "kplus_2015 §5.1.1, Fig. 6",
        "KB-MDT_64 is faster than KB-MDT_32 at k = 4 and slower at larger k.",
        "faster at k = 4; held up by 64-bit atomics at larger k",
        ("kplus2015-fig6",),
        (Ratio(MDT32, MDT64, where={"k": 4}), Ratio(MDT64, MDT32, where={"k": from_(32)})),
        hardware="it has no 64-bit atomics, and draws the fragments of a pixel one by one",
        remark="larger is from k = 32, as for the heap",
    ),
    Claim(
        "k-culling", "kplus_2015 §5.1.1, Fig. 7",
        "Refusing fragments before the lock speeds K⁺B-Array up, less so as k grows; KB-PS and KB-MDT_32 with the same "
        "test do not beat it.",
        "significant at k = 4, fading towards k = 64; a boost of both, not enough to beat K⁺B-Array",
        ("kplus2015-fig7",),
        (Ratio(pick("kplus-array", culling="off"), pick("kplus-array", culling="on")),
         RatioChange(Ratio(pick("kplus-array", culling="off"), pick("kplus-array", culling="on")), "k", LESS,
                same=("size", "depth_complexity")),
         *(Ratio(pick(m, culling="on", sync=if_any("spin")), ARRAY) for m in ("kb-ps", "kb-mdt32"))),
    ),
    Claim(
        "k-memory", "kplus_2015 §5.1.1, Fig. 8",
        "Where memory counts as much as time, K⁺B-AB_SB is preferred to bounded memory on sparse scenes, and on dense "
        "ones better than the other memory-aware methods and worse than the bounded; at k = 64 k-buffers made from "
        "fixed arrays run out of 3 GB.",
        "preferred at p_d = f_p = 0.25, better than the other memory-aware methods at 0.75; KB-AB_Array, KB-AB_SB and "
        "KB-LL fail at k = 64",
        ("kplus2015-fig8", "kplus2015-fig8-full"),
        (*_memory_and_time(DRAWN, COST), *_runs_out(DRAWN, "kb-ab-array")),
        remark="out of memory is a budget of 3072 MiB, which the cells' configuration sets. By Table 1 KB-AB_SB needs "
               "2,888 MiB even with n = 640 in every covered pixel, so that its failure does not follow from it; "
               "KB-AB_LL, of which the text does not say it, needs 4,324 MiB then, as KB-LL with 4,344",
        reading="ms × MB, the inverse of kplus_2014's fps per MB, with n from k to 10 k",
        otherwise=(Reading("ms × MB with n = 10 k in every covered pixel",
                           (*_memory_and_time(ALL_ALIKE, COST), *_runs_out(ALL_ALIKE, "kb-ab-array", "kb-ll"))),
                   Reading("ms per MB as printed, where less is better",
                           (*_memory_and_time(DRAWN, PRINTED_COST), *_runs_out(DRAWN, "kb-ab-array")))),
    ),
    Claim(
        "k-sync", "kplus_2015 §5.1.1, Fig. 9 left",
        "A hardware interlock beats the spin lock, and with it K⁺B-Array is faster than KB-PS.",
        "about 2 times on a GTX 970, 1.5 times on an Iris Pro 5200",
        ("kplus2015-fig9-sync",),
        _interlocked("ordered", "off"),
        hardware=IN_ORDER,
        reading="the interlock in the order of submission, and KB-PS as it was, without the culling test of K⁺B",
        otherwise=(Reading("KB-PS with that test", _interlocked("ordered", "on")),
                   Reading("an interlock without order", _interlocked("interlock", "off"))),
    ),
    Claim(
        "k-sorted", "kplus_2014_slides 'Impact of Sorting'",
        "On depth-sorted scenes the max-array is faster than the max-heap, K⁺B than KB and KB than KB-PS; as k asks "
        "for more passes, K⁺B is faster than KB-SR and KB-SR than KB.",
        "K⁺B-Array > K⁺B-Heap; K⁺B > KB-SR > KB; K⁺B > KB > KB-PS",
        ("kplus2014-sorting",),
        _presorted(ROUTED),
        remark="the slide's cause is multi-pass rendering: KB has 8 layers a pass, KB-SR 32",
        reading="KB faster than KB-PS at every k, and KB-SR by 32 samples a pass",
        otherwise=(Reading("KB faster than KB-PS where one pass of 8 layers holds k", _presorted(ROUTED, k=up_to(8))),
                   Reading("KB-SR by 4 samples a pass", _presorted(pick("kb-sr", per_pass=up_to(4))))),
    ),
    Claim(
        "k-peel", "kplus_2015 §5.1.2, Fig. 9 right",
        "Peeling 8 or 32 layers a pass with K⁺B-Array is faster than front-to-back and dual depth peeling.",
        "faster at k = 8 and 32",
        ("kplus2015-fig9-abuffer",),
        tuple(Ratio(PEELERS, pick("peel-kplus", k=k), where={"n": from_(2 * k)}) for k in (8, 32)),
        remark="where n is at least 2 k, so that there is more than one iteration",
    ),
    Claim(
        "k-revised", "kplus_2015 §5.1.2, Fig. 9 right",
        "With k = n, K⁺B-Array-R is faster than every A-buffer that allocates what it needs, and slightly slower than "
        "AB_Array.",
        "better than all of them, slightly worse than AB_Array",
        ("kplus2015-fig9-abuffer",),
        (Ratio(pick("ab-ll", "ab-ll-bucket", "ab-sb"), pick("kplus-array-r", k=ALL_LAYERS)),
         Ratio(pick("kplus-array-r", k=ALL_LAYERS), pick("ab-array"), Bound("1 to 1.25 (slightly; the limit is ours)",
                                                                           1.0, 1.25))),
        hardware=IN_ORDER,
        remark="each direct insertion takes a second atomic and a barrier here, by which a fill is seen before the "
               "array counts as full; the paper's single atomic leaves a race",
    ),
    Claim(
        "k-absb", "kplus_2015 §5.1.2, Fig. 9 right; kplus_2014_slides 'Impact of k, A-buffer'",
        "With k = n, K⁺B-AB_SB is slower than AB_SB.",
        "slower in all cases",
        ("kplus2015-fig9-abuffer", "kplus2014-abuffer"),
        (Ratio(pick("kplus-sb", k=ALL_LAYERS, hash=ANY, sort=ANY), pick("ab-sb", hash=ANY, sort=ANY)),),
        hardware=IN_ORDER,
        remark="each with its own sort: l⁺ and hybrid in the paper of 2015, hybrid in that of 2014",
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
        remark="without attribute packing; KB-PS with an interlock, since the table has no word for its semaphore; "
               "KB-Multi is left out, which takes two words of its own here",
    ),
    Claim(
        "k-applications", "kplus_2014_slides 'Testing Environment', 'Extending k+-buffer'",
        "With k as large as the deepest pixel the k⁺-buffer is an A-buffer, for transparency, CSG and collision "
        "detection.",
        "pictures of the three; k = max f(p) behaves as an A-buffer",
        ("kplus2014-applications",),
        tuple(CountedValue(pick(method, k=from_(8)), "max_error_all", at_most(EXACT_ERROR))
              for method in (*VARIANTS, "kplus-sb")),
        remark="compared with a float64 model of each effect on all fragments, of which a pixel has at most 8",
    ),
)
