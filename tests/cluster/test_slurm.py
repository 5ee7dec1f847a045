"""The real engine: Slurm's daemons on this machine, with llvmpipe as the device of each node.

`make test-cluster` runs it; it needs root and Debian's packages slurmctld, slurmd, slurm-client and munge. Whatever
Slurm does to a job, no row is lost and none is measured twice.
"""

from __future__ import annotations

import csv
import json
import os
import random
import signal
import subprocess
import time
from contextlib import suppress
from pathlib import Path

import pytest

from mfr_bench.store import ResultFolder
from mfr_bench.store.journal import Journal

from ..cli.conftest import apart

pytestmark = pytest.mark.skipif(os.environ.get("MFR_BENCH_SLURM") != "1", reason="needs Slurm: make test-cluster")

SCRIPT = Path(__file__).parents[2] / "scripts" / "slurm.sh"
NODES = 4
SHARES = 4
LIMIT_S = 600
EVENTS = int(os.environ.get("MFR_BENCH_SLURM_EVENTS", "12"))  # of the campaign
RUN = """\
name: tiny
title: Tiny
scene: {size: [64, 64], depth_complexity: 8}
methods: [ab-array, ab-ll, kplus-array]
params: {k: 4}
sweep: {scene.depth_complexity: [8, 12, 16, 20, 24, 28, 32, 36]}
measure: {target_rel_ci: 0.001, min_samples: 20, max_samples: 2000, time_limit_s: 1}
"""
CELLS = 8 * 4
CLUSTER = """\
engine: slurm
store: store
kinds: {{cpu: {{shares: {shares}, device: cpu, minutes: {minutes}, cpus: 1, partition: low, gres: 'gpu:1'}}}}
"""


def slurm(*arguments):
    return subprocess.run(list(map(str, arguments)), capture_output=True, text=True, check=False, timeout=60).stdout


@pytest.fixture(scope="module")
def engine(tmp_path_factory):
    at = tmp_path_factory.mktemp("slurm")
    subprocess.run([SCRIPT, "start", at, str(NODES)], check=True, timeout=120)
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("SLURM_CONF", str(at / "slurm.conf"))
        yield at
    subprocess.run([SCRIPT, "stop", at], check=False, timeout=60)


@pytest.fixture
def place(engine, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "run.yaml").write_text(RUN)
    (tmp_path / "cluster.yaml").write_text(CLUSTER.format(shares=SHARES, minutes=10))
    yield tmp_path
    slurm("scancel", "--me", "--full")
    slurm("scontrol", "update", f"nodename=n[1-{NODES}]", "state=resume")


def submit():
    done = apart("submit", "run.yaml", "--cluster", "cluster.yaml")
    assert done.status == 0, done.err
    return done


def cells(place):
    """The moment at which each cell was measured, by task and key."""
    found = {}
    for path in place.glob("store/tasks/*/results/cells/*.json"):
        found[path.parts[-4], path.stem] = json.loads(path.read_text())["measured"]
    return found


def until(true, what):
    ends = time.monotonic() + LIMIT_S
    while not (found := true()):
        assert time.monotonic() < ends, f"not in time: {what}\n{slurm('squeue')}{apart('status', 'store').out}"
        time.sleep(1)
    return found


def hurry():
    """Let jobs begin that Slurm has queued again, for which it would wait two minutes, or held, as status says how to.

    A node that comes back while it still ends a job refuses to begin it: Slurm holds the job, and drains the node.
    """
    for line in slurm("squeue", "--noheader", "--states=pending", "--format=%A|%r").splitlines():
        job, _, reason = line.partition("|")
        if reason == "BeginTime":
            slurm("scontrol", "update", f"jobid={job}", "starttime=now")
        elif reason.endswith("held"):
            slurm("scontrol", "release", job)


def finish(place):
    """Submit what has ended until all is done; what was measured before must stand as it was."""
    before = cells(place)

    def done():
        hurry()
        if apart("status", "store").status == 1:
            submit()
        return f"{SHARES} of {SHARES} tasks done" in apart("status", "store").out

    until(done, "the end of all tasks")
    after = cells(place)
    assert before.items() <= after.items() and len(after) == CELLS
    assert len({key for _, key in after}) == CELLS
    merged = apart("collect", "store", "--into", "merged")
    assert merged.status == 0 and f"merged: cells: {CELLS}," in merged.out, merged.err
    with open(place / "merged" / "results.csv", newline="", encoding="utf-8") as file:
        assert len(list(csv.DictReader(file))) == CELLS


def running(place):
    """Jobs that run, once some cell is measured."""
    submit()
    until(lambda: len(cells(place)) >= 2, "the first cells")
    return slurm("squeue", "--noheader", "--array", "--states=running", "--format=%i").split()


def processes():
    """The command line of each process."""
    found = {}
    for entry in filter(lambda entry: entry.name.isdecimal(), Path("/proc").iterdir()):
        with suppress(OSError):
            found[int(entry.name)] = (entry / "cmdline").read_bytes().decode(errors="replace")
    return found


def processes_of(place):
    return [number for number, said in processes().items() if f"{place}/store/" in said]


def all_below(number):
    """The children of a process, their children and so on."""
    with suppress(OSError):
        mine = Path(f"/proc/{number}/task/{number}/children").read_text().split()
        return [each for child in map(int, mine) for each in (child, *all_below(child))]
    return []


def daemon(engine, node):
    return int((engine / f"slurmd.{node}.pid").read_text())


def requeue(place, jobs, rng):
    slurm("scontrol", "requeue", rng.choice(jobs))


def cancel(place, jobs, rng):
    slurm("scancel", rng.choice(jobs))


def kill(place, jobs, rng):
    processes = processes_of(place)
    if processes:
        os.kill(rng.choice(processes), signal.SIGKILL)


def drain(place, jobs, rng):
    node = f"n{rng.randint(1, NODES)}"
    slurm("scontrol", "update", f"nodename={node}", "state=down", "reason=test")
    time.sleep(2)
    slurm("scontrol", "update", f"nodename={node}", "state=resume")


@pytest.mark.parametrize("event", [requeue, cancel, kill, drain])
def test_nothing_is_lost_and_nothing_measured_twice(place, event):
    jobs = running(place)
    event(place, jobs, random.Random(1))  # noqa: S311
    finish(place)


def test_a_preempted_task_goes_on(place):
    running(place)
    slurm("sbatch", "--partition=high", f"--nodes={NODES}", "--ntasks-per-node=1", "--gres=gpu:1", "--output=/dev/null",
          "--wrap=sleep 3")
    finish(place)


def test_a_time_limit_costs_no_cell(place):
    (place / "cluster.yaml").write_text(CLUSTER.format(shares=1, minutes=1))
    submit()
    until(lambda: "1 of 1 tasks done" in apart("status", "store").out or
          (apart("status", "store").status == 1 and submit()), "the end of the task")
    assert len(cells(place)) == CELLS


def test_a_task_whose_node_cannot_start_it_is_not_done(place, engine):
    """Slurm drains the node, queues the job again, and holds it."""
    spool, aside = engine / "spool" / "n1", engine / "spool" / "aside"
    spool.rename(aside)
    spool.write_text("")
    try:
        submit()
        said = until(lambda: (said := apart("status", "store")).status == 1 and said, "a task that waits for somebody")
        assert "Slurm holds 1 task: launch failed requeued held; 'scontrol release 1" in said.err, said.out + said.err
        slurm("scancel", said.err.partition("scontrol release ")[2].partition("'")[0])
    finally:
        spool.unlink()
        aside.rename(spool)
    finish(place)


def test_a_node_that_vanishes_costs_its_cells_alone(place, engine):
    running(place)
    (job,) = slurm("squeue", "--noheader", "--nodelist=n1", "--format=%A").split()
    steps = [number for number, said in processes().items() if f"slurmstepd: [{job}." in said]
    for number in (*steps, *(below for step in steps for below in all_below(step)), daemon(engine, "n1")):
        os.kill(number, signal.SIGKILL)
    until(lambda: "node n1 is down" in apart("status", "store").err, "Slurm to miss the node")
    finish(place)
    subprocess.run(["slurmd", "-N", "n1", "-f", engine / "slurm.conf"], check=True, timeout=60)
    until(lambda: "n1" in slurm("sinfo", "--noheader", "--Node", "--states=idle", "--format=%N"), "the node again")


def test_a_requeued_task_goes_on_within_a_cell(place):
    (place / "run.yaml").write_text(RUN.replace("max_samples: 2000, time_limit_s: 1", "max_samples: 3000, "
                                                "time_limit_s: 60").replace("min_samples: 20", "min_samples: 3000")
                                    .replace("[8, 12, 16, 20, 24, 28, 32, 36]", "[8]"))
    (place / "cluster.yaml").write_text(CLUSTER.format(shares=1, minutes=10))
    submit()
    path = place / "store" / "tasks" / "cpu-1" / "results" / "unfinished.jsonl"
    until(lambda: any(each.samples_ms for each in Journal(path).partials.values()), "the first samples")
    slurm("scontrol", "requeue", *slurm("squeue", "--noheader", "--format=%A").split())
    until(lambda: not processes_of(place), "the end of the run")
    before = {key: each.samples_ms for key, each in Journal(path).partials.items() if each.samples_ms}
    assert before
    until(lambda: hurry() or "1 of 1 tasks done" in apart("status", "store").out, "the end of the task")
    after = {each["key"]: each for each in ResultFolder(path.parent).cells()}
    for key, samples in before.items():
        assert after[key]["samples_ms"][:len(samples)] == samples and after[key]["values"]["sessions"] == 2
    assert {each["values"]["samples"] for each in after.values()} == {3000}


def test_a_drained_node_is_reported(place):
    slurm("scontrol", "update", "nodename=n2", "state=drain", "reason=fan")
    submit()
    assert "node n2 is drain" in apart("status", "store").err and "fan" in apart("status", "store").err
    slurm("scontrol", "update", "nodename=n2", "state=resume")
    finish(place)


def test_a_gpu_that_slurm_gives_and_egl_has_not_is_told(place):
    (place / "cluster.yaml").write_text(CLUSTER.format(shares=1, minutes=10).replace("device: cpu", "device: gpu"))
    submit()
    until(lambda: apart("status", "store").status == 1, "the end of the task")
    (said,) = (path.read_text() for path in place.glob("store/logs/*/*_log.err"))
    assert "SLURM_STEP_GPUS=0, CUDA_VISIBLE_DEVICES=0: gives this process no GPU of those that EGL can open" in said


def test_results_can_be_collected_while_tasks_run(place):
    running(place)
    done = apart("collect", "store", "--into", "merged")
    assert done.status == 0 and 0 < len(list((place / "merged" / "cells").glob("*.json"))) <= CELLS
    finish(place)


def test_a_campaign_of_random_events(place):
    rng = random.Random(7)  # noqa: S311
    submit()
    for _ in range(EVENTS):
        time.sleep(rng.uniform(0.5, 3))
        if apart("status", "store").status == 1:
            submit()
        jobs = slurm("squeue", "--noheader", "--array", "--states=running", "--format=%i").split()
        if jobs:
            rng.choice([requeue, cancel, kill, drain])(place, jobs, rng)
    finish(place)
