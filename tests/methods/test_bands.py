"""Bands of a frame: together all that has fragments, none with more than there is room for."""

import numpy as np
import pytest

from mfr_bench.errors import CapacityError
from mfr_bench.methods.shared.bands import SEGMENT, bands

WIDTH, HEIGHT = 100, 9
WHOLE = (0, 0, WIDTH, HEIGHT)
MOST = 20  # fragments of a pixel


def counted(seed: int) -> np.ndarray:
    """Fragments of each pixel, of which some rows have none."""
    random = np.random.default_rng(seed)
    return random.integers(0, MOST + 1, (HEIGHT, WIDTH)) * random.integers(0, 2, (HEIGHT, 1))


def summed(counts: np.ndarray) -> np.ndarray:
    edges = range(0, WIDTH, SEGMENT)
    return np.stack([counts[:, x:x + SEGMENT].sum(axis=1) for x in edges], axis=1)


@pytest.mark.parametrize("room", [SEGMENT * MOST, WIDTH * MOST, 3 * WIDTH * MOST, WIDTH * HEIGHT * MOST])
@pytest.mark.parametrize("region", [WHOLE, (4, 2, 72, 5), (36, 0, 8, 9)])
@pytest.mark.parametrize("seed", range(5))
def test_every_pixel_with_fragments_is_in_one_band_that_fits(seed, region, room):
    left, bottom, columns, rows = region
    counts = np.zeros((HEIGHT, WIDTH), dtype=np.int64)
    inside = np.s_[bottom:bottom + rows, left:left + columns]
    counts[inside] = counted(seed)[inside]
    times, outside = np.zeros_like(counts), np.ones_like(counts)
    outside[inside] = 0
    for x, y, width, height in bands(summed(counts), region, room):
        times[y:y + height, x:x + width] += 1
        assert 0 < counts[y:y + height, x:x + width].sum() <= room
    assert times.max(initial=0) <= 1
    assert (times[counts > 0] == 1).all()
    assert (times * outside == 0).all()


def test_there_are_no_more_bands_than_needed():
    even = np.full((HEIGHT, 4), 10)
    assert list(bands(even, WHOLE, 9 * 40)) == [WHOLE]
    assert list(bands(even, WHOLE, 5 * 40)) == [(0, 0, WIDTH, 5), (0, 5, WIDTH, 4)]
    assert [b[2:] for b in bands(even, WHOLE, 20)] == [(64, 1), (36, 1)] * HEIGHT


def test_a_frame_without_fragments_has_no_bands():
    assert list(bands(np.zeros((HEIGHT, 4)), WHOLE, 1)) == []


def test_a_segment_that_does_not_fit_is_told_with_its_number():
    sums = np.full((HEIGHT, 4), 10)
    sums[3, 2] = 70
    with pytest.raises(CapacityError, match=r"70 fragments of 32 pixels in row 3 do not fit: .* room for 69"):
        list(bands(sums, WHOLE, 69))
