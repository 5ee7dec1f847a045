"""Scenes that put methods under stress hold what the config asks for."""

import numpy as np
import pytest

from mfr_bench.config.model import Scene as SceneConfig
from mfr_bench.oracle.composite import composite, fragment_counts, stats_of
from mfr_bench.scene import generate

BASE = {"size": (9, 6), "depth_complexity": 8, "seed": 3}


@pytest.mark.parametrize(("at", "gap", "low"), [(0.0, -4, 0.0), (0.0, -126, 0.0), (0.5, -24, 0.5 - 2**-22),
                                                (0.5, -4, 0.25), (1.0, -24, 1 - 7 * 2**-24)])
def test_depths_lie_in_equal_steps(at, gap, low):
    depth = np.sort(generate(SceneConfig(**BASE, depth_at=at, depth_gap_log2=gap)).depth.astype(np.float64))
    assert depth[0] == low
    assert set(np.diff(depth)) == {2.0**gap}


def test_submission_order_follows_the_depths():
    for order, sign in (("front_to_back", 1), ("back_to_front", -1)):
        made = generate(SceneConfig(**BASE, depth_at=0.5, depth_gap_log2=-20, order=order))
        assert (sign * np.diff(made.depth) > 0).all()


@pytest.mark.parametrize(("copies", "colours"), [("alike", 3), ("different", 8)])
def test_copies_share_their_depth(copies, colours):
    made = generate(SceneConfig(**BASE, depth_copies=3, copies=copies))
    _, found = np.unique(made.depth, return_counts=True)
    assert found.tolist() == [3, 3, 2]
    assert len(np.unique(made.rgba, axis=0)) == colours


def test_alphas_fall_or_rise_with_depth():
    for order, sign in (("falling", -1), ("rising", 1)):
        made = generate(SceneConfig(**BASE, alpha_order=order, alpha=(0.1, 0.9)))
        assert (sign * np.diff(made.rgba[made.depth_order, 3].astype(int)) >= 0).all()


@pytest.mark.parametrize(("odd", "seen"), [("zero", True), ("minus_zero", True), ("one", True), ("below", False),
                                           ("beyond", False), ("far_below", False), ("far_beyond", False),
                                           ("infinity", False), ("minus_infinity", False), ("nan", False)])
def test_what_gl_clips_gives_no_fragments(odd, seen):
    made = generate(SceneConfig(**BASE, odd_depth=odd))
    assert stats_of(made).n == 7 + seen
    assert (fragment_counts(made) == 7 + seen).all()


def test_an_overhang_changes_nothing_that_is_seen():
    plain, wide = (generate(SceneConfig(**BASE, overhang=overhang)) for overhang in (0, 2**24))
    assert wide.rect.min() == -2**24
    assert np.array_equal(composite(plain), composite(wide))


def test_alpha_may_be_none_at_all():
    assert not composite(generate(SceneConfig(**BASE, alpha=(0.0, 0.0)))).any()
