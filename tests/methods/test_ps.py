"""KB-PS: slots in order, ended by an empty one; equal depths."""

import numpy as np
import pytest

from mfr_bench.config import Scene as SceneConfig
from mfr_bench.oracle.composite import fragment_counts
from mfr_bench.scene import generate

from .drawing import assert_shows, drawn, stack

SCENE = generate(SceneConfig(size=(33, 21), depth_complexity=12, fragment_probability=0.6, seed=5))
EMPTY = 0xFFFFFFFF


@pytest.mark.parametrize("k", [1, 3, 12, 40])
@pytest.mark.parametrize("culling", ["on", "off"])
def test_slots_are_in_order_and_end_with_an_empty_one(device, k, culling):
    with drawn(device, "kb-ps", SCENE, frames=2, k=k, culling=culling) as frame:
        depths = frame.words("nodes").reshape(k, -1, 2)[..., 0]
        assert not frame.words("semaphore").any()
    assert (np.diff(depths.astype(np.int64), axis=0) >= 0).all()
    np.testing.assert_array_equal((depths != EMPTY).sum(axis=0), np.minimum(fragment_counts(SCENE).ravel(), k))


@pytest.mark.parametrize("k", [1, 2, 3, 8])
def test_equal_depths_are_all_kept(device, k):
    colours = [(50, 60, 70, 80)] * 3
    with drawn(device, "kb-ps", stack([0.5] * 3, colours), k=k) as frame:
        assert_shows(frame, colours[:k])
