"""The rule vocabulary on its own: what is compared with what, and how it is decided."""

from __future__ import annotations

from itertools import count

import pytest

from mfr_bench.claims import load_runs
from mfr_bench.claims.evidence import (
    MORE,
    Bound,
    BoundByMaker,
    Evidence,
    Outcome,
    about,
    at_least,
    at_most,
    bound_on,
    decided,
    gain,
    speedup,
)
from mfr_bench.claims.measures import COST, MEMORY
from mfr_bench.claims.memory_rules import Memory, RunsOut
from mfr_bench.claims.picks import ALL_LAYERS, fastest_of, from_, if_any, other_than, pick, up_to, within
from mfr_bench.claims.rules import CountedValue, PassShare, Ratio, RatioChange, Straight
from mfr_bench.claims.verdict import Finding

from . import planted
from .planted import cell, refused


@pytest.fixture
def run(tmp_path):
    """Makes a run of the given cells."""
    numbers = count()

    def made(*cells, **manifest):
        (found,) = load_runs([planted.folder(tmp_path / f"run{next(numbers)}", "planted", cells, **manifest)])
        return found
    return made


def values(comparisons):
    return [pytest.approx(c.value, rel=1e-3) for c in comparisons]


@pytest.mark.parametrize(("interval", "bound", "outcome"), [
    ((1.1, 1.2, 1.3), MORE, Outcome.HOLDS), ((0.7, 0.8, 0.9), MORE, Outcome.FAILS),
    ((0.9, 1.1, 1.3), MORE, Outcome.UNCLEAR), ((1.0, 1.0, 1.0), at_least(1), Outcome.HOLDS),
    ((0.4, 0.5, 0.6), at_most(0.7), Outcome.HOLDS), ((0.8, 0.9, 1.0), at_most(0.7), Outcome.FAILS),
    ((7.0, 8.0, 9.0), about(10), Outcome.HOLDS), ((3.0, 4.0, 5.0), about(10), Outcome.FAILS),
    ((16.0, 17.0, 18.0), about(10), Outcome.FAILS), ((5.0, 8.0, 9.0), about(10), Outcome.UNCLEAR),
    ((1.04, 1.05, 1.1), gain(7), Outcome.HOLDS), ((1.0, 1.01, 1.02), gain(7), Outcome.FAILS),
    ((9.0, 10.0, 11.0), speedup(3), Outcome.HOLDS), ((1.5, 1.6, 1.7), speedup(3), Outcome.FAILS),
    ((None, 5.0, None), MORE, Outcome.UNCLEAR), ((None, None, None), MORE, Outcome.UNCLEAR),
    ((0.0, 0.0, 0.0), at_most(0.02), Outcome.HOLDS),
])
def test_the_whole_interval_must_be_on_one_side(interval, bound, outcome):
    assert decided(interval, bound, 0.0)[0] is outcome


@pytest.mark.parametrize("middle", [1.04, 0.96])
def test_noise_hides_small_differences_both_ways(middle):
    tight = (middle * 0.999, middle, middle * 1.001)
    assert decided(tight, MORE, 0.03)[0] is not Outcome.UNCLEAR
    assert decided(tight, MORE, 0.05) == (Outcome.UNCLEAR,
                                          "no further from the limit than the run's noise floor of 5 %")


def test_a_bound_may_depend_on_the_maker():
    bound = BoundByMaker({"NVIDIA": at_least(2), "Intel": at_least(1.5)}, MORE)
    assert [bound_on(m, bound).low for m in ("NVIDIA Corporation", "Mesa Intel(R) Iris", "AMD")] == [2, 1.5, 1]
    assert bound.words == "at least 2 on NVIDIA, at least 1.5 on Intel, above 1 elsewhere"


def test_a_ratio_compares_cells_of_one_scene_and_of_equal_shared_parameters(run):
    cells = [cell(m, ms * k, {"k": k, "sync": sync}, depth_complexity=n)
             for m, ms in (("a", 2.0), ("b", 1.0)) for k in (4, 8) for sync in ("spin", "interlock") for n in (16, 32)]
    found = Ratio(pick("a"), pick("b")).compare(run(*cells))
    assert len(found) == 8
    assert values(found) == [2.0] * 8


def test_what_both_sides_state_may_differ(run):
    cells = [cell("a", ms, {"k": 4, "sync": sync}) for sync, ms in (("spin", 3.0), ("interlock", 1.0))]
    (found,) = Ratio(pick("a", sync="spin"), pick("a", sync="interlock")).compare(run(*cells))
    assert found.what == "a (sync spin / sync interlock)"
    assert values([found]) == [3.0]


def test_a_method_without_a_parameter_is_compared_at_all_of_its_values(run):
    cells = [cell("with", float(k), {"k": k}) for k in (4, 8)] + [cell("without", 2.0)]
    assert values(Ratio(pick("with"), pick("without")).compare(run(*cells))) == [2.0, 4.0]


@pytest.mark.parametrize(("where", "expected"), [
    ({"k": 8}, [8]), ({"k": from_(16)}, [16, 32]), ({"k": up_to(8)}, [4, 8]), ({"k": within(5, 20)}, [8, 16]),
    ({"k": other_than(8)}, [4, 16, 32]), ({"k": ALL_LAYERS}, [32]), ({"n": 32, "p_d": 1, "k": 4}, [4]),
    ({"size": (64, 64), "order": "random", "k": 4}, [4]), ({"sync": "spin"}, []), ({"size": (64, 32)}, []),
    ({"sync": if_any("spin")}, [4, 8, 16, 32]),
])
def test_conditions_choose_cells(run, where, expected):
    points = run(*(cell("a", params={"k": k}, depth_complexity=32) for k in (4, 8, 16, 32))).points
    assert [p.at("k") for p in points if pick("a", **where).takes(p)] == expected


def test_the_fastest_is_chosen_scene_by_scene(run):
    cells = [cell(m, ms, {"k": k}) for m, k, ms in (("a", 4, 1.0), ("b", 4, 2.0), ("a", 64, 4.0), ("b", 64, 3.0),
                                                    ("rival", 4, 5.0), ("rival", 64, 6.0))]
    found = Ratio(pick("rival"), fastest_of("a", "b")).compare(run(*cells))
    assert [c.what for c in found] == ["rival / a", "rival / b"]
    assert [c.value for c in found] == pytest.approx([5, 2], rel=1e-3)


def test_cells_of_two_folders_or_devices_are_never_compared(tmp_path):
    one = planted.folder(tmp_path / "one", "planted", [cell("a", 2.0)])
    other = planted.folder(tmp_path / "other", "planted", [cell("b", 1.0)])
    rule = Ratio(pick("a"), pick("b"))
    assert [rule.compare(r) for r in load_runs([one, other])] == [[], []]
    mixed = [cell("a", 2.0), cell("b", 1.0) | {"device": planted.CPU}]
    both = planted.planted.folder(tmp_path / "both", mixed, name="planted", device=planted.GPU)
    runs = load_runs([both])
    assert [r.device for r in runs] == ["nvidia-h200", "llvmpipe"]
    assert [r.software for r in runs] == [False, True]
    assert [rule.compare(r) for r in runs] == [[], []]


def test_memory_and_cost(run):
    made = run(cell("a", 4.0, values={"memory_bytes": 100}), cell("b", 1.0, values={"memory_bytes": 50}))
    assert values(Ratio(pick("a"), pick("b"), measure=MEMORY).compare(made)) == [2.0]
    assert values(Ratio(pick("a"), pick("b"), measure=COST).compare(made)) == [8.0]


def test_memory_by_formula_uses_the_cell_s_own_sizes(run):
    made = run(cell("a", params={"k": 8}, values={"fragments": 8192, "hit_ratio": 0.5, "memory_bytes": 4096 * 100},
                    depth_complexity=4))

    def ratio(formula, each=1):
        (found,) = Memory(((pick("a"), formula),), each, "bytes", MORE).compare(made)
        return found.value
    assert ratio("100") == 1  # 4096 pixels
    assert ratio("k", 4) == 100 / 32
    assert ratio("n") == 25
    assert ratio("f") == 50  # 8192 / 4096
    assert ratio("f_k") == 100  # half of them kept


def test_change_compares_the_ends_of_a_sweep(run):
    cells = [cell("a", ms, {"k": k, "culling": c}) for k, on, off in ((4, 1.0, 3.0), (16, 1.0, 9.0), (64, 2.0, 3.0))
             for c, ms in (("on", on), ("off", off))]
    rule = RatioChange(Ratio(pick("a", culling="off"), pick("a", culling="on")), "k", MORE)
    (found,) = rule.compare(run(*cells))
    assert values([found]) == [0.5]
    assert found.outcome is Outcome.FAILS
    assert rule.compare(run(*cells[:2])) == []


@pytest.mark.parametrize(("power", "time_ms", "outcome"), [
    (1, lambda n: 3 + 0.5 * n, Outcome.HOLDS), (1, lambda n: 0.1 * n * n, Outcome.FAILS),
    (2, lambda n: 3 + 0.1 * n * n, Outcome.HOLDS), (2, float, Outcome.FAILS),
])
def test_straight_lines(run, power, time_ms, outcome):
    cells = [cell("a", time_ms(n), depth_complexity=n) for n in (4, 16, 40, 64)]
    found = Straight(pick("a"), "n", power=power, tolerance=0.15).compare(run(*cells))
    assert {c.outcome for c in found} == {outcome}
    assert len(found) == 2


@pytest.mark.parametrize("ns", [(4, 64), (32, 40, 48)])
def test_a_line_needs_three_points_and_a_span(run, ns):
    assert Straight(pick("a"), "n").compare(run(*(cell("a", depth_complexity=n) for n in ns))) == []


def test_cells_that_were_refused_do_not_end_a_line(run):
    cells = [cell("a", float(n), depth_complexity=n) for n in (4, 16, 64)]
    found = Straight(pick("a"), "n").compare(run(*cells, refused("a", depth_complexity=640)))
    assert [c.outcome for c in found] == [Outcome.LEFT_OUT, Outcome.HOLDS]


def test_share_of_a_pass(run):
    made = run(cell("a", passes={"clear": 1.0, "build": 6.0, "render": 3.0}))
    (found,) = PassShare(pick("a"), "clear", Bound("a tenth", 0.09, 0.11)).compare(made)
    low, share, high = found.interval
    assert (low, share, high) == (pytest.approx(0.1, rel=0.01),) * 3
    assert low < share < high
    assert found.outcome is Outcome.HOLDS
    (absent,) = PassShare(pick("a"), "count", MORE).compare(made)
    assert (absent.outcome, absent.reason) == (Outcome.UNCLEAR, "not measured")


def test_counted_values(run):
    made = run(cell("a", values={"culled_share": 0.9}), cell("b"))
    assert [c.outcome for c in CountedValue(pick("a"), "culled_share", at_least(0.5)).compare(made)] == [Outcome.HOLDS]
    (unclear,) = CountedValue(pick("b"), "culled_share", at_least(0.5)).compare(made)
    assert unclear.outcome is Outcome.UNCLEAR


@pytest.mark.parametrize(("status", "outcome"), [
    ("over_budget", Outcome.HOLDS), ("out_of_memory", Outcome.HOLDS), ("overflow", Outcome.HOLDS),
    ("unsupported", Outcome.LEFT_OUT), ("crashed", Outcome.UNCLEAR),
])
def test_running_out_of_memory(run, status, outcome):
    (found,) = RunsOut(pick("a")).compare(run(refused("a", status=status)))
    assert found.outcome is outcome
    (ran,) = RunsOut(pick("a")).compare(run(cell("a")))
    assert (ran.outcome, ran.reason) == (Outcome.FAILS, "ran with 1.0 MiB")


def finding(*outcomes, each=()):
    rule = Ratio(pick(*(each or ("a",))), pick("b"))
    comparisons = tuple(Evidence(f"c{i}", {"methods": ("a", "b"), "k": i}, (None, 1.0 + i, None), outcome, "why",
                                   margin=i) for i, outcome in enumerate(outcomes))
    return Finding(rule, comparisons)


def test_the_worst_comparison_decides_a_rule():
    holds, fails, unclear, left = Outcome.HOLDS, Outcome.FAILS, Outcome.UNCLEAR, Outcome.LEFT_OUT
    assert finding(holds, fails, unclear).outcome is fails
    assert finding(holds, unclear, left).outcome is unclear
    assert finding(left, holds, holds).outcome is holds
    assert finding(left, holds, holds).deciding.what == "c1"
    assert finding(left).outcome is unclear
    assert finding(left).reason == "why"
    assert finding().reason == "no cells of a beside b"


def test_a_method_that_is_missing_altogether_leaves_a_rule_open():
    found = finding(Outcome.HOLDS, each=("a", "other"))
    assert found.outcome is Outcome.UNCLEAR
    assert found.reason == "no cells of other"
    assert finding(Outcome.FAILS, each=("a", "other")).outcome is Outcome.FAILS
