"""Bucket peeling: whatever the depths, nothing is lost in a crowded bucket, and few passes suffice where none is."""

import numpy as np
import pytest

from mfr_bench.oracle.composite import composite
from mfr_bench.store.status import EXACT_ERROR

from .drawing import chosen, drawn, stack

STEP = 2.0**-23
NEIGHBOURS = 0.75 + STEP * np.arange(12)  # depths with no float between them


def peel(device, scene, **params):
    with drawn(device, "peel-bucket", scene, **params) as frame:
        return frame.image(), frame.geometry_passes


def shuffled(depths):
    return np.random.default_rng(5).permutation(depths)


@pytest.mark.parametrize("depths", [
    [0.5], [0.25, 0.5], NEIGHBOURS, [*NEIGHBOURS, STEP], [*NEIGHBOURS, 1 - STEP], np.linspace(STEP, 1 - STEP, 33),
    2.0 ** -np.arange(1, 20), [0.0, 0.5, 1.0],
], ids=["one", "two", "adjacent", "one in front", "one behind", "even", "ever nearer", "at both planes"])
@pytest.mark.parametrize("buckets", [1, 3, 8])
def test_exact_for_any_depths(device, depths, buckets):
    scene = stack(shuffled(depths))
    image, _ = peel(device, scene, buckets=buckets)
    assert np.abs(image - composite(scene)).max() <= EXACT_ERROR


def test_two_fragments_of_each_bucket_per_pass(device):
    """16 evenly spread fragments fill 8 buckets with two each: bounds, edges, colours."""
    assert peel(device, stack(np.linspace(0.1, 0.9, 16)))[1] == 3


def test_a_crowded_bucket_is_peeled_to_the_end(device):
    """All but one in the first bucket, two per pass."""
    assert peel(device, stack(shuffled([*NEIGHBOURS, 1 - STEP])))[1] == 1 + 1 + len(NEIGHBOURS) // 2


def test_of_equal_depths_one_is_kept(device):
    scene = stack([0.5, 0.25, 0.5])
    image, _ = peel(device, scene)
    kept = [composite(chosen(scene, quads)) for quads in ([0, 1], [1, 2])]
    assert min(np.abs(image - expected).max() for expected in kept) <= EXACT_ERROR
