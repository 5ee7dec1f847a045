"""Two calibrations of one run, and what is said where they differ."""

import pytest

from mfr_bench.measure.calibration import disagreement

START = {"timer": "wall", "wall_ms": (1.0, 2.0, 4.0, 8.0), "gpu_ms": (0.1, 0.2, 0.4, 0.8)}


@pytest.mark.parametrize(("end", "said"), [
    ({}, None), ({"wall_ms": (9.0, 2.2, 4.2, 8.1)}, None),  # the first took under 2 ms
    ({"wall_ms": (1.0, 2.6, 5.2, 10.4)}, "1.3 times as long"), ({"wall_ms": (1.0, 1.0, 2.0, 4.0)}, "0.5 times as long"),
    ({"gpu_ms": (9.0, 9.0, 9.0, 9.0)}, None),  # a timer that is not used
    ({"timer": "gpu"}, "at the start the wall timer was to be trusted, at the end the gpu timer"),
    ({"wall_ms": (1.0,)}, None)])
def test_it_says_by_how_much_work_of_known_size_changed(end, said):
    found = disagreement(START, START | end)
    assert found is None if said is None else said in found
