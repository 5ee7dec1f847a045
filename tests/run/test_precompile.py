"""Compiling ahead: whatever becomes of the other process, what is measured stays as it is."""

from __future__ import annotations

import fcntl
import os
import signal
import time
from dataclasses import replace
from multiprocessing import Pipe
from pathlib import Path

import pytest

from mfr_bench.methods import catalog
from mfr_bench.methods.spec import Fitted
from mfr_bench.plan import expected_stats
from mfr_bench.run import bench, first_frames
from mfr_bench.run import precompile as module
from mfr_bench.run.cell import CellWork
from mfr_bench.run.jobs import Job, jobs
from mfr_bench.run.precompile import ASKED, CELL_BYTES, FEW, FRAGMENTS, SLOW_S, TRIED, Precompiler, drawable, helps
from mfr_bench.scene import Scene

from ..patience import until
from . import fake_first_frames as fake
from .children import ends_with_its_parent, state
from .fake_worker import DEVICE
from .planted_cells import Clock, Run, cell

CELLS = [fake.Cell(f"cell {number}") for number in range(12)]
COMPILED_S = 10 * SLOW_S


@pytest.fixture
def made():
    """Makes a precompiler that has its process, whose other end is served as given; ends it with the test."""
    every = []

    def make(serve, *given, cells=CELLS, met=()) -> Precompiler:
        every.append(Precompiler(serve, *given))
        for each in met:
            every[-1].reached(each)
        every[-1].begin(cells)
        every[-1].reached(cells[0])
        every[-1].drew(cells[0], COMPILED_S)
        return every[-1]

    yield make
    for each in every:
        each.close()


def answered(precompiler: Precompiler, wanted: set[str]) -> None:
    """Wait until the cells of these keys, and no others, are drawn."""
    def drawn() -> bool:
        precompiler.begin([each for each in CELLS if each.key in wanted])
        return set(precompiler.drawn_s) == wanted

    until(drawn, "cells are not drawn")


# --- what it is for ------------------------------------------------------------------------------


def test_it_starts_when_something_was_compiled_for_a_cell_and_draws_those_that_are_left(made):
    precompiler = made(fake.answers, COMPILED_S)
    assert precompiler.pid not in (None, os.getpid())
    answered(precompiler, {each.key for each in CELLS[1:]})
    assert precompiler.taken_s() == {"compile": pytest.approx(COMPILED_S * len(CELLS[1:]))}
    assert precompiler.taken_s() == {}


def test_it_asks_from_the_last_cell_on_and_for_few_at_once(made):
    """So that both meet in the middle, and writing never waits for a process that does not read."""
    precompiler = made(fake.hangs)
    assert list(precompiler.asked) == [each.key for each in CELLS[:-ASKED - 1:-1]]
    for each in CELLS[1:]:
        precompiler.reached(each)
        precompiler.drew(each, COMPILED_S)
    precompiler.begin(CELLS)
    assert len(precompiler.asked) == ASKED
    with precompiler.paused():
        assert state(precompiler.pid) == "T"


def test_it_draws_the_cells_of_the_next_scene_when_none_of_this_one_are_left(made):
    precompiler = made(fake.answers, COMPILED_S, cells=CELLS[:6])
    until = time.monotonic() + 30
    while len(precompiler.drawn_s) < len(CELLS) - 1 and time.monotonic() < until:
        time.sleep(0.01)
        precompiler.begin(CELLS[1:6], CELLS[6:])
    assert list(precompiler.drawn_s) == [each.key for each in (*CELLS[5:0:-1], *CELLS[:5:-1])]


def test_it_starts_when_it_is_told_to_before_any_cell_was_drawn(made):
    precompiler = Precompiler(fake.answers, COMPILED_S)
    precompiler.start()
    pid = precompiler.pid
    precompiler.begin(CELLS)
    precompiler.start()
    try:
        assert pid and precompiler.pid == pid
        answered(precompiler, {each.key for each in CELLS})
    finally:
        precompiler.close()


def test_a_cell_whose_turn_has_come_is_not_drawn_any_more():
    ours, theirs = Pipe()
    asked = {}
    for message in (*CELLS[:4], CELLS[1].key, CELLS[0].key):
        ours.send(message)
    assert first_frames._next(theirs, asked) == CELLS[2] and list(asked) == [CELLS[3].key]
    assert [ours.recv() for _ in range(2)] == [(CELLS[1].key, None), (CELLS[0].key, None)]


def test_one_that_both_drew_at_the_same_time_speaks_not_against_the_cache(made):
    precompiler = made(fake.answers, COMPILED_S, met=CELLS[1:1 + TRIED])
    answered(precompiler, {each.key for each in CELLS[1:]})
    for each in CELLS[1:1 + TRIED]:
        precompiler.drew(each, COMPILED_S)
    assert precompiler.pid


@pytest.mark.parametrize(("serve", "cells", "spent_s"), [
    (None, CELLS, COMPILED_S), (fake.answers, CELLS[:FEW], COMPILED_S), (fake.answers, CELLS, SLOW_S / 2)],
    ids=["where it would not help", "for few cells", "where all programs are in the cache"])
def test_no_process_is_started(serve, cells, spent_s):
    precompiler = Precompiler(serve, 0.0)
    precompiler.begin(cells)
    precompiler.reached(cells[0])
    precompiler.drew(cells[0], spent_s)
    with precompiler.paused():
        assert precompiler.pid is None


def test_it_is_given_up_where_this_process_compiles_all_the_same(made):
    """There is no cache on disk then, or none that can be written to."""
    precompiler = made(fake.answers, COMPILED_S)
    answered(precompiler, {each.key for each in CELLS[1:]})
    for each in CELLS[1:1 + TRIED]:
        assert precompiler.pid
        precompiler.drew(each, 0.9 * COMPILED_S)
    assert precompiler.pid is None
    precompiler.begin(CELLS)
    precompiler.drew(CELLS[0], COMPILED_S)
    assert precompiler.pid is None


def test_it_goes_on_where_this_process_finds_the_programs(made):
    precompiler = made(fake.answers, COMPILED_S)
    answered(precompiler, {each.key for each in CELLS[1:]})
    for each in CELLS[1:]:
        precompiler.drew(each, 0.1 * COMPILED_S)
    assert precompiler.pid


@pytest.mark.parametrize("slug", ["nvidia-h200", "mesa-intel-graphics", "virgl-llvmpipe", "zink-nvidia-h200"])
def test_it_is_for_drivers_that_compile_in_the_process_that_draws_with_the_processor(slug):
    assert not helps(slug)


@pytest.mark.parametrize(("scene", "expected"), [
    (Scene(size=(64, 64), depth_complexity=4), True),
    (Scene(size=(2048, 1024), depth_complexity=1), FRAGMENTS >= 2048 * 1024),
    (Scene(size=(2048, 1024), depth_complexity=2), False),
    (Scene(size=(8, 8), depth_complexity=100, pixel_density=1.0), True)])
def test_nothing_large_is_drawn_twice(scene, expected):
    job, = jobs([cell("floor")], catalog(), DEVICE, "wall")
    fitted = Fitted(catalog()["floor"].variant({}), expected_stats(scene))
    assert drawable(job, fitted) == expected
    assert sum(fitted.memory_bytes().values()) <= CELL_BYTES


def test_the_drivers_cache_has_what_it_draws(device, made, tmp_path, monkeypatch):
    """Also a cell that fails is answered for."""
    if not helps(device.info["slug"]):
        pytest.skip(f"{device.info['slug']} does not compile in the process that draws with the processor")
    monkeypatch.setenv("MESA_SHADER_CACHE_DIR", str(tmp_path))
    broken = replace(cell(), params={"sort": "none"})
    todo = [*jobs([cell("floor"), cell(), cell("kplus-array", k=3)], catalog(), device.info, "wall"),
            Job(broken, "broken", ""), Job(broken, "broken too", "")]
    precompiler = made(first_frames.serve, device.egl.index, None, device.failed_trials, device.flushes_dispatches,
                       cells=todo)

    def drawn() -> bool:
        precompiler.begin(todo[1:])
        return set(precompiler.drawn_s) == {job.key for job in todo[1:]}

    until(drawn, "cells are not drawn")
    assert any(path.is_file() for path in tmp_path.rglob("*"))


METHODS = ("floor", "ab-array", "ab-ll", "kb-ps", "zbuffer", "kplus-heap")


def measured(device, folder: Path) -> tuple[Run, dict]:
    """A run of these methods; what each row says, but for when."""
    made = Run(device, [cell(method) for method in METHODS], Clock(), folder)
    made.all()
    return made, {row["method"]: {name: row[name] for name in ("status", "values", "samples_ms", "buffers")}
                  for row in made.rows}


@pytest.mark.parametrize("serve", ["well", "dies", "hangs"])
def test_the_rows_are_the_same(serve, device, tmp_path, monkeypatch):
    _, alone = measured(device, tmp_path / "alone")
    ends = {"well": (first_frames.serve, device.egl.index, None, device.failed_trials, device.flushes_dispatches),
            "dies": (fake.dies,), "hangs": (fake.hangs,)}
    precompiler = Precompiler(*ends[serve])
    monkeypatch.setattr(bench, "Precompiler", lambda serve: precompiler)
    monkeypatch.setattr(module, "SLOW_S", -1.0)  # so that it starts
    try:
        made, both = measured(device, tmp_path / "both")
        assert made.measuring.bench.precompiler is precompiler and precompiler.asked
    finally:
        precompiler.close()
    assert both == alone and len(both) == len(METHODS)


def test_one_that_waits_for_cells_is_not_stopped(made, monkeypatch):
    """Unless it has answered just now: its driver may still be writing what it compiled."""
    precompiler = made(fake.answers, COMPILED_S)
    answered(precompiler, {each.key for each in CELLS[1:]})
    monkeypatch.setattr(module, "IDLE_S", 600.0)
    with precompiler.paused():
        assert state(precompiler.pid) == "T"
    monkeypatch.setattr(module, "IDLE_S", 0.0)
    with precompiler.paused():
        assert state(precompiler.pid) != "T"


def test_within_a_pause_it_is_not_stopped_again(made, monkeypatch):
    precompiler, stops, stopped = made(fake.hangs), [], Precompiler._stopped
    monkeypatch.setattr(precompiler, "_stopped", lambda pid: (stops.append(pid), stopped(pid))[1])
    with precompiler.paused():
        for _ in range(2):
            with precompiler.paused():
                assert state(precompiler.pid) == "T"
            assert state(precompiler.pid) == "T"
    assert stops == [precompiler.pid]
    until(lambda: state(precompiler.pid) != "T", "it does not go on")


def test_it_is_stopped_once_for_the_turns_of_all_cells(device, tmp_path, monkeypatch):
    """It goes on while cells are finished, and the others' turns come after that."""
    precompiler, stops, stopped = Precompiler(fake.hangs), [], Precompiler._stopped
    monkeypatch.setattr(precompiler, "_stopped", lambda pid: (stops.append(pid), stopped(pid))[1])
    monkeypatch.setattr(bench, "Precompiler", lambda serve: precompiler)
    precompiler.start()
    turns, batch = [], CellWork.batch
    monkeypatch.setattr(CellWork, "batch", lambda self, sampler: (turns.append(self), batch(self, sampler)))
    try:
        measured(device, tmp_path)
        assert 0 < len(stops) <= len(turns) / (len(METHODS) - 1)
    finally:
        precompiler.close()


# --- faults --------------------------------------------------------------------------------------


def locked(path: Path) -> bool:
    """Whether another process has the file locked."""
    with path.open("r+") as file:
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            return True
        fcntl.flock(file, fcntl.LOCK_UN)
    return False


def test_it_never_stands_still_with_a_lock_that_the_driver_of_this_process_might_wait_for(made, tmp_path):
    """It has the file locked three quarters of the time."""
    path = tmp_path / "cache"
    precompiler = made(fake.locks, str(path), 0.003)
    answered(precompiler, {CELLS[-1].key})
    with path.open("r+") as file:
        for _ in range(20):
            with precompiler.paused():
                assert state(precompiler.pid) == "T"
                fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
                fcntl.flock(file, fcntl.LOCK_UN)
            time.sleep(0.002)


def test_one_that_does_not_let_go_of_a_lock_is_ended(made, tmp_path, monkeypatch):
    path = tmp_path / "cache"
    precompiler = made(fake.locks, str(path), 600.0)
    answered(precompiler, {CELLS[-1].key})
    until(lambda: locked(path), "it has not locked the file")
    monkeypatch.setattr(module, "STOP_S", 0.05)
    with precompiler.paused(), path.open("r+") as file:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        assert precompiler.pid is None


@pytest.mark.parametrize("killed", [False, True])
def test_nothing_comes_of_its_death(made, killed):
    precompiler = made(fake.hangs if killed else fake.dies)
    pid = precompiler.pid
    if killed:
        os.kill(pid, signal.SIGKILL)
    os.waitid(os.P_PID, pid, os.WEXITED | os.WNOWAIT)
    for each in CELLS:
        with precompiler.paused():
            precompiler.reached(each)
        precompiler.drew(each, COMPILED_S)
    assert precompiler.pid is None and not Path(f"/proc/{pid}").exists()


PARENT = """
import time
from mfr_bench.run.precompile import Precompiler
from tests.run import fake_first_frames as fake
cells = [fake.Cell(str(number)) for number in range(9)]
precompiler = Precompiler(fake.answers, 10.0)
precompiler.begin(cells)
precompiler.drew(cells[0], 10.0)
while not precompiler.drawn_s:
    time.sleep(0.01)
    precompiler.begin(cells)
with precompiler.paused():
    print(precompiler.pid, flush=True)
    time.sleep(60)
"""


def test_it_ends_with_a_process_that_is_killed_even_while_it_is_paused():
    ends_with_its_parent(PARENT)
