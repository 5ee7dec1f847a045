"""Noise of few samples: the frames of all cells that tell of one, found without a look at each."""

import numpy as np
import pytest

from mfr_bench.compare.few import WaveletMatrix


@pytest.mark.parametrize("count", [1, 2, 3, 8, 9, 100])
def test_the_least_of_the_last_numbers_are_those_of_a_sorted_list(count):
    numbers = np.random.default_rng(count).permutation(count)
    found = WaveletMatrix(numbers)
    for last in range(1, count + 1):
        assert [found.least(last, k) for k in range(last)] == sorted(numbers[count - last:])
