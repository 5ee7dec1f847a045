"""Cells: which, in what order, and what a device or a budget forbids."""

from collections import Counter
from dataclasses import replace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mfr_bench import plan
from mfr_bench.config import Experiment, Measure, MethodEntry, Scene
from mfr_bench.errors import UsageError
from mfr_bench.methods import catalog
from mfr_bench.methods.spec import Fitted, Method, SceneStats
from mfr_bench.oracle.composite import fragment_counts
from mfr_bench.run import jobs as making
from mfr_bench.scene import generate
from mfr_bench.store.record import cell_key

from ..config.fakes import CATALOG

SCENE = Scene(size=(64, 48), depth_complexity=32)
MIB = 2**20


def experiment(*methods, **more):
    entries = tuple(m if isinstance(m, MethodEntry) else MethodEntry(m, CATALOG[m].name, {}) for m in methods)
    plain = {"name": "e", "title": "e", "source": {}, "scene": SCENE, "params": {}, "methods": entries, "sweep": {},
             "zip": {}, "measure": Measure(), "figures": (), "path": None}
    return Experiment(**plain | more)


def cells(*methods, only=None, **more):
    return plan.expand(experiment(*methods, **more), CATALOG, only)


def brief(found):
    return [(c.method, c.point) for c in found]


def test_axes_multiply_and_the_last_is_fastest():
    found = cells("kplus-array", sweep={"k": (4, 8), "sync": ("spin", "interlock")})
    assert [(c.params["k"], c.params["sync"]) for c in found[1:]] == [
        (4, "spin"), (4, "interlock"), (8, "spin"), (8, "interlock")]
    assert found[1].params == {"k": 4, "culling": "on", "sync": "spin"}


def test_zip_pairs_its_axes():
    found = cells("kplus-array", zip={"k": (4, 8), "scene.pixel_density": (0.25, 0.5)})
    assert [(c.params.get("k"), c.scene.pixel_density) for c in found] == [
        (None, 0.25), (4, 0.25), (None, 0.5), (8, 0.5)]


def test_a_method_without_the_swept_parameter_appears_once_and_without_it():
    assert brief(cells("ab-array", "kplus-array", sweep={"k": (4, 8)})) == [
        ("floor", {}), ("ab-array", {}), ("kplus-array", {"k": 4}), ("kplus-array", {"k": 8})]


def test_what_an_entry_fixes_is_no_axis_of_its_own():
    fixed = MethodEntry("kplus-array", "fixed", {"k": 16})
    found = cells("kplus-array", fixed, sweep={"k": (4, 16)})
    assert [(c.label, c.params["k"], c.point) for c in found[1:]] == [
        ("K+B-Array", 4, {"k": 4}), ("fixed", 16, {}), ("K+B-Array", 16, {"k": 16})]


def test_precedence_is_default_then_params_then_axis_then_entry():
    entries = [MethodEntry("kplus-array", name, own) for name, own in (("a", {}), ("b", {"k": 2}))]
    assert [c.params["k"] for c in cells(*entries)[1:]] == [8, 2]
    assert [c.params["k"] for c in cells(*entries, params={"k": 3})[1:]] == [3, 2]
    assert [c.params["k"] for c in cells(*entries, params={"k": 3}, sweep={"k": (4,)})[1:]] == [4, 2]


def test_r_sets_the_depth_complexity_of_every_method():
    found = cells("ab-array", "kplus-array", params={"r": 2}, sweep={"k": (4, 8)})
    assert [(c.method, c.scene.depth_complexity) for c in found] == [
        ("floor", 8), ("ab-array", 8), ("kplus-array", 8), ("floor", 16), ("ab-array", 16), ("kplus-array", 16)]
    assert found[1].point == {"k": 4}


def test_r_may_be_the_axis():
    found = cells("ab-array", params={"k": 3}, sweep={"r": (1, 5)})
    assert [(c.scene.depth_complexity, c.point) for c in found[1::2]] == [(3, {"r": 1}), (15, {"r": 5})]


def test_cells_of_one_scene_are_together_in_the_order_of_the_sweep():
    found = cells("kplus-array", "ab-array", sweep={"k": (4, 8), "scene.seed": (7, 3, 5)})
    seeds = [c.scene.seed for c in found]
    assert list(dict.fromkeys(seeds)) == [7, 3, 5]
    assert seeds == sorted(seeds, key=[7, 3, 5].index)


def test_measurement_settings_can_be_swept():
    found = cells("ab-array", sweep={"measure.min_samples": (3, 4)})
    assert [c.measure.min_samples for c in found] == [3, 3, 4, 4]


def test_a_listed_floor_is_not_added_again():
    found = cells("ab-array", MethodEntry("floor", "blending", {}))
    assert [c.label for c in found] == ["AB_Array", "blending"]


def test_only_keeps_the_named_methods_and_the_floor():
    found = cells("ab-array", "kplus-array", MethodEntry("floor", "blending", {}), only=["kplus-array"])
    assert [c.label for c in found] == ["blending", "K+B-Array"]
    assert cells("ab-array", only=["kplus-array"]) == []
    assert brief(cells("ab-array", only=["floor"])) == [("floor", {})]


def test_only_refuses_a_method_that_there_is_not():
    with pytest.raises(UsageError, match=r"--only: unknown method 'kplus-aray'; allowed: floor, .*; nearest: 'kplus"):
        cells("ab-array", only=["kplus-aray"])


def test_expanding_again_gives_equal_cells():
    sweep = {"k": (4, 8), "scene.seed": (1, 2)}
    assert cells("kplus-array", sweep=sweep) == cells("kplus-array", sweep=sweep)


SWEEPS = {"k": (1, 2, 3), "sync": ("spin", "interlock"), "culling": ("on", "off"), "scene.seed": (5, 6),
          "scene.pixel_density": (0.5, 1.0)}
AXES = st.lists(st.sampled_from(sorted(SWEEPS)), unique=True).map(lambda keys: {key: SWEEPS[key] for key in keys})


@settings(deadline=None, max_examples=50)
@given(sweep=AXES, methods=st.lists(st.sampled_from(sorted(CATALOG)), min_size=1, unique=True))
def test_every_combination_is_there_once(sweep, methods):
    methods = [m for m in methods if m != "kb-small"] or ["ab-array"]
    found = cells(*methods, sweep=sweep)
    assert len({c.identity for c in found}) == len(found)
    for method in {*methods, "floor"}:
        names = {p.name for p in CATALOG[method].params}
        expected = 1
        for key, values in sweep.items():
            expected *= len(values) if key in names or "." in key else 1
        assert sum(c.method == method for c in found) == expected


# decisions

LIMITS = plan.Limits(features=frozenset(), max_block_bytes=128 * MIB, max_texture_size=16384)


def decide(method, scene=SCENE, limits=LIMITS, budget=3072.0, **params):
    found = cells(MethodEntry(method, method, params), scene=scene, measure=Measure(memory_budget_mb=budget))
    [cell] = [c for c in found if c.method == method]
    return plan.judge(cell, CATALOG, plan.expected_stats(scene), limits)


def test_a_cell_that_fits_is_measured():
    assert decide("kplus-array") is None


def test_a_missing_feature_is_named():
    assert decide("kplus-array", sync="interlock") == ("unsupported", "needs fragment_shader_interlock")
    has = replace(LIMITS, features=frozenset({"fragment_shader_interlock"}))
    assert decide("kplus-array", sync="interlock", limits=has) is None
    assert decide("kplus-array", sync="interlock", limits=None) is None


def test_a_buffer_over_the_device_limit_is_named_with_both_numbers():
    scene = Scene(size=(1024, 1024), depth_complexity=32)
    assert decide("kplus-array", scene, k=32) == (
        "over_budget", "needs 256.0 MiB for nodes, the device allows 128.0 MiB in a storage block")
    assert decide("kplus-array", scene, limits=None, k=32) is None


def test_a_sum_over_the_budget_is_given_with_both_numbers():
    scene = Scene(size=(1024, 1024), depth_complexity=4)
    assert decide("kplus-array", scene, budget=32, k=4) == (
        "over_budget", "needs 36.0 MiB, the budget is 32.0 MiB")
    assert decide("kplus-array", scene, budget=36, k=4) is None
    assert decide("kplus-array", scene, budget=35.999, k=4) == (
        "over_budget", "needs 36.000 MiB, the budget is 35.999 MiB")


def test_a_sum_little_over_a_small_budget_is_told_from_it():
    """A histogram of 4 KiB beside 1 MiB of slots, counters and semaphores."""
    _, reason = of_all("kplus-array-dynamic", Scene(size=(256, 256), depth_complexity=16), 1)
    assert reason == ("over_budget", "needs 1.004 MiB, the budget is 1 MiB")


def of_all(method, scene, budget, **params):
    """The cell of a method of the whole catalog, and why it is not measured."""
    methods = catalog()
    made = experiment(MethodEntry(method, method, params), scene=scene, measure=Measure(memory_budget_mb=budget))
    cell = plan.expand(made, methods)[-1]
    return cell, plan.judge(cell, methods, plan.expected_stats(scene), LIMITS)


@pytest.mark.parametrize("method", ["kplus-sb-dynamic", "kplus-array-dynamic", "kplus-heap-dynamic"])
@pytest.mark.parametrize("budget", [8.0, 20.0, 20.5, 100.0, 3072.0])
def test_a_method_that_decides_by_its_memory_keeps_the_budget_of_all(method, budget):
    """At a round number of MiB too, which a whole number of slots per pixel fills."""
    scene = Scene(size=(512, 512), depth_complexity=40)
    cell, reason = of_all(method, scene, budget)
    assert reason is None
    assert cell.params["memory_mb"] <= budget
    assert cell.params["memory_mb"] == pytest.approx(min(200, budget), abs=0.005)


def test_a_memory_that_is_given_stays_and_is_named_where_it_exceeds_the_budget_of_all():
    scene = Scene(size=(512, 512), depth_complexity=24)
    for memory_mb in (90, 200):
        assert of_all("kplus-array-dynamic", scene, 20, memory_mb=memory_mb)[1] == (
            "over_budget", "needs 48.0 MiB, the budget is 20.0 MiB; memory_mb=20 may keep it")
    assert of_all("kplus-array-dynamic", scene, 20, memory_mb=19.9)[1] is None
    assert of_all("adaptive", scene, 1)[1][1].endswith("; memory_mb=1 may keep it")


def test_a_viewport_over_the_texture_limit():
    limits = replace(LIMITS, max_texture_size=50)
    assert decide("ab-array", limits=limits) == (
        "over_budget", "needs textures of 64 pixels a side, the device allows 50")


def test_the_overview_says_what_would_be_skipped_and_why():
    found = cells("kplus-array", sweep={"sync": ("spin", "interlock")})
    rows = plan.overview(found, CATALOG, LIMITS)
    assert [r["decision"] for r in rows] == ["measure", "measure", "unsupported: needs fragment_shader_interlock"]
    assert rows[1] == {"experiment": "e", "label": "K+B-Array", "method": "kplus-array", "point": {"sync": "spin"},
                       "scene": SCENE.as_dict(), "memory_bytes": 4 * 17 * 64 * 48, "decision": "measure"}


# what would time out

LESS = Scene(size=(64, 48), layout="mixed", depth_complexity=20, mean_depth=4, pixel_density=0.5,
             fragment_probability=0.5)


def told_timeout(of, known, method="kplus-array"):
    """The reason why a cell, of a scene and a k, is predicted to time out where the `known` one took 3 s a frame."""
    def made(scene, k):
        entry = MethodEntry(method, method, {"k": k})
        return plan.expand(experiment(entry, scene=scene, measure=Measure(time_limit_s=1)), catalog(), [method])[-1]
    return plan.predicted_timeout(made(*of), [plan.CellOutcome(made(*known), "ok", 3000.0)])


@pytest.mark.parametrize(("name", "less", "more"), [
    ("mean_depth", 3, 5), ("size", (64, 47), (65, 48)), ("depth_complexity", 19, 21), ("pixel_density", 0.4, 0.6),
    ("fragment_probability", 0.4, 0.6)])
def test_more_of_what_makes_work_times_out_and_less_is_not(name, less, more):
    reason = told_timeout((replace(LESS, **{name: more}), 8), (LESS, 8))
    assert reason.startswith("kplus-array at 64 x 48 pixels, n = 20 (mean 4), k = 8 took 3 s a frame")
    assert told_timeout((replace(LESS, **{name: less}), 8), (LESS, 8)) is None


@pytest.mark.parametrize("change", [{"order": "front_to_back"}, {"seed": 9}, {"layout": "block", "mean_depth": None}])
def test_another_scene_tells_nothing(change):
    assert told_timeout((replace(LESS, depth_complexity=30, **change), 8), (LESS, 8)) is None


def test_more_k_is_more_work_but_where_it_saves_passes():
    assert told_timeout((LESS, 16), (LESS, 8))
    assert told_timeout((LESS, 4), (LESS, 8)) is None
    assert [m.id for m in catalog().values() if m.k_saves_passes] == ["peel-kplus"]
    for k in (4, 16):
        assert told_timeout((LESS, k), (LESS, 8), method="peel-kplus") is None
    deeper = replace(LESS, depth_complexity=30)
    assert told_timeout((deeper, 8), (LESS, 8), method="peel-kplus")


# what a scene comes to, against the scenes themselves

SCENES = st.builds(Scene, size=st.tuples(st.integers(1, 150), st.integers(1, 150)), depth_complexity=st.integers(0, 5),
                   pixel_density=st.floats(0.01, 1), layout=st.sampled_from(["block", "tiles"]),
                   seed=st.integers(0, 2**32 - 1))


@settings(deadline=None, max_examples=80)
@given(scene=SCENES)
def test_expected_sizes_are_exact_without_rejected_fragments(scene):
    stats, counts = plan.expected_stats(scene), fragment_counts(generate(scene))
    assert counts.sum() == stats.F
    assert stats.n == max(1, counts.max())
    assert stats.primitives == len(generate(scene))
    if scene.depth_complexity:
        covered = int((counts > 0).sum())
        assert stats.histogram == (counts.size - covered, *(0,) * (scene.depth_complexity - 1), covered)


@settings(deadline=None, max_examples=40)
@given(scene=SCENES, probability=st.floats(0.05, 1), layout=st.sampled_from(["block", "tiles", "random"]))
def test_expected_histograms_hold_every_pixel(scene, probability, layout):
    scene = replace(scene, fragment_probability=probability, layout=layout)
    stats = plan.expected_stats(scene)
    assert sum(stats.histogram) == stats.P
    assert min(stats.histogram) >= 0
    assert stats.bounded(stats.n) == stats.F
    assert stats.primitives == len(generate(scene))


@pytest.mark.parametrize("probability", [1.0, 0.25])
def test_expected_sizes_of_pixels_that_draw_their_number_of_fragments(probability):
    scene = Scene(size=(200, 160), pixel_density=0.6, depth_complexity=40, least_depth=0.1,
                  fragment_probability=probability)
    stats, counts = plan.expected_stats(scene), fragment_counts(generate(scene))
    assert stats.rejects and sum(stats.histogram) == stats.P
    assert pytest.approx(counts.sum(), rel=0.02) == stats.F
    assert stats.n == pytest.approx(counts.max(), rel=0.2)


@pytest.mark.parametrize(("layout", "probability"), [("block", 0.3), ("tiles", 0.7), ("random", 1.0), ("random", 0.5)])
def test_expected_sizes_are_near_where_chance_decides(layout, probability):
    scene = Scene(size=(200, 160), pixel_density=0.6, depth_complexity=40, layout=layout,
                  fragment_probability=probability)
    stats, counts = plan.expected_stats(scene), fragment_counts(generate(scene))
    assert pytest.approx(counts.sum(), rel=0.06) == stats.F
    assert stats.n == pytest.approx(counts.max(), rel=0.2)


def test_a_local_array_that_the_driver_cannot_compile_is_refused():
    """By the fragments that the resolve of a variant holds at once, not by those of the scene."""
    stats = SceneStats(W=2, H=1, n=2000, F=4000, primitives=2000, histogram=(0,) * 2000 + (2,))
    methods = catalog()
    lengths = {"ab-array": 2000, "peel-f2b": 0, "lin-pre": 0, "kb-ab-array": 8, "peel-kplus": 8}
    assert {i: Fitted(methods[i].variant({}), stats).local_array() for i in lengths} == lengths
    assert Fitted(methods["ab-array"].variant({"sort": "lplus"}), stats).local_array() == 32
    limits = plan.Limits(frozenset(), 2**30, 16384, max_local_array=1024)
    cell = plan.Cell("e", "ab-array", "AB", methods["ab-array"].variant({}).params, SCENE, Measure(), {})
    status, reason = plan.judge(cell, methods, stats, limits)
    assert status == "over_budget"
    assert "local array of 2000 fragments" in reason
    assert plan.judge(cell, methods, replace(stats, n=1024), limits) is None


def known(scene, time_ms, **more):
    entry = MethodEntry("floor", "floor", {})
    made = plan.expand(experiment(entry, scene=scene, measure=Measure(time_limit_s=1)), catalog(), ["floor"])[-1]
    return plan.CellOutcome(made, "ok", time_ms, **more)


def test_a_cell_of_no_less_work_that_was_fast_overrules_a_slow_one():
    small, large, larger = (replace(LESS, depth_complexity=n) for n in (20, 30, 40))
    slow, beyond = known(small, 3000.0), known(larger, None).cell
    assert plan.predicted_timeout(beyond, [slow])
    assert plan.predicted_timeout(beyond, [slow, known(large, 0.2)]) is None
    assert plan.predicted_timeout(beyond, [slow, known(large, 3000.0)])
    assert plan.predicted_timeout(beyond, [slow, known(replace(LESS, depth_complexity=19), 0.2)])


def test_a_stalled_frame_proves_nothing_where_another_was_fast():
    larger = known(replace(LESS, depth_complexity=40), None).cell
    assert plan.predicted_timeout(larger, [known(LESS, 3000.0, fastest_ms=0.2)]) is None
    assert plan.predicted_timeout(larger, [known(LESS, 3000.0, fastest_ms=1500.0)])


def test_a_cell_that_was_not_tried_tells_nothing():
    tried = {"status": "timeout", "reason": "first frame: no end within 30 s", "values": {}}
    cell = known(LESS, None).cell
    assert plan.CellOutcome.of(cell, tried).over_limit(cell.measure)
    assert plan.CellOutcome.of(cell, tried | {"reason": f"floor took 3 s a frame; {plan.NOT_TRIED}"}) is None


@pytest.mark.parametrize(("method", "reason"), [
    ("kb", "needs draw_buffers_16: without it k is at most 16"),
    ("kb-sr", "needs samples_64: without it k is at most 4")])
def test_a_k_that_the_device_lacks_a_feature_for_is_told_with_the_largest_that_it_allows(method, reason):
    limits = replace(LIMITS, features=frozenset({"samples_4"}))
    variant = catalog()[method].variant({"k": 1000})
    cell = plan.Cell("planted", method, method, variant.params, SCENE, Measure(), {})
    assert plan.judge(cell, catalog(), plan.expected_stats(SCENE), limits) == ("unsupported", reason)


def counting(made, of, name):
    """The method of a class, which counts its calls."""
    real = getattr(of, name)

    def counted(self, *parts):
        made[f"{of.__name__}.{name}"] += 1
        return real(self, *parts)

    return counted


def test_a_plan_makes_scenes_texts_and_variants_once(monkeypatch):
    """The work on a cell of a long sweep is that on its own numbers: what cells share is not made for each anew."""
    made = Counter()
    for of, name in ((Scene, "as_dict"), (Measure, "as_dict"), (Method, "variant")):
        monkeypatch.setattr(of, name, counting(made, of, name))
    monkeypatch.setattr(making, "glsl_hash", lambda *shaders: "code")
    device = {"renderer": "r", "version": "v"}
    found = cells("ab-array", "kplus-array", sweep={"k": (4, 8), "scene.seed": (1, 2, 3)})
    rows = plan.overview(found, CATALOG, LIMITS)
    made_by_rows = dict(made)
    made.clear()
    jobs = making.jobs(found, CATALOG, device, "wall")
    assert made_by_rows == {"Scene.as_dict": 3, "Method.variant": 4}
    assert made == {"Scene.as_dict": 3, "Measure.as_dict": 1, "Method.variant": 4}
    assert len({job.key for job in jobs}) == len(found) == len(rows) == 12
    for job, row in zip(jobs, rows, strict=True):
        whole = {"method": job.cell.method, "params": dict(job.cell.params), "glsl_hash": "code", "device": device,
                 "scene": row["scene"], "measure": job.cell.measure.as_dict()}
        assert job.key == cell_key(whole, "wall")
