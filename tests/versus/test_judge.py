"""The verdicts on pairs: a change of 5 % is found, and none where there is none, however the rounds scatter."""

import math
import random

import pytest

from mfr_bench.versus.judge import Judge, Ratio, between, ratio_of
from mfr_bench.versus.lockstep import Half

ROUNDS, PAIRS = 3, 60
NOISE = 0.08  # of a pair's ratio, as on llvmpipe with five processes on each core


def halves(rng: random.Random, factor: float, scatter: float = 0.005) -> tuple[Half, Half]:
    """A cell whose time changed by a factor; each round moves by itself, and a load hits both batches of a pair."""
    before, after = Half({}), Half({})
    for _ in range(ROUNDS):
        moved = factor * math.exp(rng.gauss(0, scatter))
        loads = [rng.choice((1, 1, 3)) for _ in range(PAIRS)]
        before.rounds_ms.append([[load * math.exp(rng.gauss(0, NOISE / math.sqrt(2))) for load in loads]])
        after.rounds_ms.append([[load * moved * math.exp(rng.gauss(0, NOISE / math.sqrt(2))) for load in loads]])
    return before, after


def verdicts(rng: random.Random, factors) -> list[str]:
    ratios = {number: ratio_of(*halves(rng, factor)) for number, factor in enumerate(factors)}
    judge = Judge(ratios, 0.02)
    return [judge.decided(ratio)[0] for ratio in ratios.values()]


def test_five_percent_are_found():
    rng = random.Random(1)  # noqa: S311 - planted noise
    found = [verdicts(rng, [1.05, 1, 1, 1, 1, 1])[0] for _ in range(60)]
    assert found.count("SLOWER") >= 54
    assert "FASTER" not in found


def test_nothing_is_found_where_nothing_changed():
    rng = random.Random(2)  # noqa: S311 - as above
    alarms = sum(not {"SLOWER", "FASTER"}.isdisjoint(verdicts(rng, [1.0] * 20)) for _ in range(120))
    assert alarms <= 3


def test_one_round_that_went_another_way_decides_nothing():
    """A burst that outlasts a round of one cell moves its mean, and its other rounds do not agree."""
    ratios = {number: Ratio((0.001, -0.001, 0.0), 0.001) for number in range(20)}
    ratios[0] = Ratio((0.2, 0.001, 0.0), 0.001)
    verdict, reason, _, _ = Judge(ratios, 0.02).decided(ratios[0])
    assert verdict == "UNCLEAR" and "rounds differ" in reason


def test_what_is_alike_is_called_the_same():
    ratios = {number: Ratio((0.001, -0.001, 0.0), 0.001) for number in range(20)}
    verdict, _, (low, ratio, high), raw = Judge(ratios, 0.02).decided(ratios[0])
    assert verdict == "SAME"
    assert low < ratio < high and raw == ratio == pytest.approx(1.0)


def test_cells_without_a_time_are_unclear():
    half = Half({}, rounds_ms=[[[0.0]], [[0.0]]])
    assert ratio_of(half, half) is None
    assert Judge({}, 0.02).decided(None)[0] == "UNCLEAR"
    assert between([]) == 0.0
