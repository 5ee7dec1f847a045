"""Work over several processes: the same outcomes in turn, whatever the processes are copies of."""

from __future__ import annotations

import gc
import os
import signal
import sys
import threading
import time
from types import ModuleType

import pytest

from mfr_bench import parallel
from mfr_bench.errors import MfrError
from mfr_bench.parallel import in_processes, uncollected


def whose(number: int) -> tuple[int, int, bool]:
    """The number, the process that has it, and whether that has imported a module which nothing else needs."""
    return number, os.getpid(), "this" in sys.modules


def with_a_thread(found):
    end = threading.Event()
    thread = threading.Thread(target=end.wait)
    thread.start()
    try:
        return found()
    finally:
        end.set()
        thread.join()


def test_a_process_that_may_be_copied_is_one_without_threads_and_without_gl(monkeypatch):
    monkeypatch.setattr(sys, "modules", {name: module for name, module in sys.modules.items()
                                         if name not in parallel.GL | parallel.THREADED})
    assert parallel._copies() is (threading.active_count() == 1)
    assert with_a_thread(parallel._copies) is False
    for name in ("moderngl", "flip_evaluator"):
        with monkeypatch.context() as loaded:
            loaded.setitem(sys.modules, name, ModuleType(name))
            assert parallel._copies() is False


@pytest.mark.parametrize("copies", [True, False])
def test_outcomes_come_in_turn_from_processes_that_have_the_imports(monkeypatch, copies):
    monkeypatch.setattr(parallel, "_copies", lambda: copies)
    monkeypatch.setattr(parallel.importlib, "import_module", lambda name: sys.modules.setdefault(name, sys))
    found = list(in_processes(whose, range(6), 2, ["this"] if copies else []))
    assert [number for number, _, _ in found] == list(range(6))
    assert os.getpid() not in {process for _, process, _ in found}
    assert {imported for *_, imported in found} == {copies}
    sys.modules.pop("this", None)


def test_few_items_stay_here(monkeypatch):
    monkeypatch.setattr(parallel, "_copies", lambda: False)
    assert {process for _, process, _ in in_processes(whose, range(5), 2)} == {os.getpid()}


def test_collecting_goes_on_afterwards_only_where_it_went_on_before():
    with uncollected():
        assert not gc.isenabled()
        with uncollected():
            pass
        assert not gc.isenabled()
    assert gc.isenabled()


def test_processes_end_by_themselves(monkeypatch, tmp_path):
    """A copy has this process's handler of SIGTERM: one that goes on would keep the pool waiting for ever."""
    monkeypatch.setattr(parallel, "_copies", lambda: True)
    told = tmp_path / "told to end"
    before = signal.signal(signal.SIGTERM, lambda *_: (told.touch(), os._exit(1)))
    try:
        for _ in range(3):
            assert [number for number, *_ in in_processes(whose, range(4), 2)] == list(range(4))
    finally:
        signal.signal(signal.SIGTERM, before)
    assert not told.exists()


def failing(number: int) -> int:
    if number == 0:
        raise ValueError("nought")
    time.sleep(3)
    return number


def test_a_mistake_ends_processes_whatever_their_parent_does_at_sigterm(monkeypatch, tmp_path):
    monkeypatch.setattr(parallel, "_copies", lambda: True)
    told = tmp_path / "told to end"
    before = signal.signal(signal.SIGTERM, lambda *_: told.touch())
    try:
        with pytest.raises(ValueError, match="nought"):
            list(in_processes(failing, range(4), 2))
    finally:
        signal.signal(signal.SIGTERM, before)
    assert not told.exists()


def dies(number: int) -> None:
    os.kill(os.getpid(), signal.SIGKILL)


@pytest.mark.parametrize("copies", [True, False])
def test_a_process_that_is_killed_is_told(monkeypatch, copies):
    """The kernel kills one for lack of memory; a pool would wait for its item for ever."""
    monkeypatch.setattr(parallel, "_copies", lambda: copies)
    with pytest.raises(MfrError, match="ended before its work was done"):
        list(in_processes(dies, range(6), 2))
