"""Work beside the device: its value always comes, and its process stands still while frames are timed."""

from __future__ import annotations

import os
import signal
from functools import partial
from pathlib import Path

import numpy as np
import pytest

from mfr_bench.oracle.flip import OnScreen
from mfr_bench.run.aside import AtOnce, OtherProcess


@pytest.fixture
def other():
    process = OtherProcess(pauses=True)
    yield process
    process.close()


def state(pid: int) -> str:
    return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0]


@pytest.mark.parametrize("kind", [AtOnce, partial(OtherProcess, pauses=True), partial(OtherProcess, pauses=False)])
def test_every_kind_gives_the_values_in_order_of_asking(kind):
    aside = kind()
    waits = [aside.begin(partial(divmod, 17, by)) for by in (5, 4, 3)]
    with aside.paused():
        pass
    assert [wait() for wait in waits] == [(3, 2), (4, 1), (5, 2)]


def test_flip_is_the_same_in_another_process(other):
    ramp = np.linspace(0, 1, 24 * 24 * 4).reshape(24, 24, 4)
    images = OnScreen.of(np.roll(ramp, 3, axis=0), ramp)
    assert other.begin(images.flip)() == images.flip() > 0


def test_no_process_is_started_before_there_is_work(other):
    with other.paused():
        assert other.pid is None


def test_it_stands_still_while_frames_are_timed_and_goes_on_after(other):
    wait = other.begin(partial(pow, 2, 10))
    with other.paused():
        os.waitid(os.P_PID, other.pid, os.WSTOPPED | os.WNOWAIT)
        assert state(other.pid) == "T"
    assert wait() == 1024


def test_beside_a_device_with_cores_of_its_own_it_goes_on():
    other = OtherProcess(pauses=False)
    wait = other.begin(partial(pow, 2, 10))
    with other.paused():
        assert wait() == 1024
    other.close()


def test_what_a_killed_process_did_not_end_is_done_all_the_same_and_the_next_has_a_new_one(other):
    other.begin(partial(pow, 2, 2))()
    first = other.pid
    os.kill(first, signal.SIGSTOP)
    waits = [other.begin(partial(pow, 2, by)) for by in (3, 4)]
    os.kill(first, signal.SIGKILL)
    assert [wait() for wait in waits] == [8, 16]
    assert other.begin(partial(pow, 2, 5))() == 32
    assert other.pid not in (None, first)


def test_an_error_of_the_work_is_raised_where_its_value_is_asked_for(other):
    wait = other.begin(partial(divmod, 1, 0))
    with pytest.raises(ZeroDivisionError):
        wait()
