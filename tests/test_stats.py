"""Medians and their intervals, against scipy's binomial distribution."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mfr_bench.stats import (
    apart,
    goals,
    interleaved_ratio,
    interval_position,
    median_interval,
    ratio_interval,
    sampled_interval,
    t_quantile,
    turns,
)

samples = st.lists(st.floats(1e-6, 1e6), min_size=1, max_size=60)


@pytest.mark.parametrize("confidence", [0.9, 0.95, 0.975, 0.99])
def test_the_position_lies_between_the_last_rank_that_reaches_the_confidence_and_the_next(confidence):
    binom = pytest.importorskip("scipy.stats").binom
    for count in [*range(1, 120), 500, 1000, 1201]:
        reached = [r for r in range(1, count // 2 + 1)
                   if 1 - 2 * binom.cdf(r - 1, count, 0.5) >= confidence - 1e-12]
        position = interval_position(count, confidence)
        assert (position is None) == (not reached), count
        if position is not None:
            assert max(reached) <= position <= max(reached) + 1, count


@pytest.mark.parametrize("count", [10, 15, 22, 33, 49, 100])
def test_the_interpolated_interval_holds_the_median_of_a_normal_as_often_as_it_says(count):
    """In 20,000 fixed draws, whose own error is 0.15 %."""
    numpy = pytest.importorskip("numpy")
    ordered = numpy.sort(numpy.random.default_rng(count).standard_normal((20000, count)), axis=1)
    position = interval_position(count)
    rank, share = int(position), position % 1
    low = (1 - share) * ordered[:, rank - 1] + share * ordered[:, rank]
    high = (1 - share) * ordered[:, count - rank] + share * ordered[:, count - rank - 1]
    assert 0.945 <= ((low <= 0) & (high >= 0)).mean() <= 0.955


def test_ten_samples_reach_between_ranks_two_and_three():
    low, middle, high = median_interval(range(10, 0, -1))
    assert 2 < low < 3 and middle == 5.5 and high == pytest.approx(11 - low)


@pytest.mark.parametrize("count", [1, 2, 5])
def test_fewer_than_six_samples_have_no_interval(count):
    low, median, high = median_interval(range(count))
    assert (low, high) == (None, None)
    assert median == (count - 1) / 2


def test_six_samples_are_enough():
    low, middle, high = median_interval([6, 5, 4, 3, 2, 1])
    assert 1 < low < 2 and middle == 3.5 and 5 < high < 6


def test_no_samples_have_no_median():
    assert median_interval([]) == (None, None, None)


@pytest.mark.parametrize("value", [math.nan, math.inf])
def test_a_sample_that_is_not_finite_is_refused(value):
    with pytest.raises(ValueError, match="finite"):
        median_interval([1.0, value])


@given(samples)
def test_the_median_lies_within_its_interval(values):
    low, median, high = median_interval(values)
    assert min(values) <= median <= max(values)
    if low is not None:
        assert low <= median <= high


@given(samples, st.floats(0.1, 10))
def test_scaling_the_samples_scales_the_ratio(values, factor):
    low, ratio, high = ratio_interval([v * factor for v in values], values)
    assert ratio == pytest.approx(factor)
    if low is not None:
        assert low <= ratio * (1 + 1e-9) and ratio <= high * (1 + 1e-9)


def test_a_ratio_needs_six_samples_on_both_sides():
    assert ratio_interval([2.0] * 6, [1.0] * 6) == (2, 2, 2)
    assert ratio_interval([2.0] * 6, [1.0] * 5) == (None, 2, None)
    assert ratio_interval([], [1.0] * 6) == (None, None, None)


@given(samples)
def test_samples_that_lean_on_their_neighbours_are_worth_less(values):
    """Sorted, as under a drift, the same samples have no narrower interval than without regard to their order."""
    low, _, high = median_interval(values, 0.96)
    drifted = sampled_interval(sorted(values))
    if low is not None:
        assert drifted[0] <= low and high <= drifted[2]


@pytest.mark.parametrize(("least", "most", "expected"), [
    (10, 60, [10, 15, 22, 33, 49, 60]), (1, 5, [1, 2, 3, 4, 5]), (7, 7, [7]), (10, 8, [8])])
def test_looks_grow_by_half(least, most, expected):
    assert list(goals(least, most)) == expected


def test_what_slows_both_down_alike_leaves_their_ratio():
    """The batch of 5 at twice the time: the interval of the ratio does not notice."""
    wave = [1 + 0.01 * ((7 * i) % 10 - 4.5) / 4.5 for i in range(15)]
    load = [1.0] * 10 + [2.0] * 5
    over = [3 * w * slow for w, slow in zip(wave, load, strict=True)]
    under = [w * slow for w, slow in zip(reversed(wave), load, strict=True)]
    apart, together = ratio_interval(over, under), interleaved_ratio(over, under, 10, 100)
    assert together[0] < 3 < together[2]
    assert together[2] - together[0] < 0.12
    assert apart[2] - apart[0] > 1


def test_samples_without_a_counterpart_are_left_out():
    assert interleaved_ratio([2.0] * 10 + [9.0] * 90, [1.0] * 10, 10, 100) == (2, 2, 2)
    assert interleaved_ratio([], [1.0] * 6, 10, 100) == interleaved_ratio([1.0] * 6, [0.0] * 6, 10, 100)


@pytest.mark.parametrize("confidence", [0.5, 0.9, 0.95, 0.975, 0.99])
def test_quantiles_of_t_are_those_of_scipy_to_a_hundredth(confidence):
    t = pytest.importorskip("scipy.stats").t
    for freedom in (1, 1.1, 1.37, 2, 2.5, 4, 7.3, 30, 300):
        assert t_quantile(freedom, confidence) == pytest.approx(t.ppf((1 + confidence) / 2, freedom), rel=0.01)


@pytest.mark.parametrize(("count", "least", "sizes"), [
    (10, 10, [4, 4, 2]), (15, 10, [4, 4, 2, 2, 2, 1]), (7, 7, [3, 3, 1]), (5, 10, [4, 1]), (0, 10, []),
    (4, 1, [1, 1, 1, 1])])
def test_a_batch_takes_three_turns(count, least, sizes):
    """Turns are as a sampler asks for them: a third of the batch, rounded up, and last what is left of it."""
    assert [len(range(count)[place]) for place in turns(count, least, 1000)] == sizes


def test_a_stalled_turn_leaves_the_ratio_and_few_turns_have_a_wider_interval():
    quiet = [1 + 0.01 * ((7 * i) % 10 - 4.5) / 4.5 for i in range(22)]
    stalled = [8 * ms if 4 <= i < 8 else ms for i, ms in enumerate(quiet)]
    low, middle, high = interleaved_ratio(stalled, quiet[::-1], 10, 1000)
    assert middle == pytest.approx(1, abs=0.01) and low < 1 < high < 1.1
    few = interleaved_ratio(stalled[:10], quiet[::-1][:10], 10, 1000)
    assert few[1] == pytest.approx(1, abs=0.02) and few[2] > 8
    assert interleaved_ratio(quiet[:5], quiet[:5], 10, 1000)[::2] == (None, None)


@pytest.mark.parametrize("count", [12, 22])
def test_two_of_one_thing_are_as_far_apart_as_the_furthest_of_few_turns(count):
    """Two or three turns say nothing of how their ratios are distributed: no interval of thousands of percent."""
    first = turns(count, 22, 100)[0].stop
    one, other = [1.0] * count, [1.3] * first + [1.02] * (count - first)
    assert apart(other, one, 22, 100) == pytest.approx(0.3)
    assert apart(one, other, 22, 100) == pytest.approx(1 - 1 / 1.3)


def test_of_six_turns_they_are_as_far_apart_as_the_end_of_their_interval():
    one, other = [1.0] * 33, [1.3] * 8 + [1.02] * 25
    low, _, high = interleaved_ratio(other, one, 22, 100)
    assert apart(other, one, 22, 100) == pytest.approx(max(high - 1, 1 - low)) and 1.02 < high < 1.3


def test_too_few_samples_are_not_told_to_be_apart():
    assert apart([1.0] * 5, [1.2] * 5, 22, 100) is None
    assert apart([], [], 22, 100) is None
