"""The verdicts on pairs: a change of 5 % is found, and none where there is none, however the rounds scatter."""

import json
import math
import random
from dataclasses import replace

import pytest

from mfr_bench.compare import compare, present
from mfr_bench.compare.judge import Together
from mfr_bench.versus.judge import Judge, Ratio, between, centre, ratio_of, together
from mfr_bench.versus.lockstep import Half

from ..compare.planted import cell, side
from ..report.planted import spread

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


def rounds_of(rng: random.Random, moved: float, cells: int, own: float, common: float) -> list[Ratio]:
    """Cells whose ratios scatter by `own` from round to round, and by `common`, which all cells of a round share."""
    shared = [rng.gauss(moved, common) for _ in range(6)]
    return [Ratio(tuple(rng.gauss(middle, own) for middle in shared), own / math.sqrt(6)) for _ in range(cells)]


def test_a_change_of_all_cells_shows_together_where_none_of_them_shows_it():
    rng = random.Random(3)  # noqa: S311 - planted noise
    found = alone = 0
    for _ in range(100):
        ratios = dict(enumerate(rounds_of(rng, math.log(1.05), 8, own=0.05, common=0.005)))
        judge = Judge(ratios, 0.02, 1)
        found += judge.decided(together(list(ratios.values())))[0] == "SLOWER"
        alone += sum(judge.decided(ratio)[0] == "SLOWER" for ratio in ratios.values())
    assert found >= 85 and alone < 0.3 * 8 * 100


def test_what_the_cells_of_a_round_have_in_common_is_no_change():
    rng = random.Random(4)  # noqa: S311 - as above
    alarms = 0
    for _ in range(200):
        ratios = dict(enumerate(rounds_of(rng, 0.0, 8, own=0.01, common=0.03)))
        alarms += Judge(ratios, 0.02, 1).decided(together(list(ratios.values())))[0] in ("SLOWER", "FASTER")
    assert alarms <= 2


def test_a_change_together_is_a_regression_in_every_output():
    times = [cell(name, spread(1.0, 22, 0.004), {"depth_complexity": 16}) for name in ("a", "b")]
    found = replace(compare(side(times), side(times)),
                    together=(Together("all cells", "SLOWER", "", (1.03, 1.05, 1.07)),))
    assert found.regressed and json.loads(present.as_json(found))["together"][0]["verdict"] == "SLOWER"
    assert "SLOWER together: all cells" in present.as_text(found, 100)
    assert "1.050 [1.030, 1.070] |" in present.as_markdown(found)
    case, = (case for case in present.as_cases(found) if case.name == "all cells")
    assert case.outcome == "failure"


def test_cells_that_miss_a_round_are_left_out_of_what_is_judged_together():
    whole, half = Ratio((0.0, 0.1), 0.01), Ratio((0.5,), 0.01)
    assert together([whole, whole, half]) == Ratio((0.0, 0.1), pytest.approx(0.01 / math.sqrt(2)), 2)
    assert together([whole, half]) is None and together([]) is None


def test_the_centre_of_ratios_is_the_median_of_the_means_of_two():
    assert centre([0.1]) == 0.1
    assert centre([0.0, 0.1, 0.2, 0.1, 9.0]) == pytest.approx(0.15)
    assert centre([0.0, 1.0, 2.0, 3.0]) == 1.5


def test_cells_without_a_time_are_unclear():
    half = Half({}, rounds_ms=[[[0.0]], [[0.0]]])
    assert ratio_of(half, half) is None
    assert Judge({}, 0.02).decided(None)[0] == "UNCLEAR"
    assert between([]) == 0.0
