"""Verdicts on single cells, and what else is not as it was."""

import pytest

from mfr_bench.compare import compare
from mfr_bench.compare.judge import FASTER, SAME, SLOWER, UNCLEAR
from mfr_bench.compare.noise import Shift, estimate
from mfr_bench.compare.present import as_text
from mfr_bench.errors import UsageError

from ..report.planted import spread
from .planted import Machine, cell, run, side

STILL = Machine(cv=0.002, shift=0.0, load=0.0)
SCENES = (16, 32)


def cells(times=None, device=None, **parts):
    """Two cells of each method, at ms as given; fewer than show what they have in common."""
    return [cell(name, spread(ms * n / 16, 22, 0.004), {"depth_complexity": n}, device, **parts)
            for name, ms in (times or {"a": 1.0, "b": 2.0}).items() for n in SCENES]


def verdicts(found):
    return {v.name: v.verdict for v in found.verdicts}


@pytest.mark.parametrize(("factor", "verdict"), [(1.1, SLOWER), (0.9, FASTER), (1.0, SAME), (1.005, SAME),
                                                 (1.019, UNCLEAR)])
def test_times_beyond_noise_and_threshold_count(factor, verdict):
    found = compare(side(cells(), noise=0.002), side(cells({"a": factor, "b": 2.0}), noise=0.002))
    assert verdicts(found) == {"a, n 16": verdict, "a, n 32": verdict, "b, n 16": SAME, "b, n 32": SAME}
    assert found.regressed == (verdict == SLOWER)
    assert found.doubtful == (verdict == UNCLEAR)


def test_what_a_program_learnt_since_is_at_its_default_in_older_results():
    def made(params, scene):
        return side([cell("kplus-array", spread(1.0, 22, 0.004), {"depth_complexity": 16} | scene, params=params)])

    old, new = made({"k": 4}, {}), made({"k": 4, "touched": "off"}, {"overhang": 0})
    assert len(compare(old, new).verdicts) == 1
    assert compare(old, made({"k": 4, "touched": "bounds"}, {})).verdicts == ()


def test_the_threshold_is_the_smallest_difference_that_matters():
    before, after = side(cells(), noise=0.002), side(cells({"a": 1.05, "b": 2.0}), noise=0.002)
    assert verdicts(compare(before, after, 0.02))["a, n 16"] == SLOWER
    assert verdicts(compare(before, after, 0.10))["a, n 16"] == SAME


@pytest.mark.parametrize("noisy", ["before", "after"])
def test_nothing_below_either_noise_floor_is_called_a_change_where_cells_are_few(noisy):
    before = side(cells(), noise=0.2 if noisy == "before" else 0.002)
    after = side(cells({"a": 1.1, "b": 2.0}), noise=0.2 if noisy == "after" else 0.002)
    assert set(verdicts(compare(before, after)).values()) <= {SAME, UNCLEAR}


def test_what_all_methods_have_in_common_is_taken_out_unless_asked_for():
    before, slow = run(STILL, 1), run(STILL, 2)
    for entry in slow.entries.values():
        entry.point.cell["samples_ms"] = [1.3 * s for s in entry.point.cell["samples_ms"]]
    relative, absolute = compare(before, slow), compare(before, slow, absolute=True)
    assert set(verdicts(relative).values()) == {SAME}
    assert relative.common == pytest.approx((1.3, 1.3), rel=0.01) and relative.moved and relative.doubtful
    assert set(verdicts(absolute).values()) == {SLOWER}


def test_one_cell_that_moved_against_the_others_of_its_method_must_be_far_out():
    """A burst of load hits one cell; a method that changed moves in more than one."""
    jumpy = Machine(cv=0.003, shift=0.005, load=0.0)
    before, after = run(jumpy, 1), run(jumpy, 2)
    name = "m7, n 32"
    alone = next(e for e in after.entries.values() if e.name == name)
    samples = alone.point.cell["samples_ms"]
    for factor, verdict in ((1.07, UNCLEAR), (1.5, SLOWER)):
        alone.point.cell["samples_ms"] = [factor * s for s in samples]
        found = next(v for v in compare(before, after).verdicts if v.name == name)
        assert found.verdict == verdict
    alone.point.cell["samples_ms"] = [1.07 * s for s in samples]
    assert "no other cell of the method" in next(v.reason for v in compare(before, after).verdicts if v.name == name)


@pytest.mark.parametrize("methods", [2, 30])
def test_times_without_any_noise_compare_too(methods):
    def still(factor):
        return side([cell(f"m{m}", [factor if m == 0 else 1.0] * 10, {"depth_complexity": n})
                     for m in range(methods) for n in SCENES], noise=0.0)
    assert set(verdicts(compare(still(1.0), still(1.0))).values()) == {SAME}
    assert {name for name, verdict in verdicts(compare(still(1.0), still(1.1))).items() if verdict != SAME} == {
        "m0, n 16", "m0, n 32"}


def test_other_timers_are_unclear():
    found = compare(side(cells()), side(cells(values={"timer": "gpu"})))
    assert {(v.verdict, v.reason) for v in found.verdicts} == {(UNCLEAR, "timed by wall, then by gpu")}


@pytest.mark.parametrize(("parts", "text", "worse"), [
    ({"status": "wrong", "reason": "3 fragments lost"}, "ok -> wrong image (3 fragments lost)", True),
    ({"status": "crashed", "reason": "gone"}, "ok -> crashed (gone)", True),
    ({"status": "unsupported", "reason": "needs int64"}, "ok -> unsupported", None),
    ({"values": {"memory_bytes": 2**21}}, "memory 1,048,576 -> 2,097,152 bytes", True),
    ({"values": {"memory_bytes": 2**19}}, "memory 1,048,576 -> 524,288 bytes", False),
    ({"values": {"max_abs_error": 0.25}}, "max_abs_error 1e-07 -> 0.25", True),
    ({"values": {"rmse": 0.25}}, "rmse 1e-08 -> 0.25", True),
    ({"values": {"max_abs_error": 3e-7, "rmse": 5e-5}}, None, None),
])
def test_status_image_and_memory_are_compared_too(parts, text, worse):
    found = compare(side(cells()), side(cells(**parts)))
    assert {c.text for v in found.verdicts for c in v.changes} == ({text} if text else set())
    assert {c.worse for v in found.verdicts for c in v.changes} <= {worse}
    assert found.regressed == bool(worse)
    back = compare(side(cells(**parts)), side(cells()))
    assert not (back.regressed and worse)


def test_cells_of_a_device_that_fails_self_tests_are_one_line():
    refused = {"status": "unsupported", "reason": "needs OpenGL as it is", "failed_trials": ["blending", "queries"]}
    found = compare(side(cells()), side(cells(**refused)))
    said = " ".join(as_text(found, 500).split())
    assert said.count("-> unsupported") == 1
    assert (f"- {len(found.verdicts)} cells: ok -> unsupported, where the device fails the trials blending, queries: "
            "see mfr-bench doctor") in said
    assert [len(record["changes"]) for record in found.records()] == [1] * len(found.verdicts)
    wrong = side(cells(status="wrong", reason="lost"))
    assert "better" not in as_text(compare(wrong, side(cells(**refused))), 500)


def test_what_is_wrong_has_no_time_to_compare():
    found = compare(side(cells()), side(cells({"a": 3.0, "b": 2.0}, status="wrong", reason="lost")))
    assert {v.verdict for v in found.verdicts} == {None}


def test_cells_of_one_side_are_listed_and_leave_doubt():
    found = compare(side(cells()), side(cells({"a": 1.0, "c": 1.0})))
    assert [e.name for e in found.missing_after] == ["b, n 16", "b, n 32"]
    assert [e.name for e in found.missing_before] == ["c, n 16", "c, n 32"]
    assert found.doubtful and not found.regressed


def test_other_devices_are_refused_unless_asked_for():
    other = {"renderer": "NVIDIA H200", "version": "4.6", "slug": "nvidia-h200"}
    before, after = side(cells(), "old"), side(cells({"a": 0.1, "b": 0.4}, device=other), "new")
    with pytest.raises(UsageError, match=r"old is of llvmpipe.* new is of NVIDIA H200, 4.6.*--across-devices"):
        compare(before, after)
    assert set(verdicts(compare(before, after, across_devices=True)).values()) == {FASTER}


def test_the_environments_differences_are_told():
    found = compare(side(cells(), environment={"mesa": "22", "kernel": "6"}),
                    side(cells(), environment={"mesa": "23", "kernel": "6"}))
    assert found.environment == ["mesa: 22 -> 23"]


def test_a_few_cells_that_changed_do_not_widen_the_noise():
    shifts = [Shift("scene", i, 0.01 * ((7 * i) % 11 - 5) / 5, 0.003) for i in range(60)]
    changed = [Shift("scene", i, 0.5, 0.003) for i in range(60, 62)]
    plain, planted = estimate(shifts, 0.01), estimate([*shifts, *changed], 0.01)
    assert planted.deviations[0] == pytest.approx(plain.deviations[0], rel=0.15)
    assert planted.common[0] == pytest.approx(plain.common[0], abs=0.002)


def test_a_comparison_that_tells_nothing_says_so():
    """All cells unclear, or only lost ones: nobody may take it for a pass. A few unclear cells are ordinary."""
    gpu, none = side(cells(values={"timer": "gpu"})), side(cells(status="unsupported", reason="needs int64"))
    assert compare(side(cells()), gpu).untold and compare(side(cells()), none).untold
    assert {v.verdict for v in compare(side(cells()), none).verdicts} == {UNCLEAR}
    assert not compare(side(cells()), side(cells(status="wrong", reason="lost"))).untold
    some = compare(side(cells(), noise=0.002), side(cells({"a": 1.019, "b": 2.0}), noise=0.002))
    assert some.counts[UNCLEAR] and not some.untold and some.doubtful


def test_cells_of_one_side_are_missing_in_every_count_and_record():
    found = compare(side(cells(), "old"), side(cells({"a": 1.0, "c": 1.0}), "new"))
    assert found.counts["MISSING"] == 4 and found.untold
    assert [(r["name"], r["reason"], r["before_ms"] is None) for r in found.records() if r["verdict"] == "MISSING"] == [
        ("b, n 16", "only in old", False), ("b, n 32", "only in old", False),
        ("c, n 16", "only in new", True), ("c, n 32", "only in new", True)]
