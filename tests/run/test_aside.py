"""Work beside the device: its value always comes, and its process stands still while frames are timed."""

from __future__ import annotations

import os
import signal
from dataclasses import dataclass

import numpy as np
import pytest

from mfr_bench.methods.spec import Promise
from mfr_bench.run import aside as module
from mfr_bench.run.answers import ALL, Answers, Compare, Keep, Make, Prepare, Subject, Ties
from mfr_bench.run.aside import AtOnce, OtherProcess
from mfr_bench.run.shared import Shared, Unreachable
from mfr_bench.scene import Scene

from .children import ends_with_its_parent, state

SCENE = Scene(size=(24, 20), depth_complexity=6)
KEEPS_TIES = Ties(False, False)


@dataclass(frozen=True)
class Divide:
    """17 divided by a number; it also says in which process."""

    by: int

    def __call__(self, answers):
        return divmod(17, self.by), os.getpid()


@dataclass(frozen=True)
class Sum:
    array: object

    def __call__(self, answers):
        return float(self.array.array().sum())


@dataclass(frozen=True)
class FailsElsewhere:
    """Work that fails but in this process."""

    home: int
    error: Exception

    def __call__(self, answers):
        if os.getpid() != self.home:
            raise self.error
        return "here"


def beside(pauses: bool) -> OtherProcess:
    return OtherProcess(pauses, Answers())


@pytest.fixture
def fresh():
    """A process that a test may kill."""
    process = beside(pauses=True)
    yield process
    process.close()


@pytest.fixture(scope="module")
def other():
    """The process that the other tests share; it has worked already."""
    process = beside(pauses=True)
    process.begin(Divide(5))()
    yield process
    process.close()


def handles() -> int:
    return len(os.listdir("/proc/self/fd"))


@pytest.mark.parametrize("another", [False, True])
def test_values_come_in_order_of_asking(other, another):
    aside = other if another else AtOnce(Answers())
    waits = [aside.begin(Divide(by)) for by in (5, 4, 3)]
    with aside.paused():
        pass
    assert [wait()[0] for wait in waits] == [(3, 2), (4, 1), (5, 2)]
    assert all(wait.ready for wait in waits)
    assert {wait()[1] == os.getpid() for wait in waits} == {not another}


# --- what it is for ------------------------------------------------------------------------------


def images() -> tuple[np.ndarray, np.ndarray]:
    """The right image of two layers, and one that is wrong in a pixel."""
    known = Answers().of(Subject(SCENE))
    right = known.answer(Promise(2)).image.astype(np.float32)
    wrong = right.copy()
    wrong[3, 4, 1] += 0.25
    return right, wrong


def test_images_are_compared_and_packed_alike_in_another_process(other):
    subject, here = Subject(SCENE), AtOnce(Answers())
    for image in images():
        found = []
        for aside in (here, other):
            shared = [aside.share(image) for _ in range(2)]
            compare = Compare(subject, Promise(2), KEEPS_TIES, shared[0], quality=True, flip=True)
            compared = aside.begin(compare, shared[0])
            kept = aside.begin(Keep(subject, Promise(2), ("image", "error", "loss", "fragments"), shared[1], None),
                               shared[1])
            found.append((compared(), len(kept().content)))
        assert found[0] == found[1]
        assert found[0][0].quality["flip"] > 0
    assert found[0][0].conformance["max_abs_error"] == pytest.approx(0.25)


def test_a_scene_and_its_oracle_are_made_there_and_what_they_took_is_known(other):
    other.taken_s()
    other.begin(Prepare(Subject(SCENE), ALL))()
    assert other.begin(Make(SCENE))() == Make(SCENE)(Answers())
    assert set(other.taken_s()) == {"scene", "oracle"}
    assert other.taken_s() == {}


# --- memory --------------------------------------------------------------------------------------


@pytest.mark.parametrize("array", [np.arange(12, dtype=np.float32).reshape(3, 4), np.empty((0, 2), np.uint8),
                                   np.arange(10)[::2]])
def test_an_array_is_the_same_in_another_process_and_its_memory_is_let_go(other, array):
    before = handles()
    shared = other.share(array)
    assert np.array_equal(shared.array(), array) and shared.array().dtype == array.dtype
    assert other.begin(Sum(shared), shared)() == array.sum()
    assert handles() == before


def test_no_more_images_wait_than_memory_is_meant_for_them(other, monkeypatch):
    monkeypatch.setattr(module, "IN_FLIGHT_BYTES", 2 * 800)
    waits = []
    for number in range(5):
        shared = other.share(np.full(100, float(number)))
        waits.append(other.begin(Sum(shared), shared))
        assert sum(wait.bytes for wait in waits) <= 2 * 800
    assert [wait() for wait in waits] == [0, 100, 200, 300, 400]


def test_where_no_memory_can_be_shared_the_array_goes_with_the_work(other, monkeypatch):
    def full(handle, data):
        raise OSError(28, "No space left on device")

    before = handles()
    with monkeypatch.context() as patched:
        patched.setattr(os, "write", full)
        with pytest.raises(MemoryError, match="800 bytes: No space left"):
            Shared(np.zeros(100))
        held = other.share(np.ones(100))
    assert other.begin(Sum(held), held)() == 100
    assert handles() == before


# --- pauses --------------------------------------------------------------------------------------


def test_no_process_is_started_before_there_is_work(fresh):
    with fresh.paused():
        assert fresh.pid is None


def test_it_stands_still_while_frames_are_timed_and_goes_on_after(other):
    wait = other.begin(Divide(5))
    with other.paused():
        os.waitid(os.P_PID, other.pid, os.WSTOPPED | os.WNOWAIT)
        assert state(other.pid) == "T"
    assert wait()[0] == (3, 2)


def test_beside_a_device_with_cores_of_its_own_it_goes_on():
    other = beside(pauses=False)
    wait = other.begin(Divide(5))
    with other.paused():
        assert wait()[0] == (3, 2)
    other.close()


# --- faults --------------------------------------------------------------------------------------


def test_what_a_killed_process_did_not_end_is_done_here_and_the_next_work_has_a_new_one(fresh):
    fresh.begin(Divide(2))()
    first = fresh.pid
    os.kill(first, signal.SIGSTOP)
    shared = fresh.share(np.ones(7))
    waits = [fresh.begin(Divide(5)), fresh.begin(Divide(4)), fresh.begin(Sum(shared), shared)]
    os.kill(first, signal.SIGKILL)
    assert [waits[0]()[0], waits[1]()[0], waits[2]()] == [(3, 2), (4, 1), 7]
    assert waits[0]()[1] == os.getpid()
    (found, pid), = [fresh.begin(Divide(3))()]
    assert found == (5, 2) and pid == fresh.pid not in (None, first, os.getpid())


def test_after_some_deaths_all_work_is_done_here(fresh):
    for number in range(module.DEATHS + 1):
        (_, pid), = [fresh.begin(Divide(4))()]
        assert (pid == os.getpid()) == (number == module.DEATHS)
        if pid != os.getpid():
            os.kill(pid, signal.SIGKILL)
            assert fresh.begin(Divide(4))()[0] == (4, 1)
    with fresh.paused():
        assert fresh.pid is None


@pytest.mark.parametrize("error", [MemoryError(), Unreachable("as in a container that hides processes")], ids=repr)
def test_what_the_other_process_has_no_means_for_is_done_here(other, error):
    assert other.begin(FailsElsewhere(os.getpid(), error))() == "here"


def test_memory_that_was_let_go_is_out_of_reach(other):
    shared = other.share(np.ones(7))
    other.begin(Sum(shared), shared)()
    with pytest.raises(Unreachable):
        other.begin(Sum(shared))()


def test_an_error_of_the_work_is_raised_where_its_value_is_asked_for(other):
    wait = other.begin(Divide(0))
    for _ in range(2):
        with pytest.raises(ZeroDivisionError):
            wait()


KILLED = """
import os, sys, time
from mfr_bench.run.answers import Answers, Make
from mfr_bench.run.aside import OtherProcess
from mfr_bench.scene import Scene
other = OtherProcess(True, Answers())
other.begin(Make(Scene(size=(8, 8), depth_complexity=2)))()
with other.paused():
    print(other.pid, flush=True)
    time.sleep(60)
"""


def test_it_ends_with_a_process_that_is_killed_even_while_it_is_paused():
    ends_with_its_parent(KILLED)
