"""The reference frame is drawn beside other frames, and changes none of them."""

from __future__ import annotations

import math

import numpy as np
import pytest

from mfr_bench.config.model import Scene as SceneConfig
from mfr_bench.gpu.probes import ProbeBench
from mfr_bench.gpu.reference import TRIES, ReferenceFrame, shortest_ms
from mfr_bench.methods import catalog


def test_it_takes_time_and_leaves_the_frames_of_a_method_as_they_are(device):
    reference = ReferenceFrame(device)
    with ProbeBench(device, SceneConfig(size=(24, 20), depth_complexity=3)) as bench:
        frame = bench.frame(catalog()["ab-array"])
        frame.draw_fitting()
        before = frame.image()
        assert 0 < reference(math.inf) < 10_000
        frame.draw()
        assert np.array_equal(frame.image(), before)
        frame.release()


@pytest.mark.parametrize(("best_ms", "drawn_ms", "found_ms"), [
    (math.inf, [3.0, 1.0, 2.0, 4.0], 1.0),  # none is like another: the shortest of all
    (1.0, [1.5, 1.2, 1.3, 1.2], 1.2),
    (math.inf, [2.0, 1.0, 1.04], 1.0),  # two are alike
    (1.0, [2.0, 2.05], 2.0),  # in a slow spell, too
    (1.0, [1.09], 1.09),  # hardly longer than ever
    (1.0, [1.8, 0.9], 0.9),
])
def test_no_more_frames_are_drawn_than_tell_the_shortest_from_one_that_was_held_up(best_ms, drawn_ms, found_ms):
    times_ms = iter(drawn_ms)
    assert len(drawn_ms) <= TRIES and shortest_ms(lambda: next(times_ms), best_ms) == found_ms
    assert list(times_ms) == []
