"""What a scheduler says of jobs decides nothing: stand-ins for Slurm's programs answer as the real ones did."""

from __future__ import annotations

import time
from dataclasses import replace

import pytest

from mfr_bench import environment
from mfr_bench.cluster import queue, state
from mfr_bench.cluster.settings import Cluster, Kind
from mfr_bench.store import ResultFolder

from ..cli.conftest import mfr  # noqa: F401
from ..store.test_store import cell
from .test_submission import cluster, planned, shares


@pytest.fixture
def program(tmp_path, monkeypatch):
    """Puts a shell script in the place of one of Slurm's programs."""
    monkeypatch.setenv("PATH", f"{tmp_path / 'bin'}:/usr/bin:/bin")
    (tmp_path / "bin").mkdir()

    def put(name, script):
        (tmp_path / "bin" / name).write_text(f"#!/bin/sh\n{script}\n")
        (tmp_path / "bin" / name).chmod(0o755)
    return put


@pytest.mark.parametrize(("said", "expected"), [
    ("COMPLETED", {}), ("CANCELLED", {}), ("NODE_FAIL", {}), ("TIMEOUT", {}), ("PREEMPTED", {}), ("UNKNOWN", {}),
    ("RUNNING", {"7_1": "running"}), ("COMPLETING", {"7_1": "running"}), ("PENDING", {"7_1": "waiting"}),
    ("REQUEUED", {"7_1": "waiting"}), ("SUSPENDED", {"7_1": "waiting"})])
def test_a_job_is_there_while_slurm_may_run_it(program, said, expected):
    program("squeue", f"printf '7_0|RUNNING\\n7_1|{said}\\n8|RUNNING\\nnonsense\\n'")
    assert queue.states("slurm", ["7_1"]) == expected


def test_slurm_is_asked_for_these_jobs_whoever_submitted_them(program, tmp_path):
    program("squeue", f'echo "$@" >>{tmp_path}/asked')
    assert queue.states("slurm", ["7_1", "7_0", "12"]) == {} == queue.states("slurm", ["7_0"])
    first, second = (tmp_path / "asked").read_text().splitlines()
    assert "--jobs=12,7,12 " in first and "--me" not in first and "--user" not in first
    assert "--jobs=7,7 " in second  # of one job alone that is gone squeue makes an error


@pytest.mark.parametrize("script", ["exit 1", "echo 'slurm_load_jobs error' >&2; exit 1", "exec sleep 60"])
def test_a_slurm_that_does_not_answer_is_not_waited_for_and_nothing_is_submitted_twice(program, tmp_path, monkeypatch,
                                                                                      script):
    monkeypatch.setattr(environment, "PATIENCE_S", 0.5)
    program("squeue", script)
    begun = time.monotonic()
    jobs = queue.states("slurm", ["7_1"])
    assert jobs is None and time.monotonic() - begun < 30
    plan = planned(cluster(1), tmp_path, ["run.yaml"], shares(1))
    plan = replace(plan, tasks=tuple(replace(task, job="7_1") for task in plan.tasks))
    found = state.task_states(plan, jobs)
    assert [each.state for each in found] == [state.UNKNOWN] and not state.wanting(found)


@pytest.mark.parametrize(("written", "job", "expected"), [
    (4, {}, state.DONE), (4, None, state.DONE), (4, {"7_1": "running"}, state.DONE), (3, {}, state.ENDED),
    (0, {}, state.ENDED), (3, {"7_1": "waiting"}, state.WAITING)])
def test_a_task_is_done_if_its_cells_are_there_and_only_then(tmp_path, written, job, expected):
    plan = planned(cluster(1), tmp_path, ["run.yaml"], shares(1))
    plan = replace(plan, tasks=tuple(replace(task, job="7_1") for task in plan.tasks))
    folder = ResultFolder(plan.folder(plan.tasks[0]) / "results" / "tiny")
    for number in range(written):
        folder.write_cell(cell(f"m{number}"))
    (found,) = state.task_states(plan, job)
    assert found.state == expected and bool(state.wanting([found])) == (expected == state.ENDED)


@pytest.mark.parametrize(("reason", "said", "status"), [
    ("Resources", "waiting (Resources)", 0),
    ("launch failed requeued held", "waiting (launch failed requeued held)", 1),
    ("JobHeldUser", "waiting (JobHeldUser)", 1), ("None", "waiting  job 7_1", 0)])
def test_what_a_task_waits_for_is_told(program, tmp_path, mfr, reason, said, status):  # noqa: F811
    program("squeue", f"case $* in *%T) echo '7_1|PENDING';; *) echo '7_1|{reason}';; esac")
    program("sinfo", "exit 1")
    plan = planned(Cluster(engine="slurm", store="s", kinds={"cpu": Kind()}), tmp_path, ["run.yaml"], shares(1))
    replace(plan, tasks=tuple(replace(task, job="7_1") for task in plan.tasks)).write()
    done = mfr("status", tmp_path)
    assert done.status == status and said in done.out
    assert ("'scontrol release 7_1' lets a job go on" in done.err) == bool(status)


def test_nodes_that_slurm_has_taken_out_are_told_with_the_reason(program):
    program("sinfo", "printf 'n[2-3]|drained|batch job complete failure\\nn4|down*|Not responding\\n'")
    assert queue.drained_nodes() == ["node n[2-3] is drained: batch job complete failure",
                                     "node n4 is down*: Not responding"]
    program("sinfo", "exit 1")
    assert queue.drained_nodes() == []
