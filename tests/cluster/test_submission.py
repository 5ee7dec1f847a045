"""A store has only the tasks that this run planned, and never takes another process's job for one of them."""

from __future__ import annotations

import fcntl
import json
import os
import shlex
import subprocess
import sys
from dataclasses import asdict, replace
from pathlib import Path

import pytest

from mfr_bench.cluster import queue, state
from mfr_bench.cluster.settings import Cluster, Kind
from mfr_bench.cluster.submission import FILE, Share, alone, command_of, planned, read_submission
from mfr_bench.errors import StoreError, UsageError
from mfr_bench.store import ResultFolder

from ..cli.conftest import mfr  # noqa: F401
from ..store.test_store import cell
from .test_local import CLUSTER, place  # noqa: F401

TASK = asdict(Share("cpu", 1, 2, 4, "a"))
RECORD = {"schema": 1, "engine": "local", "run": ["run.yaml"], "tasks": [TASK]}


def cluster(shares, **kinds):
    return Cluster(engine="local", store="s", kinds={"cpu": Kind(shares=shares), **kinds})


def shares(count, plan="a"):
    return {(number, count, Kind().split_s): (4, f"{plan}{number}") for number in range(1, count + 1)}


@pytest.mark.parametrize("record", [
    [], {}, RECORD | {"schema": 2}, RECORD | {"run": "run.yaml"}, RECORD | {"engine": 5}, RECORD | {"tasks": [{}]},
    *(RECORD | {"tasks": [TASK | part]} for part in (
        {"kind": "../.."}, {"kind": None}, {"number": "1"}, {"number": 0}, {"cells": "4"}, {"job": 7}, {"other": 1}))])
def test_what_submit_did_not_write_is_one_line(tmp_path, mfr, record):  # noqa: F811
    (tmp_path / FILE).write_text(json.dumps(record))
    for command in ("status", "collect"):
        done = mfr(command, tmp_path)
        assert done.status == 2 and done.err.startswith(f"{tmp_path / FILE}: cannot be read: ")
        assert done.err.count("\n") == 1


def test_a_store_without_tasks_has_a_status(tmp_path, mfr):  # noqa: F811
    (tmp_path / FILE).write_text(json.dumps(RECORD | {"tasks": []}))
    assert mfr("status", tmp_path).out == "0 of 0 cells, 0 of 0 tasks done\n"


@pytest.mark.parametrize(("settings", "cells"), [
    (cluster(3), shares(3)), (cluster(1), shares(1)), (cluster(2), shares(2, plan="b")),
    (Cluster(engine="local", store="s", kinds={"gpu": Kind(shares=2)}), shares(2))])
def test_cells_of_another_plan_count_for_none(tmp_path, settings, cells):
    planned(cluster(2), tmp_path, ["run.yaml"], shares(2)).write()
    with pytest.raises(UsageError, match=r"such as cpu-1: the config, the number of shares .* another store"):
        planned(settings, tmp_path, ["run.yaml"], cells)


def test_the_same_plan_keeps_its_jobs_and_takes_further_kinds(tmp_path):
    first = planned(cluster(2), tmp_path, ["run.yaml"], shares(2))
    with_jobs = type(first)(first.store, first.engine, first.run,
                            tuple(Share(**asdict(task) | {"job": f"{task.number}7"}) for task in first.tasks))
    with_jobs.write()
    again = planned(cluster(2, gpu=Kind(shares=1)), tmp_path, ["run.yaml"], shares(2) | shares(1, plan="whole"))
    assert [(task.name, task.job) for task in again.tasks] == [("cpu-1", "17"), ("cpu-2", "27"), ("gpu-1", None)]
    assert read_submission(tmp_path) == with_jobs


def test_two_processes_never_submit_into_one_store(tmp_path):
    store = tmp_path / "store"
    with alone(store), pytest.raises(StoreError, match=f"process {os.getpid()} submits into it"), alone(store):
        pass
    handle = os.open(store, os.O_RDONLY)
    fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
    os.close(handle)


def test_a_job_is_a_process_of_the_engine_and_no_other_of_its_number():
    program = [sys.executable, "-c", "print(flush=True); input()"]
    pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE}
    with subprocess.Popen(program, **pipes) as other, subprocess.Popen([*program, "submitit"], **pipes) as job:
        for process in (other, job):
            process.stdout.readline()  # the kernel has its command by then
        assert queue.states("local", [str(other.pid), str(job.pid), "0"]) == {str(job.pid): "running"}
        for process in (other, job):
            process.communicate(b"\n")
    assert queue.states("local", [str(job.pid)]) == {}


@pytest.mark.parametrize("store", ['""', r'"s\0t"'])
def test_a_store_that_no_folder_can_be_is_one_line(place, mfr, store):  # noqa: F811
    (place / "cluster.yaml").write_text(CLUSTER.replace("store: store", f"store: {store}"))
    done = mfr("submit", "run.yaml", "--cluster", "cluster.yaml", "--dry-run")
    assert done.status == 2 and done.err.startswith("cluster.yaml:2: store: is no text")


def test_a_printed_command_is_quoted_for_a_shell(place, mfr):  # noqa: F811
    done = mfr("submit", "run.yaml", "--cluster", "cluster.yaml", "--dry-run", "--set", "title=$HOME; a b")
    assert done.status == 0 and all("title=$HOME; a b" in shlex.split(line) for line in done.out.splitlines())


def test_each_share_has_the_next_of_several_devices(tmp_path):
    kind = Kind(shares=3, device=["uuid-a", "uuid-b"])
    plan = planned(cluster(3), tmp_path, ["run.yaml"], shares(3))
    assert [command_of(plan, task, kind)[-4] for task in plan.tasks] == ["uuid-a", "uuid-b", "uuid-a"]
    assert [command_of(plan, task, kind)[-5:-3][0] for task in plan.tasks] == ["--device"] * 3


def test_tasks_that_would_draw_at_once_on_one_device_are_named(place, mfr):  # noqa: F811
    said = "cpu: 2 tasks draw on 1 device of this machine at the same time"
    assert said in mfr("submit", "run.yaml", "--cluster", "cluster.yaml", "--dry-run").err
    (place / "cluster.yaml").write_text(CLUSTER.replace("device: cpu", 'device: ["0", "1"]'))
    assert said not in mfr("submit", "run.yaml", "--cluster", "cluster.yaml", "--dry-run").err


def test_a_scene_longer_than_a_task_is_split_and_said(place, mfr):  # noqa: F811
    (place / "cluster.yaml").write_text(CLUSTER.replace("shares: 2", "shares: 4, minutes: 1"))
    done = mfr("submit", "run.yaml", "--cluster", "cluster.yaml", "--dry-run", "--set", "scene.size=[2048,2048]")
    assert "cpu: scene of 2048x2048 pixels, n = 2: by forecast" in done.err and "Blending floor | AB_Array" in done.err
    assert done.out.count("--split 48s") == 4
    assert mfr("run", "run.yaml", "--split", "1s").status == 2


def test_methods_from_outside_go_with_every_task(place, mfr):  # noqa: F811
    template = str(Path(__file__).parents[2] / "examples" / "my-array")
    done = mfr("submit", "run.yaml", "--cluster", "cluster.yaml", "--dry-run", "--methods", template)
    assert done.status == 0 and done.out.count(f"--methods {template}") == 2, done.err


def test_the_time_left_is_that_of_the_pace_so_far(tmp_path):
    plan = planned(cluster(1), tmp_path, ["run.yaml"], shares(1))
    (task,) = plan.tasks
    plan = replace(plan, tasks=(replace(task, job="7"),))
    folder = ResultFolder(plan.folder(task) / "results" / "tiny")
    for number, stamp in enumerate(("2026-01-01T00:00:00Z", "2026-01-01T00:00:30Z", "2026-01-01T00:02:00Z")):
        (each,) = state.task_states(plan, {"7": state.RUNNING})
        assert each.left_s == (None if number < 2 else 60.0)  # 30 s a cell, two of four to come
        folder.write_cell(cell(f"m{number}", measured=stamp))
    (each,) = state.task_states(plan, {"7": state.RUNNING})
    assert (each.cells, each.left_s) == (3, 60.0)


def test_cells_that_are_refused_at_once_tell_no_pace(tmp_path):
    """Eight of them came within a second, and a task with fifty cells to measure had "1 s left"."""
    plan = planned(cluster(1), tmp_path, ["run.yaml"], shares(1))
    (task,) = plan.tasks
    plan = replace(plan, tasks=(replace(task, job="7"),))
    folder = ResultFolder(plan.folder(task) / "results" / "tiny")
    refused = {"status": "unsupported", "time_ms": None}
    for name, second, more in (("a", 0, refused), ("b", 1, {}), ("c", 1, {})):
        folder.write_cell(cell(name, measured=f"2026-01-01T00:00:{second:02}Z", **more))
        (each,) = state.task_states(plan, {"7": state.RUNNING})
        assert each.left_s is None
