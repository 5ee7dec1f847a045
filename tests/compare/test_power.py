"""The verdicts of `compare` on planted runs: nothing of two runs of one thing, and a slowdown where there is one."""

import pytest

from mfr_bench.compare import compare
from mfr_bench.compare.judge import FASTER, SAME, SLOWER

from .planted import METHODS, Machine, run

# The deviation of the difference between two runs, 1.4 times the shift, is about the noise floor of the machine.
QUIET = Machine(cv=0.005, shift=0.004)
USUAL = Machine(cv=0.01, shift=0.006)
NOISY = Machine(cv=0.03, shift=0.02, load=0.2)
RUNS = 20


def called(found):
    return [v.name for v in found.verdicts if v.verdict in (FASTER, SLOWER)]


def alarms(machine, runs=RUNS):
    """Comparisons of two runs of one thing that report any difference."""
    return sum(bool(called(compare(run(machine, 2 * seed), run(machine, 2 * seed + 1)))) for seed in range(runs))


@pytest.mark.parametrize("tails", ["normal", "laplace", "t3", "bursts"])
@pytest.mark.parametrize("machine", [QUIET, USUAL, NOISY], ids=["quiet", "usual", "noisy"])
def test_two_runs_of_one_thing_differ_in_at_most_1_of_20(machine, tails):
    assert alarms(Machine(machine.cv, machine.shift, tails, machine.load)) <= 1


def found_slowdowns(machine, runs=RUNS):
    """Counts of comparisons where one method is 5 % slower and both noise floors are under 2 %: that find it, all."""
    found = total = 0
    for seed in range(runs):
        before, after = run(machine, 2 * seed), run(machine, 2 * seed + 1, slower=seed % METHODS, factor=1.05)
        if max(before.noise, after.noise) < 0.02:
            total += 1
            found += any(v.verdict == SLOWER and v.after.point.method == f"m{seed % METHODS}"
                         for v in compare(before, after).verdicts)
    return found, total


@pytest.mark.parametrize("tails", ["normal", "laplace", "t3"])
@pytest.mark.parametrize("machine", [QUIET, USUAL], ids=["quiet", "usual"])
def test_a_slowdown_of_5_percent_is_found_in_9_of_10_where_the_noise_floor_is_under_2(machine, tails):
    found, total = found_slowdowns(Machine(machine.cv, machine.shift, tails, machine.load))
    assert total >= RUNS / 2
    assert found >= 0.9 * total


def test_most_cells_of_a_quiet_machine_are_the_same():
    found = compare(run(QUIET, 1), run(QUIET, 2))
    assert found.counts[SAME] > 0.8 * len(found.verdicts)
