"""KB-LL: the lists that it leaves in memory, and equal depths. Lost swaps need threads in flight at one pixel."""

import numpy as np
import pytest

from mfr_bench.config import Scene as SceneConfig
from mfr_bench.methods.spec import Fitted
from mfr_bench.oracle.composite import composite, fragment_counts
from mfr_bench.scene import generate

from .drawing import assert_shows, drawn, stack

SCENE = generate(SceneConfig(size=(33, 21), depth_complexity=12, fragment_probability=0.6, seed=5))
EMPTY = 0xFFFFFFFF


def listed(frame, pixel: int) -> list[int]:
    """Depth bits from the head to the tail, sentinels left out."""
    following, depths = frame.words("next"), frame.words("cells")[::2]
    found, node = [], following[pixel]
    while following[node] != EMPTY:
        found.append(int(depths[node]))
        node = following[node]
    assert node == frame.stats.P + pixel
    assert depths[node] == EMPTY
    return found


@pytest.mark.parametrize("k", [1, 3, 12, 40])
def test_lists_are_in_order_and_hold_the_nearest(device, k):
    counts = fragment_counts(SCENE).ravel()
    with drawn(device, "kb-ll", SCENE, frames=2, k=k) as frame:
        assert frame.words("cell_counter")[0] == counts.sum()  # every fragment takes a cell
        lists = [listed(frame, p) for p in range(0, len(counts), 37)]
        lost = frame.lost_fragments()
        error = np.abs(frame.image() - composite(SCENE, k)).max()
    assert all(found == sorted(found) for found in lists)
    if not lost:
        assert all(len(found) >= min(k, counts[37 * i]) for i, found in enumerate(lists))
        assert error < 1e-4


def test_words_per_pixel_are_the_papers(device):
    with drawn(device, "kb-ll", SCENE) as frame:
        cells = Fitted(frame.variant, frame.stats).capacity()
        assert sum(frame.memory_bytes.values()) == 4 * (3 * cells + 6 * frame.stats.P + 1)


@pytest.mark.parametrize("k", [1, 2, 3, 8])
def test_equal_depths_are_all_kept(device, k):
    colours = [(50, 60, 70, 80)] * 3
    with drawn(device, "kb-ll", stack([0.5] * 3, colours), k=k) as frame:
        assert_shows(frame, colours[:k])


def test_depths_0_and_1_lie_between_the_sentinels(device):
    colours = [(1, 2, 3, 100), (200, 150, 100, 60), (9, 99, 199, 140)]
    with drawn(device, "kb-ll", stack([1.0, 0.0, 0.5], colours), k=3) as frame:
        assert_shows(frame, [colours[i] for i in (1, 2, 0)])
