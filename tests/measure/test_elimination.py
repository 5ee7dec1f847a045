"""Elimination keeps the fastest method, drops the others early, and says how sure it is."""

import math
import random

import pytest

from mfr_bench.measure.elimination import CHANCE, HYPOTHESES, LEAST_ROUNDS, Elimination, evidence
from mfr_bench.stats import sampled_interval

MEDIANS = {f"m{i}": 1.0 * 1.15**i for i in range(12)} | {"slow": 8.0, "slowest": 100.0}


def noise(kind: str, pick: random.Random) -> float:
    """A factor with the median 1: what a frame's time is stretched by."""
    if kind == "lognormal":
        return math.exp(pick.gauss(0, 0.15))
    if kind == "bursts":  # one frame in thirty takes five times as long
        return math.exp(pick.gauss(0, 0.05)) * (5.0 if pick.random() < 1 / 30 else 1.0)
    return pick.choice((0.9, 1.0, 1.1))  # steps of a clock


def played(kind: str, seed: int, medians=MEDIANS, most: int = 200) -> tuple[Elimination, int]:
    """An elimination over noisy rounds, and how many frames it took."""
    pick, frames = random.Random(seed), 0  # noqa: S311 - noise, no secret
    found = Elimination(list(medians))
    while not found.decided and len(found.rounds) < most:
        drift = math.exp(0.3 * math.sin(len(found.rounds) / 9))  # of the whole machine: it hits all alike
        times = {m: medians[m] * drift * noise(kind, pick) for m in found.left}
        frames += len(times)
        found.add(times)
    return found, frames


@pytest.mark.parametrize("kind", ["lognormal", "bursts", "steps"])
def test_the_fastest_is_found_with_a_fraction_of_the_frames(kind):
    """Among 60 plays no more drop the fastest than a chance of 1 % explains; all 14 methods at 200 frames are 2,800."""
    plays = [played(kind, seed) for seed in range(60)]
    assert sum("m0" not in found.left for found, _ in plays) <= 3
    assert sum(found.leader == "m0" for found, _ in plays) >= 57
    assert max(frames for _, frames in plays) <= 0.25 * 2800


def test_the_fastest_of_equal_methods_is_hardly_ever_dropped():
    """All are alike, so that each is the fastest: the hardest case for the bound."""
    alike = dict.fromkeys(("a", "b", "c"), 1.0)
    drops = [d for seed in range(100) for d in played("lognormal", seed, alike, 60)[0].dropped]
    assert len(drops) <= 3 * 100 * CHANCE


def test_what_takes_many_times_as_long_leaves_after_a_few_frames():
    found, _ = played("lognormal", 1)
    left_after = {gone.method: gone.after_round for gone in found.dropped}
    assert left_after["slowest"] <= 3 and left_after["slow"] <= 4
    assert found.dropped[0].ratio > 2


def test_methods_within_two_percent_end_it():
    found, _ = played("lognormal", 3, {"a": 1.0, "b": 1.001}, most=5000)
    assert found.decided and len(found.left) == 2
    chances = found.chances()
    assert sum(chances.values()) == pytest.approx(1.0) and 0.02 < chances["a"] < 0.98


def test_a_single_round_makes_nothing_certain():
    found = Elimination(["a", "b", "c", "d"])
    found.add({"a": 1.0, "b": 1.5, "c": 1.6, "d": 1.7})
    assert found.chances() == pytest.approx({"a": 0.625, "b": 0.125, "c": 0.125, "d": 0.125})


def test_the_chance_follows_the_distance():
    near, _ = played("lognormal", 5, {"a": 1.0, "b": 1.3}, most=12)
    assert near.chances()["a"] > 0.8
    assert near.chances() == near.chances()


@pytest.mark.parametrize("share", [share for _, share in HYPOTHESES])
def test_evidence_is_a_supermartingale_under_its_hypothesis(share):
    """At the border of the hypothesis its expectation after a round is what it was before: Ville's inequality holds."""
    for rounds in (0, 1, 5, 20):
        for hits in range(0, rounds + 1, 3):
            before = math.exp(evidence(hits, rounds, share))
            after = (share * math.exp(evidence(hits + 1, rounds + 1, share))
                     + (1 - share) * math.exp(evidence(hits, rounds + 1, share)))
            assert after == pytest.approx(before)


def test_rounds_without_a_method_that_is_left_are_refused():
    found = Elimination(["a", "b"])
    with pytest.raises(ValueError, match="a time for each of a, b"):
        found.add({"a": 1.0})
    with pytest.raises(ValueError, match="each once"):
        Elimination(["a", "a"])


def test_one_method_draws_as_many_rounds_as_its_interval_needs():
    """Without a rival there is nothing to decide, but its time is told with an interval."""
    found = Elimination(["a"])
    for _ in range(LEAST_ROUNDS):
        assert not found.decided
        found.add({"a": 1.0})
    assert found.decided
    assert None not in sampled_interval([times["a"] for times in found.rounds])


def test_it_ends_once_no_method_is_two_percent_better_than_the_leader():
    """The second is slower by more than 2 %, but not by enough to leave: that it is no better ends the rounds."""
    plays = [played("lognormal", seed, {"a": 1.0, "b": 1.05}, most=5000)[0] for seed in range(20)]
    assert all(found.decided for found in plays) and any(len(found.left) == 2 for found in plays)
    assert sum(found.leader == "a" for found in plays) >= 19


def test_frames_that_stall_often_are_no_reason_to_leave_early():
    """The fastest of three is found although a frame in four takes five times as long."""
    rng = random.Random(8)  # noqa: S311 - as above
    found = 0
    for _ in range(60):
        race = Elimination(["fast", "slow", "slower"])
        for _ in range(200):
            if race.decided:
                break
            race.add({name: time_ms * rng.choice((1, 1, 1, 5)) * rng.lognormvariate(0, 0.1)
                      for name, time_ms in (("fast", 1.0), ("slow", 1.15), ("slower", 1.3)) if name in race.left})
        found += race.leader == "fast"
    assert found >= 59
