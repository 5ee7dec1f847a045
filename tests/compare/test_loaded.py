"""`compare` and the sampling that it relies on, on a machine that bursts of load slow down for milliseconds."""

import numpy as np
import pytest

from mfr_bench.compare import compare
from mfr_bench.compare.judge import FASTER, SLOWER
from mfr_bench.measure import sampling

from .loaded import METHODS, run
from .planted import SCENES

SEEDS = 50
HIT = 100  # the seed of a run whose bursts fall into the frames that are sampled twice: one in 60 is such a run


@pytest.fixture(scope="module")
def plain():
    """Runs with nothing slower."""
    return [run(seed) for seed in range(SEEDS)]


def called(before, after):
    """The cells that are called a change, as (method, layers, verdict)."""
    return {(v.after.point.method, v.after.point.cell["scene"]["depth_complexity"], v.verdict)
            for v in compare(before, after).verdicts if v.verdict in (SLOWER, FASTER)}


def alarms(runs):
    """The number of comparisons of neighbouring runs, in which nothing is slower, that call a change."""
    return sum(bool(called(before, after)) for before, after in zip(runs, [*runs[1:], runs[0]], strict=True))


def test_at_most_1_comparison_in_20_calls_a_change_that_is_none(plain):
    assert alarms(plain) <= SEEDS / 20


def test_samples_of_one_turn_would_raise_far_more_alarms(monkeypatch):
    """The bursts are such that they fill the first batch of a short frame, if that is drawn at one go."""
    monkeypatch.setattr(sampling, "TURNS", 1)
    assert alarms([run(seed) for seed in range(SEEDS)]) > 2 * SEEDS / 20


@pytest.mark.parametrize(("factor", "least"), [(2.0, 0.95), (10.0, 1.0), (100.0, 1.0)])
def test_a_slowdown_of_one_cell_is_found(plain, factor, least):
    found = others = 0
    for seed, before in enumerate(plain):
        method, layers = seed % METHODS, SCENES[seed % 2]
        changes = called(before, run(SEEDS + seed, method, layers, factor))
        found += (f"m{method}", layers, SLOWER) in changes
        others += bool(changes - {(f"m{method}", layers, SLOWER)})
    assert found >= least * SEEDS and others <= SEEDS / 20


def test_noise_floors_are_those_of_the_frames_in_most_runs_and_of_the_bursts_in_some(plain):
    assert np.median([side.noise for side in plain]) < 0.03
    assert run(HIT).noise > 0.2
