"""The reference frame is drawn beside other frames, and changes none of them."""

from __future__ import annotations

import numpy as np

from mfr_bench.config.model import Scene as SceneConfig
from mfr_bench.gpu.probes import ProbeBench
from mfr_bench.gpu.reference import TRIES, ReferenceFrame
from mfr_bench.methods import catalog


def test_it_takes_time_and_leaves_the_frames_of_a_method_as_they_are(device):
    reference = ReferenceFrame(device)
    with ProbeBench(device, SceneConfig(size=(24, 20), depth_complexity=3)) as bench:
        frame = bench.frame(catalog()["ab-array"])
        frame.draw_fitting()
        before = frame.image()
        assert 0 < reference() < 10_000
        frame.draw()
        assert np.array_equal(frame.image(), before)
        frame.release()


def test_it_is_the_shortest_of_a_few(device, monkeypatch):
    times_ms = iter([3.0, 1.0, 2.0, 4.0][:TRIES])
    reference = ReferenceFrame(device)
    monkeypatch.setattr(reference, "_once", lambda: next(times_ms))
    assert reference() == 1.0
