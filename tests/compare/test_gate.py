"""`compare` as a gate: a slowdown in one of 28 cells, and none, on machines that are never twice the same."""

from dataclasses import replace

import numpy as np
import pytest

from mfr_bench.compare import compare
from mfr_bench.compare.few import Frames
from mfr_bench.compare.judge import FASTER, SAME, SLOWER
from mfr_bench.compare.noise import MOST_STRETCH, Shift, estimate

from .planted import SCENES, Machine, Runs, cell, run, side

METHODS = 14  # in two scenes: 28 cells
SEEDS = 50
MACHINES = {"quiet": Machine(cv=0.005, shift=0.004), "usual": Machine(cv=0.01, shift=0.006),
            "noisy": Machine(cv=0.03, shift=0.02, load=0.2)}
TAILS = ("normal", "laplace", "t3", "bursts")
MANY = None  # frames of a cell: 10 to 49


def gate(runs, factor, seed, before=MANY, after=MANY, slowed=MANY):
    """Whether the slowed cell is found, and whether any other is called a change.

    `before`, `after`: frames of each cell of a side; `slowed`: of the slowed cell, after.
    """
    method, scene = seed % METHODS, SCENES[seed % 2]
    old, new = runs.side(2 * seed, before), runs.slowed(2 * seed + 1, method, scene, factor, after, slowed)
    called = [(v.after.point.method, v.after.point.cell["scene"]["depth_complexity"], v.verdict)
              for v in compare(old, new).verdicts if v.verdict in (SLOWER, FASTER)]
    planted = (f"m{method}", scene, SLOWER)
    return planted in called, any(c != planted or factor == 1 for c in called)


def gates(runs, factor, **counts):
    """Counts of SEEDS comparisons: those that find the slowdown, and those that call something else a change."""
    found = [gate(runs, factor, seed, **counts) for seed in range(SEEDS)]
    return sum(hit for hit, _ in found), sum(alarm for _, alarm in found)


@pytest.fixture(params=[(name, tails) for name in MACHINES for tails in TAILS], ids="-".join, scope="module")
def runs(request):
    """The runs of a machine, for all tests of it in turn."""
    name, tails = request.param
    return Runs(replace(MACHINES[name], tails=tails), METHODS)


@pytest.mark.parametrize("factor", [1.0, 1.05, 1.3])
def test_at_most_1_comparison_in_20_calls_a_change_that_is_none(runs, factor):
    assert gates(runs, factor)[1] <= SEEDS / 20


def test_a_run_of_single_samples_raises_no_more_alarms(runs):
    assert gates(runs, 1.0, before=1, after=1, slowed=1)[1] <= SEEDS / 20


@pytest.mark.parametrize("samples", [3, 4, 5])
def test_bursts_in_runs_of_few_samples_raise_no_more_alarms(samples):
    """The gap that few samples leave is guessed rather too large; it must not hide how far bursts reach."""
    runs = Runs(replace(MACHINES["noisy"], tails="bursts"), METHODS)
    assert gates(runs, 1.0, before=samples, after=samples, slowed=samples)[1] <= SEEDS / 20


def test_twice_the_time_is_found_from_7_samples_a_side(runs):
    found, alarms = gates(runs, 2.0, before=7, after=7, slowed=7)
    assert found >= 0.95 * SEEDS and alarms <= SEEDS / 20


def with_floor(side, number):
    """The run with a noise floor as real runs have it: 17 % in the median, 2 to 80 % in all but a few."""
    return replace(side, noise=float(0.17 * np.exp(0.75 * np.random.default_rng([number, 17]).standard_normal())))


@pytest.mark.parametrize(("factor", "least"), [(1.0, 0), (2.0, 0.95 * SEEDS)])
def test_wide_noise_floors_hide_nothing_that_the_cells_show(factor, least):
    """Each is of one pair of samples of one cell; the 28 cells show that the runs are 1 % apart."""
    runs = Runs(MACHINES["usual"], METHODS)
    runs.side, runs.slowed = (lambda seed, *given, made=made: with_floor(made(seed, *given), seed)
                              for made in (runs.side, runs.slowed))
    found, alarms = gates(runs, factor, before=7, after=7, slowed=7)
    assert found >= least and alarms <= SEEDS / 20


@pytest.mark.parametrize("factor", [10.0, 100.0])
@pytest.mark.parametrize("counts", [{"slowed": 1}, {"before": 1, "after": 1, "slowed": 1}],
                         ids=["one-sample-of-the-slow-cell", "one-sample-of-each"])
def test_10_and_100_times_the_time_are_always_found_from_one_sample(runs, factor, counts):
    found, alarms = gates(runs, factor, **counts)
    assert found == SEEDS and alarms <= SEEDS / 20


@pytest.mark.parametrize("samples", [1, 2, 5])
def test_100_times_the_time_is_slower_with_nothing_else_to_go_by(samples):
    old, new = (side([cell("a", [ms] * samples, {"depth_complexity": 16})], noise=None) for ms in (8.88, 888.0))
    (verdict,) = compare(old, new).verdicts
    assert verdict.verdict == SLOWER
    low, ratio, high = verdict.ratio
    assert 1 < low < 100 < high and ratio == pytest.approx(100)


def test_a_stall_tells_of_frames_as_long_as_it_was_found_in():
    """A stall of 5 ms is 10 times a frame of 0.5 ms, and a twentieth of one of 100 ms."""
    frames = Frames([[0.5] * 95 + [5.5] * 5, [100.0, 105.0] * 50])
    assert frames.deviation(0.5) > 0.5 and frames.burst(0.5) > 1.0
    for as_long_or_longer in (100.0, 5000.0):
        assert frames.deviation(as_long_or_longer) < 0.06 and frames.burst(as_long_or_longer) < 0.03


def test_a_stalled_frame_of_seven_does_not_hide_ten_times_the_time():
    """Under load: the interval of 7 frames reaches to the stalled one, the median of the others stands."""
    random = np.random.default_rng(1)
    old, new = ([cell(f"m{m}", (np.exp(0.03 * random.standard_normal(7)) * (1 + 4 * (np.arange(7) == m % 7))).tolist(),
                      {"depth_complexity": n}) for m in range(METHODS) for n in SCENES] for _ in range(2))
    new[3]["samples_ms"] = [10 * s for s in new[3]["samples_ms"]]
    called = [v.name for v in compare(side(old), side(new)).verdicts if v.verdict == SLOWER]
    assert called == ["m1, n 32"]


def test_shared_runs_are_the_runs_made_one_by_one():
    noisy = MACHINES["noisy"]
    for counts in ((MANY, MANY), (MANY, 1), (7, 7)):
        alone = run(noisy, 5, slower=3, factor=10.0, methods=METHODS, alone=32, counts=counts)
        shared = Runs(noisy, METHODS).slowed(5, 3, 32, 10.0, *counts)
        assert list(alone.entries) == list(shared.entries) and alone.noise == shared.noise
        for one, other in zip(alone.entries.values(), shared.entries.values(), strict=True):
            assert one.point.cell["samples_ms"] == pytest.approx(other.point.cell["samples_ms"], rel=1e-12)


def test_few_samples_are_not_called_the_same():
    old, new = (run(MACHINES["quiet"], seed, methods=METHODS, counts=(3, 3)) for seed in (1, 2))
    many = compare(run(MACHINES["quiet"], 1, methods=METHODS), run(MACHINES["quiet"], 2, methods=METHODS))
    assert compare(old, new).counts[SAME] < many.counts[SAME]


def test_cells_that_changed_do_not_hide_one_another():
    """A tenth of the cells 100 times slower is a change, not the length of the noise's tails."""
    shifts = [Shift("scene", i, 4.6 if i < 4 else 0.01 * ((7 * i) % 11 - 5) / 5, 0.003) for i in range(40)]
    assert estimate(shifts, 0.01).stretch == MOST_STRETCH
    quiet = MACHINES["quiet"]
    old, new = run(quiet, 1, methods=METHODS), run(quiet, 2, methods=METHODS)
    for entry in new.entries.values():
        if entry.point.method in ("m3", "m4"):
            entry.point.cell["samples_ms"] = [100 * entry.point.cell["samples_ms"][0]]
    slower = {v.after.point.method for v in compare(old, new).verdicts if v.verdict == SLOWER}
    assert slower == {"m3", "m4"}
