"""Result folders with made-up cells, for tests of what reads them."""

from __future__ import annotations

from mfr_bench import store
from mfr_bench.stats import median_interval

SCENE = {"kind": "quads", "size": [64, 64], "pixel_density": 1.0, "depth_complexity": 32, "layout": "block",
         "order": "random", "alpha": [0.1, 0.6], "fragment_probability": 1.0, "seed": 1, "animate": False,
         "quad_size": None}
DEVICE = {"renderer": "llvmpipe (LLVM 15.0.6, 256 bits)", "vendor": "Mesa", "version": "4.5 (Core Profile) Mesa 22.3.6",
          "slug": "llvmpipe"}
MEASURE = {"target_rel_ci": 0.01, "min_samples": 10, "max_samples": 1000, "time_limit_s": 10.0,
           "memory_budget_mb": 3072.0}


def spread(middle, count=10, width=0.01):
    """`count` samples around `middle`, evenly spread over ±`width` of it, in an order without a drift."""
    shuffled = sorted(range(count), key=lambda i: i * 0.618 % 1)
    return [middle * (1 + width * (2 * i / max(1, count - 1) - 1)) for i in shuffled]


def cell(method="kplus-array", label=None, time_ms=5.0, passes=None, scene=None, params=None, point=None,
         status="ok", reason=None, width=0.01, count=10, values=None, device=None, **parts):
    """A complete record; `time_ms` None gives one that was not measured. `passes` maps names to ms."""
    scene, params, point = SCENE | (scene or {}), params or {}, point or {}
    label, device = label or method, device or DEVICE
    measured = time_ms is not None
    frames = spread(time_ms, count, width) if measured else []
    low, middle, high = median_interval(frames)
    found = {"fragments": 131072, "samples": count, "timer": "wall", "time_ms": middle, "time_ms_low": low,
             "time_ms_high": high, "noisy": False, "stop_reason": "target", "memory_bytes": 2**20,
             "memory_model_bytes": 2**20, "max_abs_error": 1e-7, "rmse": 1e-8, "wrong_pixels": 0,
             "hit_ratio": 1.0} if measured else {}
    record = {"experiment": "planted", "method": method, "label": label, "params": params, "scene": scene,
              "measure": MEASURE, "point": point, "status": status, "reason": reason, "values": found | (values or {}),
              "warmup_ms": [], "samples_ms": frames, "buffers": {}, "glsl_hash": "abc", "device": device,
              "passes": {name: spread(ms, count, width) for name, ms in (passes or {}).items()}} | parts
    return {"key": store.key(record)} | record


def folder(path, cells, figures=(), sweep=None, **manifest):
    """A result folder at `path` that holds `cells`, planned in this order."""
    made = store.ResultFolder(path)
    for record in cells:
        made.write_cell(record)
    made.write_manifest({"name": "planted", "title": "Planted results", "source": {"paper": "kplus2015", "figure": "6"},
                         "figures": list(figures), "sweep": sweep or {}, "cells": [c["key"] for c in cells],
                         "device": DEVICE, "timer": "wall", "versions": {"mfr-bench": "0.1.0"},
                         "started": "2024-05-06T07:08:09Z", "split_s": {}, "noise_floor_rel": 0.004} | manifest)
    return made


METHODS = (
    ("kb-ps", "KB-PS", 1.0, ("clear", "store", "resolve")),
    ("kb-mdt32", "KB-MDT₃₂", 1.25, ("clear", "store depth", "store", "resolve")),
    ("kb-mdt64", "KB-MDT₆₄", 0.9, ("clear", "store", "resolve")),
    ("kb-ab-array", "KB-AB_Array", 0.7, ("clear", "store", "resolve")),
    ("kb-ab-ll", "KB-AB_LL", 1.1, ("clear", "store", "resolve")),
    ("kb-ab-sb", "KB-AB_SB", 0.95, ("clear", "count", "referencing", "store", "resolve")),
    ("kb-ll", "KB-LL", 2.1, ("clear", "store", "resolve")),
    ("kplus-array", "K⁺B-Array", 0.5, ("clear", "store", "resolve")),
    ("kplus-array-r", "K⁺B-Array-R", 0.48, ("clear", "store", "resolve")),
    ("kplus-heap", "K⁺B-Heap", 0.55, ("clear", "store", "resolve")),
    ("kplus-sb", "K⁺B-AB_SB", 0.6, ("clear", "count", "referencing", "store", "resolve")),
    ("ab-array", "AB_Array", 0.8, ("clear", "store", "resolve")),
    ("ab-sb", "AB_SB", 0.85, ("clear", "count", "referencing", "store", "resolve")),
    ("peel-f2b", "F2B", 4.0, ("peel", "composite")),
    ("peel-dual", "DUAL", 2.6, ("bounds", "peel", "composite")),
)
SHARES = {"clear": 0.03, "count": 0.2, "referencing": 0.07, "store": 1.0, "store depth": 0.6, "resolve": 0.4,
          "peel": 1.2, "composite": 0.05, "bounds": 0.1}


def sweep(ks=(4, 8, 16, 32, 64), methods=METHODS, axis="k"):
    """Cells of every method at every k, some unsupported, some over budget, one missing."""
    cells = [cell("floor", "floor", 2.0)] if axis == "k" else []
    for k in ks:
        if axis != "k":
            cells.append(cell("floor", "floor", 0.05 * k, scene={"depth_complexity": k},
                              point={"scene.depth_complexity": k}))
        for method, label, factor, names in methods:
            where = {"params": {"k": k}, "point": {"k": k}} if axis == "k" else {
                "scene": {"depth_complexity": k}, "point": {"scene.depth_complexity": k}}
            if (method, k) == ("kb-ll", 16):
                continue
            if method == "kb-mdt64":
                cells.append(cell(method, label, None, status="unsupported", reason="needs NV_shader_atomic_int64",
                                  **where))
            elif method in ("kb-ab-array", "kb-ll", "kb-ab-sb") and k >= 64:
                cells.append(cell(method, label, None, status="over_budget",
                                  reason="needs 4112.0 MiB, the budget is 3072.0 MiB", **where))
            else:
                passes = {n: factor * SHARES[n] * (k ** 1.2) * 2 for n in names}
                cells.append(cell(method, label, 1.02 * sum(passes.values()), passes, **where))
    return cells
