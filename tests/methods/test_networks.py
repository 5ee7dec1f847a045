"""Sorting networks merge any two sorted halves, bubble sorts in registers turn any order round, at every size."""

import numpy as np
import pytest

from mfr_bench.oracle.composite import composite
from mfr_bench.scene.quads import Quads

from .drawing import assert_shows, drawn, stack


def rotated(count: int) -> Quads:
    """A pixel for each place at which the first half of `count` fragments may begin among the depths of all.

    Each half arrives in order. By the 0-1 principle (Knuth 1998, §5.3.4) a merge that is right for all of them is right
    for any two sorted halves: every number of nearer ones in either half is met.
    """
    half, random = count // 2, np.random.default_rng(count)
    ranks = [rank for start in range(half + 1)
             for first in [range(start, start + half)] for rank in (*first, *sorted({*range(count)} - {*first}))]
    rect = [[x, 0, x + 1, 1] for x in range(half + 1) for _ in range(count)]
    rgba = np.column_stack([random.choice([0, 255], (len(ranks), 3)), random.integers(4, 12, len(ranks))])
    depth = ((np.array(ranks) + 1) / (count + 1)).astype(np.float32)
    return Quads((half + 1, 1), np.array(rect, dtype=np.int32), depth,
                 rgba.astype(np.uint8), 1.0, 0)


@pytest.mark.parametrize("count", [2, 4, 8, 16, 32, 64])
@pytest.mark.parametrize("method", ["ab-array", "adaptive"])
def test_a_network_merges_any_two_sorted_halves(device, method, count):
    scene = rotated(count)
    with drawn(device, method, scene) as frame:
        np.testing.assert_allclose(frame.image(), composite(scene), rtol=0, atol=2e-6)


@pytest.mark.parametrize("fault", ["DO(0, 63) ", "DO(15, 48) ", "DO(30, 33) "])
def test_a_missing_comparison_of_two_halves_is_seen(device, plant, fault):
    plant("common/network.glsl", fault, "")
    scene = rotated(64)
    with drawn(device, "adaptive", scene) as frame:
        assert np.abs(frame.image() - composite(scene)).max() > 2e-6


@pytest.mark.parametrize("count", [8, 16])
def test_a_bubble_sort_takes_as_many_rounds_as_an_order_reversed_needs(device, count):
    rgba = np.random.default_rng(count).integers(4, 40, (count, 4))
    with drawn(device, "ab-array", stack([(i + 1) / 20 for i in reversed(range(count))], rgba), sort="bubble") as frame:
        assert_shows(frame, rgba[::-1])


@pytest.mark.parametrize("count", [40, 64, 100])
@pytest.mark.parametrize(("method", "left_out"), [("ab-ll", 0), ("kb-ab-array", 4)])
def test_blocks_are_stored_where_they_belong_however_they_are_loaded(device, plant, method, left_out, count):
    """llvmpipe 22.3.6 stores them in the next one's place, if that is compared before (docs/drivers.md).

    A branch around the loads hides it, so that here they are behind none.
    """
    plant("common/resolve_register.glsl",
          "block##i = NO_FRAGMENT; \\\n    if (base + uint(i) < gathered) block##i = fragments[base + uint(i)];",
          "block##i = fragments[base + uint(i)]; \\\n    if (base + uint(i) >= gathered) block##i = NO_FRAGMENT;")
    random = np.random.default_rng(count)
    scene = stack(random.permutation(count) / 128, random.integers(4, 40, (count, 4)), size=(3, 2))
    with drawn(device, method, scene, sort="register", k=count - left_out) as frame:
        np.testing.assert_allclose(frame.image(), composite(scene, count - left_out), rtol=0, atol=1e-5)
