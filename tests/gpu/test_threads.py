"""The threads of a software rasterizer have processors of their own."""

from __future__ import annotations

import os

import pytest

from mfr_bench.gpu import threads
from mfr_bench.gpu.threads import shares, spread_rasterizers


@pytest.mark.parametrize(("count", "cpus", "dealt"), [
    (2, [0, 1], [{0}, {1}]),
    (2, [3, 7], [{3}, {7}]),
    (1, [0, 1], [{0, 1}]),
    (3, [0, 1], [{0}, {1}, {0}]),
    (3, [0, 1, 2, 3], [{0, 3}, {1}, {2}]),
    (0, [0, 1], []),
])
def test_the_processors_are_dealt_out(count, cpus, dealt):
    assert shares(count, cpus) == dealt


@pytest.fixture
def process(tmp_path, monkeypatch):
    """A process of which the system tells these threads, and on which it lets itself be told."""
    bound = {}
    for number, name in {11: "python", 12: "llvmpipe-0", 13: "llvmpipe-1", 14: "llvmpipe-1", 15: "llvmpipe"}.items():
        (tmp_path / str(number)).mkdir()
        (tmp_path / str(number) / "comm").write_text(f"{name}\n")
    (tmp_path / "16").mkdir()  # a thread that ended
    monkeypatch.setattr(threads, "TASKS", tmp_path)
    monkeypatch.setattr(os, "sched_getaffinity", lambda of: {4, 5}, raising=False)
    monkeypatch.setattr(os, "sched_setaffinity", bound.__setitem__, raising=False)
    return bound


def test_only_rasterizers_are_bound(process):
    assert spread_rasterizers() == 3
    assert process == {12: {4}, 13: {5}, 14: {5}}  # two rasterizers are open


def test_nothing_is_bound_where_there_is_nothing_to_choose(process, monkeypatch):
    monkeypatch.setattr(os, "sched_getaffinity", lambda of: {4})
    assert spread_rasterizers() == 0 and not process


def test_a_system_that_refuses_is_no_error(process, monkeypatch):
    def refuse(thread, cpus):
        raise PermissionError(thread)

    monkeypatch.setattr(os, "sched_setaffinity", refuse)
    assert spread_rasterizers() == 0


def test_a_system_without_threads_to_list_is_no_error(process, monkeypatch, tmp_path):
    monkeypatch.setattr(threads, "TASKS", tmp_path / "absent")
    assert spread_rasterizers() == 0


def test_the_threads_of_an_open_device_share_no_processor(device):
    """The device of all tests: the context of another one would be current behind this test."""
    numbers, cpus = threads._rasterizers(), sorted(os.sched_getaffinity(0))
    if not numbers or len(cpus) == 1:
        pytest.skip("the driver has no threads that are named llvmpipe-N, or there is one processor")
    assert device.bound_threads == len(numbers)
    of_each = shares(1 + max(numbers.values()), cpus)
    assert {os.sched_getaffinity(thread) == of_each[number] for thread, number in numbers.items()} == {True}
    assert os.sched_getaffinity(0) == set(cpus)  # the thread that draws may go where it likes
