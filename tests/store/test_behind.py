"""Writing behind the caller: in order, with what follows on it in the caller's thread, and no failure unseen."""

from __future__ import annotations

import threading
import time

import pytest

from mfr_bench.errors import StoreError
from mfr_bench.store.behind import WAITING, Behind

from ..patience import PATIENCE_S


def nothing() -> None:
    pass


def test_writes_are_done_in_order_while_the_caller_goes_on():
    behind, gate, written = Behind(), threading.Event(), []
    behind.write(lambda: gate.wait(PATIENCE_S), nothing)
    for number in range(9):
        behind.write(lambda number=number: written.append(number), nothing)
    behind.catch_up()
    assert written == []
    gate.set()
    behind.wait()
    assert written == list(range(9))


def test_a_disk_that_is_slower_than_its_caller_holds_it_up():
    behind, told, ahead = Behind(), [], []

    def slow():
        until = time.monotonic() + PATIENCE_S
        while len(told) < 1 + WAITING and time.monotonic() < until:
            time.sleep(0.001)
        time.sleep(0.05)  # in which a caller that nothing holds up tells all
        ahead.append(len(told))

    behind.write(slow, nothing)
    for number in range(1, 10 * WAITING):
        told.append(number)
        behind.write(nothing, nothing)
    behind.wait()
    assert ahead == [1 + WAITING]  # the last of which it is telling


def test_what_follows_is_done_by_the_caller_once_it_is_written():
    behind, gate, told = Behind(), threading.Event(), []
    behind.write(lambda: told.append(("writes", threading.current_thread() is threading.main_thread())), nothing)
    behind.write(lambda: gate.wait(PATIENCE_S), lambda: told.append(
        ("follows", threading.current_thread() is threading.main_thread())))
    behind.catch_up()
    assert ("follows", True) not in told
    gate.set()
    behind.wait()
    assert told == [("writes", False), ("follows", True)]


def test_after_a_write_that_fails_none_is_done_and_nothing_follows_on_it():
    behind, gate, done = Behind(), threading.Event(), []

    def full():
        gate.wait(PATIENCE_S)
        raise StoreError("no space")

    behind.write(lambda: done.append("first"), lambda: done.append("follows on the first"))
    behind.write(full, lambda: done.append("follows on what failed"))
    behind.write(lambda: done.append("later"), lambda: done.append("follows on the later"))
    gate.set()
    with pytest.raises(StoreError, match="no space"):
        behind.wait()
    assert done == ["first", "follows on the first"]
    with pytest.raises(StoreError, match="no space"):
        behind.catch_up()


def test_the_thread_ends_when_all_is_written_and_begins_again():
    before, behind, written = threading.active_count(), Behind(), []
    behind.wait()
    for number in range(3):
        behind.write(lambda number=number: written.append(number), nothing)
        behind.wait()
        assert (written, threading.active_count()) == (list(range(number + 1)), before)


def test_the_caller_writes_where_there_is_no_thread_left(monkeypatch):
    def none_left(thread):
        raise RuntimeError("can't start new thread")

    monkeypatch.setattr(threading.Thread, "start", none_left)
    behind, done = Behind(), []
    behind.write(lambda: done.append("written"), lambda: done.append("follows"))
    assert done == ["written"]
    behind.wait()
    assert done == ["written", "follows"]
