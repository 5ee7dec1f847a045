"""Made-up cells for every claim: measurements that bear it out (`good`), and that contradict it."""

from __future__ import annotations

from ..report import planted

GPU = {"renderer": "NVIDIA H200/PCIe/SSE2", "vendor": "NVIDIA Corporation", "version": "4.6.0 NVIDIA 550",
       "slug": "nvidia-h200", "kind": "gpu"}
CPU = planted.DEVICE | {"kind": "cpu"}
P = 64 * 64  # pixels of the planted scene
N = 32  # its fragments per pixel
SIZES = ([640, 480], [1024, 768], [1600, 1200])
KS = (4, 8, 16, 32, 64)


def cell(method, time_ms=5.0, params=None, passes=None, values=None, **scene):
    """A cell of a GPU, with samples within 0.1 % of `time_ms`."""
    found = {"timer": "gpu", "max_fragments": scene.get("depth_complexity", N)} if time_ms is not None else {}
    return planted.cell(method, time_ms=time_ms, params=params, passes=passes, scene=scene, width=0.001,
                        count=20, values=found | (values or {}), device=GPU)


def refused(method, params=None, status="over_budget", reason="needs 5128.0 MiB, the budget is 3072.0 MiB", **scene):
    return planted.cell(method, time_ms=None, params=params, scene=scene, status=status, reason=reason, device=GPU)


def counters(good):
    times = {1: 9.0, 8: 6.0, 30: 5.0, 64: 5.1, 1024: 7.0 if good else 4.0}
    return [cell("ab-sb", ms, {"counters": s, "mapping": "inverse"}) for s, ms in times.items()]


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


def referencing(good):
    return [cell("ab-sb", params={"counters": 30, "mapping": "inverse"}, passes={"count": 1.0, "referencing": 0.4}),
            cell("ab-precalc-fixed", passes={"scan": 0.04}),
            cell("ab-precalc", params={"scan": "compute"}, passes={"scan": 2.4 if good else 0.5}),
            cell("ab-ll", passes={"store": 10.0})]


def memory_2012(good):
    fragments = P * N // 2
    needed = {  # method -> bytes per pixel, bytes per fragment, parameters
        "ab-array": (8 * N + 4, 0, {}), "ab-precalc-fixed": (8 * N + 8, 0, {}), "kb": (64, 0, {"k": 8}),
        "peel-srab": (80, 0, {"samples": 8}), "ab-precalc": (8, 8, {"scan": "compute"}),
        "ab-sb": (8 if good else 900, 8, {"counters": 30}), "ab-ll": (4, 12, {}),
    }
    return [cell(m, params=params, values={"fragments": fragments, "memory_bytes": pixel * P + each * fragments})
            for m, (pixel, each, params) in needed.items()]


def lists_slowest(good):
    return [cell("ab-ll", 9.0 if good else 5.5), cell("ab-sb", 5.0, {"counters": 30}),
            cell("ab-precalc", 6.0, {"scan": "compute"}), cell("ab-lbuffer", 8.0)]


def at_ks(times, **more):
    """Cells of each method at every k, by a function of k, of 128 fragments per pixel."""
    return [cell(method, ms(k), {"k": k, **params}, depth_complexity=128, **more)
            for k in KS for method, params, ms in times]


LOCKED = {"sync": "spin", "culling": "on"}


def bounded(good):
    return at_ks([("kplus-array", LOCKED, lambda k: 1 + 0.1 * k), ("kplus-heap", LOCKED, lambda k: 2 + 0.05 * k),
                  ("kplus-array", LOCKED | {"culling": "off"}, lambda k: 9.0 + k),
                  ("kb-ps", LOCKED, lambda k: 2 + 0.2 * k), ("kb-mdt64", {"atomic64": "native"}, lambda k: 1 + 0.5 * k),
                  ("kb-mdt32", {"culling": "on"}, lambda k: (2 if good else 0.3) + 0.2 * k)])


def heap(good):
    return at_ks([("kplus-array", LOCKED, lambda k: 1 + 0.1 * k),
                  ("kplus-heap", LOCKED, lambda k: 2 + (0.05 if good else 0.1) * k)])


def heap_64(good):
    return at_ks([("kplus-heap", LOCKED, lambda _: 2.0), ("kb-ps", LOCKED, lambda _: 7.0),
                  ("kb-mdt32", {"culling": "on"}, lambda _: 8.0 if good else 2.2)])


def mdt_64(good):
    return at_ks([("kb-mdt32", {"culling": "on"}, lambda k: 1 + 0.1 * k),
                  ("kb-mdt64", {"atomic64": "native"}, lambda k: 0.5 + (0.2 if good else 0.1) * k)])


def culling(good):
    return at_ks([("kplus-array", LOCKED, lambda k: 1 + 0.1 * k),
                  ("kplus-array", LOCKED | {"culling": "off"},
                   lambda k: (1 + 0.1 * k) * (3 - k / 64 if good else 2 + k / 64))])


def cost(good):
    sparse = {"pixel_density": 0.25, "fragment_probability": 0.25, "depth_complexity": 80}
    others = ("kplus-array", "kplus-heap", "kb-mdt32", "kb-ab-array", "kb-ab-ll", "kb-ab-sb", "kb-ll")
    dense = {"pixel_density": 0.75, "fragment_probability": 0.75, "depth_complexity": 640}
    cells = [cell("kplus-sb", 6.0, {"k": 8}, values={"memory_bytes": 1000}, **sparse)]
    cells += [cell(m, 5.0, {"k": 8}, values={"memory_bytes": 4000}, **sparse) for m in others]
    cells += [refused(m, {"k": 64}, **dense) for m in ("kb-ab-array", "kb-ll")]
    return [*cells, refused("kb-ab-sb", {"k": 64}, **dense) if good else cell("kb-ab-sb", 5.0, {"k": 64}, **dense)]


def synchronization(good):
    times = {("kplus-array", "spin"): 9.0, ("kb-ps", "spin"): 14.0, ("kplus-array", "interlock"): 5.0,
             ("kb-ps", "interlock"): 10.0 if good else 5.5}
    return [cell(m, ms, {"k": 8, "sync": sync, "culling": "on"}) for (m, sync), ms in times.items()]


def presorted(good):
    times = {"kb": 9.0, "kb-sr": 6.0 if good else 12.0, "kplus-array": 5.0, "kplus-heap": 5.5}
    return [cell(m, ms, {"k": 16}, order="front_to_back", depth_complexity=128) for m, ms in times.items()]


def peeling(good):
    cells = [cell("peel-f2b", 30.0), cell("peel-dual", 20.0)]
    return cells + [cell("peel-kplus", 12.0 if good else 25.0, {"k": k, "sync": "spin"}) for k in (8, 32)]


def revised(good):
    rivals = [cell(m, ms) for m, ms in (("ab-ll", 9.0), ("ab-ll-bucket", 8.0), ("ab-sb", 7.0), ("ab-array", 5.5))]
    return [*rivals, cell("kplus-array-r", 6.0 if good else 7.5, {"k": N}), cell("kplus-array-r", 1.0, {"k": 4})]


def kplus_sb(good):
    """Both hash pixels to counters, each in its own way."""
    return [cell("kplus-sb", 6.0 if good else 4.0, {"k": N, "hash": "tile"}), cell("ab-sb", 5.0, {"hash": "pixel"})]


def lplus(good):
    return [cell("kplus-array-r", params={"k": n, "sort": sort}, passes={"store": 5.0, "resolve": ms},
                 depth_complexity=n)
            for n, gain in ((64, 3.1), (128, 4.64 if good else 1.2)) for sort, ms in (("hybrid", gain), ("lplus", 1.0))]


def words(good):
    kept = 8 / N
    needed = {"kb": 16, "kb-multi": 16, "kb-sr": 24, "kb-ps": 16, "kplus-array": 18, "kplus-heap": 18, "kb-mdt32": 16,
              "kb-mdt64": 16, "kb-mha": 16, "kb-ab-array": 2 * N + 1, "kb-ab-ll": 3 * N + 1, "kb-ll": 3 * N + 6,
              "kb-ab-sb": 2 * N + 2, "kplus-sb": 2 * 8 + 3 if good else 2 * N + 3}
    return [cell(m, params={"k": 8}, values={"memory_bytes": 4 * w * P, "fragments": N * P, "hit_ratio": kept})
            for m, w in needed.items()]


FOUR = {"lin-post": {"atomic64": "native"}, "lin-pre": {"early_culling": "off", "atomic64": "native"},
        "open-post": {"load_factor": 0.5, "atomic64": "emulated"},
        "open-pre": {"early_culling": "off", "load_factor": 0.5, "atomic64": "emulated"}}


def linear(good):
    return [cell(m, 1 + (side / 64) ** 2 if good or m != "open-pre" else (side / 64) ** 4, params, size=[side, side],
                 depth_complexity=n, values={"fragments": n * side**2})
            for m, params in FOUR.items() for n in (5, 20) for side in (64, 128, 192, 256)]


def quadratic(good):
    cost_of = {"open-pre": 0.02 if good else 0.0001}
    return [cell(m, 1 + cost_of.get(m, 0.001) * n**2, params, depth_complexity=n)
            for m, params in FOUR.items() for n in (4, 16, 40, 64)]


def load(good):
    return [cell(m, 4.0 + (5.0 if value > 0.9 and good else value), FOUR[m] | {"load_factor": value})
            for m in ("open-post", "open-pre") for value in (0.1, 0.5, 0.8, 0.95)]


def early(good):
    slope = -6 if good else 6
    return [cell(m, 9.0 if kept == "off" else 6.0 + slope * (opacity - 0.5), FOUR[m] | {"early_culling": kept},
                 alpha=[opacity, opacity])
            for m in ("open-pre", "lin-pre") for kept in ("on", "off") for opacity in (0.1, 0.5, 0.9)]


def four(good):
    times = {"lin-post": 6.0, "lin-pre": 5.0 if good else 7.0, "open-post": 9.0, "open-pre": 8.0}
    quick = "lin" if good else "open"  # to clear
    return [cell(m, ms, FOUR[m], passes={"clear": 0.01 if m.startswith(quick) else 1.0, "build": 5.0, "render": 2.0})
            for m, ms in times.items()]


def local_array(good):
    return [cell(m, params={"local_array": entries}, passes={"build": 9.0, "render": ms})
            for m in ("open-post", "lin-post") for entries, ms in ((64, 20.0), (256, 57.0 if good else 22.0))]


def compare_and_swap(good):
    return [cell("lin-pre", 6.5 if good else 5.1, {"insert": "cas32", "atomic64": "native"}),
            cell("lin-pre", 5.0, {"insert": "max64", "atomic64": "native"})]


def discarded(good):
    return [cell("kplus-array", params={"k": 8, "occupancy": 32}, values={"culled_share": 0.97 if good else 0.7}),
            cell("kplus-array", params={"k": 8, "occupancy": 0}, values={"culled_share": 0.62})]


def occupancy(good):
    return [cell(m, ms, {"k": k, "occupancy": d}) for m in ("kplus-array", "kplus-heap") for k in (4, 64)
            for d, ms in ((0, 6.5 if good else 4.5), (32, 5.0))]


def two_channel(good):
    return [cell("kplus-array", params={"k": 8, "payload": "two_channel"}, colours=colours,
                 values={"luminance_error": 0.002, "hue_error": error})
            for colours, error in (("plane", 0.01), ("hues-6", 9.0), ("hues-12", 8.0), ("any", 7.0 if good else 0.005))]


CASES = {  # claim -> an experiment that shows it, and its cells
    "sb-peak": ("sbuffer2012-fig3", counters), "sb-two": ("sbuffer2012-fig3", two_counters),
    "sb-full": ("sbuffer2012-fig3", full_coverage), "sb-optimal": ("sbuffer2012-fig4", optimal),
    "sb-inverse": ("sbuffer2012-fig4", inverse), "sb-ref": ("sbuffer2012-referencing", referencing),
    "sb-memory": ("sbuffer2012-memory", memory_2012), "sb-ll": ("sbuffer2012-fig4", lists_slowest),
    "k-bounded": ("kplus2015-fig6", bounded), "k-heap": ("kplus2015-fig6", heap),
    "k-heap64": ("kplus2015-fig6", heap_64), "k-mdt64": ("kplus2015-fig6", mdt_64),
    "k-culling": ("kplus2015-fig7", culling), "k-memory": ("kplus2015-fig8", cost),
    "k-sync": ("kplus2015-fig9-sync", synchronization), "k-sorted": ("kplus2014-sorting", presorted),
    "k-peel": ("kplus2015-fig9-abuffer", peeling), "k-revised": ("kplus2015-fig9-abuffer", revised),
    "k-absb": ("kplus2015-fig9-abuffer", kplus_sb), "k-lsort": ("kplus2015-lsort", lplus),
    "k-words": ("kplus2015-table1", words), "gp-linear": ("gpupro5-fig5", linear),
    "gp-quadratic": ("gpupro5-fig6", quadratic), "gp-load": ("gpupro5-fig4", load), "gp-early": ("gpupro5-fig7", early),
    "gp-prelin": ("gpupro5-fig3", four), "gp-clear": ("gpupro5-fig3", four),
    "gp-array": ("gpupro5-local-array", local_array), "gp-cas": ("gpupro5-fig3", compare_and_swap),
    "oc-discard": ("occupancy2015-fig1", discarded), "oc-gain": ("occupancy2015-fig4", occupancy),
    "tc-error": ("twochannel-fig4", two_channel),
}
COUNTED = {"sb-memory", "k-words", "oc-discard", "tc-error"}  # tested from what is counted, not timed


def folder(path, name, cells, device=GPU, **manifest):
    return planted.folder(path, [c | {"device": device} for c in cells], name=name, device=device, **manifest)
