"""`compare`, and the watched turns that it relies on, where a machine's host slows it down for seconds at a time."""

import pytest

from mfr_bench.compare import compare
from mfr_bench.compare.judge import FASTER, SLOWER

from .planted import SCENES
from .spells import METHODS, run

SEEDS = 50
WAIT_S = 20.0


@pytest.fixture(scope="module")
def plain():
    """Runs with nothing slower."""
    return [run(seed, wait_s=WAIT_S) for seed in range(SEEDS)]


def called(before, after):
    """The cells that are called a change, as (method, layers, verdict)."""
    return {(v.after.point.method, v.after.point.cell["scene"]["depth_complexity"], v.verdict)
            for v in compare(before, after).verdicts if v.verdict in (SLOWER, FASTER)}


def test_at_most_1_comparison_in_20_calls_a_change_that_is_none(plain):
    assert sum(bool(called(*sides)) for sides in zip(plain, [*plain[1:], plain[0]], strict=True)) <= SEEDS / 20


def test_twice_the_time_is_found_where_slow_turns_are_taken_again(plain):
    """Without waiting it is found in two of three comparisons."""
    found = others = 0
    for seed, before in enumerate(plain):
        method, layers = seed % METHODS, SCENES[seed % 2]
        changes = called(before, run(SEEDS + seed, method, layers, 2.0, WAIT_S))
        found += (f"m{method}", layers, SLOWER) in changes
        others += bool(changes - {(f"m{method}", layers, SLOWER)})
    assert found >= 0.9 * SEEDS and others <= SEEDS / 20
