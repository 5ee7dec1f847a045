"""Made-up cells for every claim: measurements that bear it out (`good`), and that contradict it."""

from __future__ import annotations

import random

from mfr_bench.report.reference import find

from ..report import planted

GPU = {"renderer": "NVIDIA H200/PCIe/SSE2", "vendor": "NVIDIA Corporation", "version": "4.6.0 NVIDIA 550",
       "slug": "nvidia-h200", "kind": "gpu"}
CPU = planted.DEVICE | {"kind": "cpu"}
P = 64 * 64  # pixels of the planted scene
N = 32  # its fragments per pixel
SIZES = ([640, 480], [1024, 768], [1600, 1200])
KS = (4, 8, 16, 32, 64)


def cell(method, time_ms=5.0, params=None, passes=None, values=None, **scene):
    """A cell of a GPU, with samples within 0.1 % of `time_ms`, whose turns have nothing in common with another's."""
    found = {"timer": "gpu", "max_fragments": scene.get("depth_complexity", N)} if time_ms is not None else {}
    made = planted.cell(method, time_ms=time_ms, params=params, passes=passes, scene=scene, width=0.001,
                        count=20, values=found | (values or {}), device=GPU)
    random.Random(made["key"]).shuffle(made["samples_ms"])  # noqa: S311 - times, not secrets
    return made


def refused(method, params=None, status="over_budget", reason="needs 5128.0 MiB, the budget is 3072.0 MiB", **scene):
    return planted.cell(method, time_ms=None, params=params, scene=scene, status=status, reason=reason, device=GPU)


def counters(good):
    """Flat where it does not hold: more counters change nothing."""
    times = {1: 9.0, 8: 6.0, 30: 5.0, 64: 5.1, 1024: 7.0}
    return [cell("ab-sb", ms if good else 5.0, {"counters": s, "mapping": "inverse"}) for s, ms in times.items()]


def two_counters(good):
    return [cell("ab-sb", 5.0 if good else 6.0, {"counters": 2}, pixel_density=0.1),
            cell("ab-precalc", 5.0, {"scan": "compute"}, pixel_density=0.1),
            cell("ab-precalc", 1.0, {"scan": "fullscreen"}, pixel_density=0.1)]


def full_coverage(good):
    return [cell("ab-sb", 5.0, {"counters": 30}), cell("ab-precalc", 5.35 if good else 4.9, {"scan": "compute"})]


def optimal(good):
    return [c for size in SIZES for c in (
        cell("ab-precalc-fixed", 4.4 if good else 2.5, size=size),
        cell("ab-sb", 5.0, {"counters": 30, "mapping": "inverse"}, size=size))]


def inverse(good):
    gains = (1.13, 1.10, 1.06 if good else 0.99)
    return [c for size, gain in zip(SIZES, gains, strict=True) for c in (
        cell("ab-sb", 5.0 * gain, {"counters": 30, "mapping": "forward"}, size=size),
        cell("ab-sb", 5.0, {"counters": 30, "mapping": "inverse"}, size=size))]


def referencing(good, **faster):
    """The paper's own twelve times bear it out. `faster`: by how much a method is faster than there."""
    times = {(row.method, row.width): row.value for row in find(paper="sbuffer2012", quantity="referencing_time")}
    passes = {"ab-sb": "referencing", "ab-precalc-fixed": "scan", "ab-precalc": "scan", "ab-ll": "store"}
    params = {"ab-sb": {"counters": 30, "mapping": "inverse"}, "ab-precalc": {"scan": "compute"}}
    faster = {} if good else faster or {"ab-precalc": 4}
    return [cell(m, params=params.get(m), passes={passes[m]: times[m, size[0]] / faster.get(m, 1)}, size=size)
            for size in SIZES for m in passes]


def memory_2012(good, lists=12):
    fragments = P * 3 // 2
    needed = {  # method -> bytes per pixel, bytes per fragment, parameters
        "ab-array": (8 * N + 4, 0, {}), "ab-precalc-fixed": (8 * N + 8, 0, {}), "kb": (68, 0, {"k": N, "per_pass": 8}),
        "peel-srab": (288, 0, {"samples": 8}), "ab-precalc": (8, 8, {"scan": "compute"}),
        "ab-sb": (8 if good else 900, 8, {"counters": 30}), "ab-ll": (4, lists, {}),
    }
    return [cell(m, params=params, values={"fragments": fragments, "memory_bytes": pixel * P + each * fragments})
            for m, (pixel, each, params) in needed.items()]


def lists_slowest(good):
    return [cell("ab-ll", 9.0 if good else 5.5), cell("ab-sb", 5.0, {"counters": 30}),
            cell("ab-precalc", 6.0, {"scan": "compute"}), cell("ab-sb", 8.0, {"counters": 1})]


def at_ks(times, **more):
    """Cells of each method at every k, by a function of k, of 128 fragments per pixel."""
    return [cell(method, ms(k), {"k": k, **params}, depth_complexity=128, **more)
            for k in KS for method, params, ms in times]


LOCKED = {"sync": "spin", "culling": "on"}
UNCULLED = LOCKED | {"culling": "off"}


def bounded(good):
    return at_ks([("kplus-array", LOCKED, lambda k: 1 + 0.1 * k), ("kplus-heap", LOCKED, lambda k: 2 + 0.05 * k),
                  ("kplus-array", UNCULLED, lambda k: 9.0 + k),
                  ("kb-ps", UNCULLED, lambda k: 2 + 0.2 * k),
                  ("kb-mdt64", {"atomic64": "native"}, lambda k: 1 + 0.5 * k),
                  ("kb-mdt32", {"culling": "off"}, lambda k: (2 if good else 0.3) + 0.2 * k)])


def heap(good):
    return at_ks([("kplus-array", LOCKED, lambda k: 1 + 0.1 * k),
                  ("kplus-heap", LOCKED, lambda k: 2 + (0.05 if good else 0.1) * k)])


def heap_64(good):
    """The rivals with K⁺B's culling test decide nothing."""
    return at_ks([("kplus-heap", LOCKED, lambda _: 2.0), ("kb-ps", UNCULLED, lambda _: 7.0),
                  ("kb-ps", LOCKED, lambda _: 1.0), ("kb-mdt32", {"culling": "on"}, lambda _: 1.0),
                  ("kb-mdt32", {"culling": "off"}, lambda _: 8.0 if good else 2.2)])


def mdt_64(good, first_ms=0.5):
    """At k = 8 either may be faster."""
    return at_ks([("kb-mdt32", {"culling": "off"}, lambda k: 1 + 0.1 * k),
                  ("kb-mdt64", {"atomic64": "native"}, lambda k: first_ms + (0.12 if good else 0.1) * k)])


def culling(good, rival=4.0):
    return at_ks([("kplus-array", LOCKED, lambda k: 1 + 0.1 * k),
                  ("kplus-array", UNCULLED, lambda k: (1 + 0.1 * k) * (3 - k / 64 if good else 2 + k / 64)),
                  ("kb-ps", LOCKED, lambda k: rival + 0.1 * k),
                  ("kb-mdt32", {"culling": "on"}, lambda k: 5 + 0.2 * k)])


FULL = {"depth_complexity": 640}


def fits_all_the_same():
    """The cells of `cost`, but that KB-AB_Array has room at k = 64."""
    *cells, refused_cell = cost(True)
    return [*cells, cell("kb-ab-array", 50.0, refused_cell["params"], values={"memory_bytes": 9000},
                         **refused_cell["scene"])]


def cost(good, dense_ms=6.0):
    """ms and bytes of K⁺B-AB_SB, of bounded methods and of memory-aware ones."""
    sparse, dense = ({"pixel_density": share, "fragment_probability": share, "least_depth": 0.1, "depth_complexity": n}
                     for share, n in ((0.25, 80), (0.75, 80)))
    bounded = {"kplus-array": LOCKED, "kplus-heap": LOCKED, "kb-mdt32": {"culling": "off"}}
    aware = ("kb-ab-array", "kb-ab-ll", "kb-ab-sb", "kb-ll")
    groups = [("kplus-sb", LOCKED | {"sort": "lplus"}, (6.0 if good else 30.0, 1000), (dense_ms, 3000)),
              *((m, params, (5.0, 4000), (3.0, 4000)) for m, params in bounded.items()),
              *((m, {"sort": "hybrid"}, (5.0, 1500), (7.0, 4000)) for m in aware)]
    cells = [cell(m, ms, {"k": 8, **params}, values={"memory_bytes": size}, **scene)
             for m, params, *of in groups for (ms, size), scene in zip(of, (sparse, dense), strict=True)]
    return [*cells, refused("kb-ab-array", {"k": 64}, **dense | FULL)]


def synchronization(good, spin=9.0):
    times = {("kplus-array", "spin", "on"): spin, ("kb-ps", "spin", "off"): 14.0,
             ("kplus-array", "ordered", "on"): 5.0,
             ("kb-ps", "ordered", "off"): 10.0 if good else 5.5, ("kb-ps", "ordered", "on"): 5.0}
    return [cell(m, ms, {"k": 8, "sync": sync, "culling": culls}) for (m, sync, culls), ms in times.items()]


def presorted(good, k=16, **times):
    """KB takes two passes of 8 layers, KB-SR one; four samples a pass decide nothing."""
    kept = {"kb": {"per_pass": 8 if k > 8 else 0}, "kb-sr": {"per_pass": 0}, "kplus-array": LOCKED,
            "kplus-heap": LOCKED, "kb-ps": UNCULLED}
    usual = {"kb": 9.0, "kb-sr": 6.0, "kplus-array": 5.0 if good else 5.8, "kplus-heap": 5.5, "kb-ps": 12.0} | times
    cells = [cell(m, ms, {"k": k, **kept[m]}, order="front_to_back", depth_complexity=128) for m, ms in usual.items()]
    return [*cells, cell("kb-sr", 20.0, {"k": k, "per_pass": 4}, order="front_to_back", depth_complexity=128)]


def peeling(good, shallow=12.0):
    """Cells in which one iteration takes all fragments: its time decides nothing."""
    cells = [cell(m, ms, depth_complexity=n) for m, ms in (("peel-f2b", 30.0), ("peel-dual", 20.0)) for n in (8, 64)]
    return cells + [cell("peel-kplus", shallow if n == 8 else 12.0 if good else 25.0, {"k": k, "sync": "spin"},
                         depth_complexity=n) for k in (8, 32) for n in (8, 64)]


def revised(good, ms=7.5):
    rivals = [cell(m, ms) for m, ms in (("ab-ll", 9.0), ("ab-ll-bucket", 8.0), ("ab-sb", 7.0), ("ab-array", 5.5))]
    return [*rivals, cell("kplus-array-r", 6.0 if good else ms, {"k": N}), cell("kplus-array-r", 1.0, {"k": 4})]


def kplus_sb(good):
    """Both hash pixels to counters and sort, each in its own way."""
    return [cell("kplus-sb", 6.0 if good else 4.0, {"k": N, "hash": "tile", "sort": "lplus"}),
            cell("ab-sb", 5.0, {"hash": "pixel", "sort": "hybrid"})]


def lplus(good):
    return [cell("kplus-array-r", params={"k": n, "sort": sort}, passes={"store": 5.0, "resolve": ms},
                 depth_complexity=n)
            for n, gain in ((64, 3.1), (128, 4.64 if good else 1.2)) for sort, ms in (("hybrid", gain), ("lplus", 1.0))]


def words(good):
    kept = 8 / N
    needed = {"kb": 16, "kb-multi": 18, "kb-sr": 24, "kb-ps": 16, "kplus-array": 18, "kplus-heap": 18, "kb-mdt32": 16,
              "kb-mdt64": 16, "kb-mha": 16, "kb-ab-array": 2 * N + 1, "kb-ab-ll": 3 * N + 1, "kb-ll": 3 * N + 6,
              "kb-ab-sb": 2 * N + 2, "kplus-sb": 2 * 8 + 3 if good else 2 * N + 3}
    interlocked = {"kb-ps": {"sync": "interlock"}}
    return [cell(m, params={"k": 8, **interlocked.get(m, {})},
                 values={"memory_bytes": 4 * w * P, "fragments": N * P, "hit_ratio": kept}) for m, w in needed.items()]


FOUR = {"lin-post": {"packed": "on", "sort": "bubble", "atomic64": "native"},
        "lin-pre": {"insert": "max64", "early_culling": "off", "atomic64": "emulated"},
        "open-post": {"load_factor": 0.5, "sort": "bubble", "atomic64": "emulated"},
        "open-pre": {"early_culling": "off", "load_factor": 0.5, "atomic64": "emulated"}}


def linear(good):
    return [cell(m, 1 + (side / 64) ** 2 if good or m != "open-pre" else (side / 64) ** 4, params, size=[side, side],
                 depth_complexity=n, values={"fragments": n * side**2})
            for m, params in FOUR.items() for n in (5, 20) for side in (64, 128, 192, 256)]


def quadratic(good, power=2, worst=0.0001):
    cost_of = {"open-pre": 0.02 if good else worst}
    return [cell(m, 1 + cost_of.get(m, 0.001) * n**power * 64 ** (2 - power), params, depth_complexity=n)
            for m, params in FOUR.items() for n in (4, 16, 40, 64)]


def load(good, times=None):
    times = {0.1: 4.0, 0.5: 4.4, 0.8: 5.0, 0.95: 9.0} if good else times or {0.1: 4.0, 0.5: 6.0, 0.8: 6.2, 0.95: 6.3}
    return [cell(m, ms, FOUR[m] | {"load_factor": value})
            for m in ("open-post", "open-pre") for value, ms in times.items()]


def early(good):
    slope = -6 if good else 6
    return [cell(m, 9.0 if kept == "off" else 6.0 + slope * (opacity - 0.5), FOUR[m] | {"early_culling": kept},
                 alpha=[opacity, opacity])
            for m in ("open-pre", "lin-pre") for kept in ("on", "off") for opacity in (0.1, 0.5, 1.0)]


def four(good, share=None):
    """`share`: of the clear pass of open addressing, where it is neither."""
    times = {"lin-post": 6.0, "lin-pre": 5.0 if good else 7.0, "open-post": 9.0, "open-pre": 8.0}
    quick = "lin" if good else "open"  # to clear
    clears = {m: 0.01 if m.startswith(quick) else 1.0 if share is None else 7 * share / (1 - share) for m in times}
    return [cell(m, ms, FOUR[m], passes={"clear": clears[m], "build": 5.0, "render": 2.0}) for m, ms in times.items()]


def local_array(good):
    return [cell(m, params={"local_array": entries, "sort": "bubble"}, passes={"build": 9.0, "render": ms})
            for m in ("open-post", "lin-post") for entries, ms in ((64, 20.0), (256, 57.0 if good else 22.0))]


def compare_and_swap(good, times=1.02):
    return [cell("ab-ll-bucket", params={"maximum": how}, passes={"bounds": ms, "store": 5.0})
            for how, ms in (("atomic", 1.0), ("compare_and_swap", 1.3 if good else times))]


def discarded(good, kplus=0.62):
    """Shares of the 95 % of the fragments that are not kept."""
    shares = {32: 0.97 if good else 0.7, 0: kplus}
    return [cell("kplus-array", params={"k": 8, "occupancy": bits, "occupancy_bounds": "box"},
                 values={"culled_share": 0.95 * share, "hit_ratio": 0.05})
            for bits, share in shares.items()]


def occupancy(good, intervals=(32,)):
    return [cell(m, ms, {"k": k, "occupancy": d, "occupancy_bounds": bounds})
            for m in ("kplus-array", "kplus-heap") for k in (4, 64)
            for d, ms, bounds in ((0, 6.5 if good else 4.5, "geometry"), *((d, 5.0, "box") for d in intervals),
                                  *((d, 5.0, "geometry") for d in intervals[1:] and (32,)))]


def two_channel(good, luminance=0.002):
    errors = {"plane": 0.01, "hues-2": 0.02, "hues-6": 8.0, "hues-12": 9.0, "any": 10.0 if good else 7.0}
    return [cell("kplus-array", params={"k": 8, "payload": "two_channel"}, colours=colours,
                 values={"luminance_error": luminance, "hue_error": error}) for colours, error in errors.items()]


def effects_2012(good):
    return [cell("ab-sb", values={"max_error_all": error}, effect=effect) for effect, error in (
        ("transparency", 1e-7), ("translucency", 0.0), ("csg", 0.0 if good else 0.3))]


def applications(good):
    """Fewer than all layers are no A-buffer, and show nothing against it."""
    return [cell(method, params={"k": k}, values={"max_error_all": 0.3 if k < 8 or not good else 1e-7})
            for method in ("kplus-array", "kplus-heap", "kplus-sb") for k in (4, 8)]


CASES = {  # claim -> an experiment that shows it, and its cells
    "sb-peak": ("sbuffer2012-fig3", counters), "sb-two": ("sbuffer2012-fig3", two_counters),
    "sb-full": ("sbuffer2012-fig3", full_coverage), "sb-optimal": ("sbuffer2012-fig4", optimal),
    "sb-inverse": ("sbuffer2012-fig4", inverse), "sb-ref": ("sbuffer2012-referencing", referencing),
    "sb-memory": ("sbuffer2012-memory", memory_2012), "sb-ll": ("sbuffer2012-fig3", lists_slowest),
    "sb-effects": ("sbuffer2012-fig2", effects_2012),
    "k-bounded": ("kplus2015-fig6", bounded), "k-heap": ("kplus2015-fig6", heap),
    "k-heap64": ("kplus2015-fig6", heap_64), "k-mdt64": ("kplus2015-fig6", mdt_64),
    "k-culling": ("kplus2015-fig7", culling), "k-memory": ("kplus2015-fig8", cost),
    "k-sync": ("kplus2015-fig9-sync", synchronization), "k-sorted": ("kplus2014-sorting", presorted),
    "k-peel": ("kplus2015-fig9-abuffer", peeling), "k-revised": ("kplus2015-fig9-abuffer", revised),
    "k-absb": ("kplus2015-fig9-abuffer", kplus_sb), "k-lsort": ("kplus2015-lsort", lplus),
    "k-words": ("kplus2015-table1", words), "k-applications": ("kplus2014-applications", applications),
    "gp-linear": ("gpupro5-fig5", linear),
    "gp-quadratic": ("gpupro5-fig6", quadratic), "gp-load": ("gpupro5-fig4", load), "gp-early": ("gpupro5-fig7", early),
    "gp-prelin": ("gpupro5-fig3", four), "gp-clear": ("gpupro5-fig3", four),
    "gp-array": ("gpupro5-local-array", local_array), "gp-cas": ("gpupro5-cas", compare_and_swap),
    "oc-discard": ("occupancy2015-fig1", discarded), "oc-gain": ("occupancy2015-fig4", occupancy),
    "tc-error": ("twochannel-fig4", two_channel),
}
ALSO_AGAINST = {  # what else contradicts a claim, in the way a reader means it: cells by what they show
    "sb-peak": {"one counter is as fast": [cell("ab-sb", 6.0 if s > 30 else 5.0, {"counters": s, "mapping": "inverse"})
                                           for s in (1, 8, 30, 64, 1024)],
                "many counters are as fast": [cell("ab-sb", ms, {"counters": s}) for s, ms in ((1, 9.0), (30, 5.0),
                                                                                               (1024, 5.0))],
                "the peak is at 8": [cell("ab-sb", 4.0 if s == 8 else ms, {"counters": s, "mapping": "inverse"})
                                     for s, ms in ((1, 9.0), (8, 6.0), (30, 5.0), (1024, 7.0))]},
    "sb-ref": {"lists take less than the scan": referencing(False, **{"ab-ll": 10}),
               "S-buffer takes no longer than fixed arrays": referencing(False, **{"ab-sb": 8}),
               "the scan takes no longer than S-buffer": referencing(False, **{"ab-precalc": 6})},
    "sb-memory": {"lists need three times as much": memory_2012(True, lists=40)},
    "k-culling": {"KB-PS with the test is faster": culling(True, rival=0.5)},
    "k-memory": {"other memory-aware methods are better when dense": cost(True, dense_ms=20.0),
                 "better than bounded methods when dense": cost(True, dense_ms=2.0),
                 "fixed arrays have room at k = 64": fits_all_the_same()},
    "k-mdt64": {"slower at k = 4 as well": mdt_64(True, first_ms=2.0)},
    "k-sync": {"the interlock is slower than the spin lock": synchronization(True, spin=4.0)},
    "k-revised": {"much slower than AB_Array": revised(False, ms=6.95), "faster than AB_Array": revised(False, ms=5.0)},
    "k-sorted": {"KB-PS is faster than KB": presorted(True, **{"kb-ps": 6.0}),
                 "several passes of KB are faster than K+B": presorted(True, kb=4.0),
                 "KB-SR is faster than K+B": presorted(True, **{"kb-sr": 4.0}),
                 "several passes of KB are faster than one of KB-SR": presorted(True, kb=5.9)},
    "gp-linear": {"more fragments take no more time": [cell(m, 5.0, params, size=[side, side], depth_complexity=5,
                                                            values={"fragments": 5 * side**2})
                                                       for m, params in FOUR.items() for side in (64, 128, 256)]},
    "gp-quadratic": {"only as a line": quadratic(True, power=1),
                     "PRE-OPEN suffers like the others": quadratic(False, worst=0.00095),
                     "hardly": [cell(m, 5.0 + n**2 / 5e3, params, depth_complexity=n)
                                for m, params in FOUR.items() for n in (4, 16, 40, 64)]},
    "gp-load": {"no slower near 1": load(False, {0.1: 4.0, 0.5: 4.4, 0.8: 4.3, 0.95: 4.2}),
                "along a line": load(False, {0.1: 4.0, 0.5: 6.05, 0.8: 7.5, 0.95: 8.2})},
    "gp-cas": {"it costs twice as much": compare_and_swap(False, times=2.0)},
    "gp-clear": {"open addressing does little but clear": four(True, share=0.9)},
    "oc-discard": {"k+ culling discards as much": discarded(True, kplus=0.97)},
    "tc-error": {"luminance is lost": two_channel(True, luminance=0.1)},
}
READ_APART = {  # cells by which the readings of a claim have other verdicts
    "k-bounded": [*bounded(True), *at_ks([("kb-ps", LOCKED, lambda _: 0.5),
                                          ("kb-mdt32", {"culling": "on"}, lambda _: 0.5)])],
    "k-heap64": heap_64(True), "k-memory": cost(True), "k-sync": synchronization(True),
    "k-sorted": presorted(True, **{"kb-ps": 8.5}) + presorted(True, k=8), "gp-quadratic": quadratic(True, power=1),
    "oc-discard": [*discarded(True), cell("kplus-array", params={"k": 8, "occupancy": 128, "occupancy_bounds": "box"},
                                          values={"culled_share": 0.7, "hit_ratio": 0.05})],
    "oc-gain": [*occupancy(True), *(cell(m, 7.0, {"k": k, "occupancy": 128, "occupancy_bounds": "box"})
                                    for m in ("kplus-array", "kplus-heap") for k in (4, 64))],
    "tc-error": [*two_channel(False), cell("kplus-array", params={"k": 8, "payload": "two_channel"}, colours="hues-1",
                                           values={"luminance_error": 0.002, "hue_error": 0.01})],
}
# Tested from what is counted, not timed.
COUNTED = {"sb-memory", "sb-effects", "k-words", "k-applications", "oc-discard", "tc-error"}


def folder(path, name, cells, device=GPU, **manifest):
    return planted.folder(path, [c | {"device": device} for c in cells], name=name, device=device, **manifest)
