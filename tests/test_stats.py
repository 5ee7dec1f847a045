"""Medians and their intervals, against scipy's binomial distribution."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mfr_bench.stats import interval_rank, median_interval, ratio_interval

samples = st.lists(st.floats(1e-6, 1e6), min_size=1, max_size=60)


@pytest.mark.parametrize("confidence", [0.9, 0.95, 0.975, 0.99])
def test_ranks_are_the_narrowest_that_reach_the_confidence(confidence):
    binom = pytest.importorskip("scipy.stats").binom
    for count in [*range(1, 120), 500, 1000, 1201]:
        rank = interval_rank(count, confidence)
        coverage = [1 - 2 * binom.cdf(r - 1, count, 0.5) for r in range(1, count // 2 + 1)]
        expected = [r for r, c in enumerate(coverage, 1) if c >= confidence - 1e-12]
        assert rank == max(expected, default=None), count


def test_ten_samples_span_ranks_two_to_nine():
    assert median_interval(range(10, 0, -1)) == (2, 5.5, 9)


@pytest.mark.parametrize("count", [1, 2, 5])
def test_fewer_than_six_samples_have_no_interval(count):
    low, median, high = median_interval(range(count))
    assert (low, high) == (None, None)
    assert median == (count - 1) / 2


def test_six_samples_are_enough():
    assert median_interval([6, 5, 4, 3, 2, 1]) == (1, 3.5, 6)


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


def test_a_ratio_needs_seven_samples_on_both_sides():
    assert ratio_interval([2.0] * 7, [1.0] * 7) == (2, 2, 2)
    assert ratio_interval([2.0] * 7, [1.0] * 6) == (None, 2, None)
    assert ratio_interval([], [1.0] * 7) == (None, None, None)
