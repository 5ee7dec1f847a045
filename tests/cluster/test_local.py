"""A run submitted to processes of this machine: every cell once, ended tasks queued again, results merged."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import time
from contextlib import suppress
from pathlib import Path

import pytest

from ..cli.conftest import TINY, apart, command, environment

LIMIT_S = 240
RUN = TINY.replace("sweep: {", "sweep: {scene.depth_complexity: [2, 3], ").replace("methods: [ab-array, kplus-array]",
                                                                                   "methods: [ab-array]")
CLUSTER = "engine: local\nstore: store\nkinds: {cpu: {shares: 2, device: cpu}}\n"
CELLS = 4  # the floor and ab-array in two scenes


@pytest.fixture
def place(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "run.yaml").write_text(RUN.replace("sweep: {scene.depth_complexity: [2, 3], k: [2, 4]}",
                                                   "sweep: {scene.depth_complexity: [2, 3]}"))
    (tmp_path / "cluster.yaml").write_text(CLUSTER)
    return tmp_path


def processes_with(path):
    """The processes of the engine: their command lines name the folder of its logs."""
    found = []
    for entry in Path("/proc").iterdir():
        with suppress(OSError):
            if entry.name.isdecimal() and str(path).encode() in (entry / "cmdline").read_bytes():
                found.append(int(entry.name))
    return found


def until_done(*, done=True):
    ends = time.monotonic() + LIMIT_S
    while time.monotonic() < ends:
        said = apart("status", "store")
        if ("2 of 2 tasks done" in said.out) if done else "running" not in said.out:
            return said
        time.sleep(0.5)
    raise AssertionError(f"not in time: {said.out}{said.err}")


def test_from_submitting_to_one_set(place):
    first = apart("submit", "run.yaml", "--cluster", "cluster.yaml")
    assert first.status == 0 and "2 of 2 tasks submitted" in first.out, first.err
    found = processes_with(place / "store" / "logs")
    assert found
    for number in found:
        os.kill(number, signal.SIGKILL)
    ended = until_done(done=False)
    assert ended.status == 1 and "ended without all their cells" in ended.err
    again = apart("submit", "run.yaml", "--cluster", "cluster.yaml")
    assert "2 of 2 tasks submitted" in again.out, again.out + again.err
    done = until_done()
    assert done.status == 0 and f"{CELLS} of {CELLS} cells" in done.out
    merged = apart("collect", "store", "--into", "merged")
    assert merged.status == 0 and f"merged: cells: {CELLS}," in merged.out, merged.err
    assert "0 of 2 tasks submitted" in apart("submit", "run.yaml", "--cluster", "cluster.yaml").out


def test_a_terminal_that_closes_ends_no_task(place):
    """Its kernel hangs up on the processes of the session that `submit` was in; Slurm's jobs are in none of it."""
    submitted = subprocess.Popen(command("submit", "run.yaml", "--cluster", "cluster.yaml"), env=environment(),
                                 stdout=subprocess.PIPE, text=True, start_new_session=True)
    said, _ = submitted.communicate(timeout=LIMIT_S)
    assert submitted.returncode == 0 and "2 of 2 tasks submitted" in said
    assert all(os.getsid(number) != submitted.pid for number in processes_with(place / "store" / "logs"))
    with suppress(ProcessLookupError):  # nobody is left to hang up on
        os.killpg(submitted.pid, signal.SIGHUP)
    assert until_done().status == 0


def test_a_store_takes_one_run(place):
    (place / "store").mkdir()
    (place / "store" / "submission.json").write_text(json.dumps({
        "schema": 1, "engine": "local", "run": ["other.yaml"], "tasks": []}))
    done = apart("submit", "run.yaml", "--cluster", "cluster.yaml")
    assert done.status == 2 and "holds the run 'other.yaml' of local" in done.err


def test_a_dry_run_prints_what_does_the_same_by_hand(place):
    done = apart("submit", "run.yaml", "--cluster", "cluster.yaml", "--dry-run")
    assert done.status == 0 and done.out.count(" --shard ") == 2 and not (place / "store").exists()
    assert "--device cpu" in done.out and "store/tasks/cpu-2/results" in done.out


def test_a_folder_that_is_no_store_is_one_line(place):
    for name in ("status", "collect"):
        done = apart(name, "nowhere")
        assert done.status == 2 and done.err.startswith("nowhere: nothing was submitted into it")
