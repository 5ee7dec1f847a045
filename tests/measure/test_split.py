"""The split of a run's wall time."""

import contextlib

import pytest

from mfr_bench.measure import split


@pytest.fixture
def clock(monkeypatch):
    """A clock that stands still until it is told to move."""
    class Clock:
        now = 0.0

        def perf_counter(self):
            return self.now

    found = Clock()
    monkeypatch.setattr(split, "time", found)
    return found


def test_nested_work_counts_for_the_inner_kind_alone(clock):
    times = split.Split()
    clock.now = 5.0  # nothing is at work
    with times.work("outer"):
        clock.now += 1
        with times.work("inner"):
            clock.now += 10
            with times.work("outer"):
                clock.now += 100
        clock.now += 2
    clock.now += 50
    assert times.rounded() == {"outer": 103.0, "inner": 10.0}


def test_kinds_add_up_over_their_uses(clock):
    times = split.Split()
    for seconds in (0.25, 0.5):
        with times.work("scene"):
            clock.now += seconds
    assert times.rounded() == {"scene": 0.75}


def test_work_that_fails_has_taken_its_time(clock):
    times = split.Split()
    with contextlib.suppress(RuntimeError), times.work("compile"):
        clock.now += 3
        raise RuntimeError
    clock.now += 9
    with times.work("report"):
        clock.now += 1
    assert times.rounded() == {"compile": 3.0, "report": 1.0}
