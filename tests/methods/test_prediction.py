"""The choice of k against a direct computation over every k."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mfr_bench.methods.shared.prediction import BINS, fragments_in, largest_k, predict_k

histograms = st.lists(st.integers(0, 1000), max_size=40)


def kept_by_k(counts: list[int]) -> np.ndarray:
    """Fragments kept by 1, 2, … BINS layers."""
    k = np.arange(1, BINS + 1)
    return np.minimum(k[:, None], np.arange(1, len(counts) + 1)[None, :]) @ np.array(counts, dtype=np.int64)


@given(histograms, st.floats(0.01, 0.999), st.floats(-10, 30000))
def test_smallest_k_for_the_ratio_within_the_room(counts, hit_ratio, room):
    fragments = sum((i + 1) * pixels for i, pixels in enumerate(counts))
    kept = kept_by_k(counts)
    allowed = max(1, int(np.count_nonzero(kept <= room)))  # kept never falls with k
    enough = int(np.argmax(kept >= hit_ratio * fragments)) + 1
    choice = predict_k(counts, fragments, hit_ratio, room)
    assert choice.k == (min(allowed, enough) if fragments else 1)
    assert choice.capacity == kept[choice.k - 1]


@pytest.mark.parametrize(("hit_ratio", "room", "k"), [
    (0.999, 1e9, 4), (0.7, 1e9, 2), (0.71, 1e9, 3), (0.3, 1e9, 1), (0.999, 89, 2), (0.999, 90, 3), (0.999, 0, 1)])
def test_by_hand(hit_ratio, room, k):
    """10 pixels each of 1, 2, 3 and 4 fragments: 1 to 4 layers keep 40, 70, 90 and 100 of 100."""
    assert predict_k([10, 10, 10, 10], 100, hit_ratio, room).k == k


def test_an_empty_frame_keeps_one_layer():
    assert predict_k([], 0, 0.95, 1e9) == predict_k([0, 0], 0, 0.95, 1e9)
    assert predict_k([], 0, 0.95, 1e9).k == 1


def test_deeper_pixels_count_in_the_last_bin():
    """A pixel of 3000 fragments is one of at least BINS for any k that is allowed."""
    assert predict_k([0] * (BINS - 1) + [1], 3000, 0.3, 1e9).k == 900
    assert predict_k([0] * (BINS - 1) + [1], 3000, 0.9, 1e9).k == BINS


def test_room_is_what_the_pixels_leave():
    """200 MiB at 1024 x 1024 with 12 bytes a pixel and 8 a fragment: 188 MiB, 23.5 fragments a pixel."""
    assert fragments_in(200, 1024**2, 8, 12) == 23.5 * 1024**2


@pytest.mark.parametrize(("size", "pixel_bytes", "k"), [
    ((1024, 768), 8, 32), ((1024, 1024), 8, 24), ((1024, 768), 4, 32), ((16384, 16384), 8, 1)])
def test_the_most_slots_of_a_budget(size, pixel_bytes, k):
    """kplus_2015 §4.2: 200 MB result in k_b = 32 by Eq. 5, with 2k + 2 words at 1024 x 768."""
    assert largest_k(200, size[0] * size[1], 8, pixel_bytes) == k


@given(histograms, st.floats(0.01, 0.999), st.integers(1, 60))
def test_k_is_bounded_by_the_slots_of_a_budget(counts, hit_ratio, most):
    fragments = sum((i + 1) * pixels for i, pixels in enumerate(counts))
    free = predict_k(counts, fragments, hit_ratio, float("inf")).k
    assert predict_k(counts, fragments, hit_ratio, float("inf"), most).k == min(free, most)
