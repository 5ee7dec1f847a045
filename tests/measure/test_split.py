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


def test_what_no_kind_counted_is_told_so_that_all_adds_up(clock):
    times = split.Split()
    with times.work("measure"):
        clock.now += 6
    with times.work("compile"):
        clock.now += 3
    assert times.whole(12.0) == {"measure": 6.0, "compile": 3.0, "other": 3.0}
    assert times.whole(8.0)["other"] == 0.0  # kinds of two processes may overlap
    assert split.busy_share(times.whole(12.0)) == 0.5
    assert split.told(times.whole(12.0)) == "device busy with frames 50 % of 12 s; other 25 %, compile 25 %"
    assert split.busy_share({}) == 0.0


def test_what_is_taken_is_counted_once(clock):
    times = split.Split()
    with times.work("check"):
        clock.now += 1
        assert times.taken() == {"check": 1.0}
        clock.now += 2
    assert times.taken() == {"check": 2.0}
    assert times.taken() == {}


def test_a_part_of_a_kind_is_moved_to_another_and_never_more_than_there_is(clock):
    times = split.Split()
    with times.work("compile"):
        clock.now += 3
    times.move(1, "compile", "first frames")
    assert times.rounded() == {"compile": 2.0, "first frames": 1.0}
    times.move(7, "compile", "first frames")
    times.move(7, "flip", "first frames")
    assert times.rounded() == {"compile": 0.0, "first frames": 3.0}
    assert split.busy_share(times.whole(4.0)) == 0.75
