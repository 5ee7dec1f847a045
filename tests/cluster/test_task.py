"""A task on a node: what ends it ends its children, and nothing else does."""

import copy
import os
import signal
import subprocess
import sys
import time

import pytest

from mfr_bench.cluster.task import Task

SLEEPER = """
import subprocess, sys, time
child = subprocess.Popen([sys.executable, "-c", "import time; time.sleep(600)"])
print(child.pid, file=open(sys.argv[1], "w"), flush=True)
time.sleep(600)
"""
RUNNER = "import sys; from mfr_bench.cluster.task import Task; sys.exit(Task(sys.argv[1:])())"
LIMIT_S = 60


def until(true):
    ends = time.monotonic() + LIMIT_S
    while not true():
        assert time.monotonic() < ends, "nothing happened in time"
        time.sleep(0.05)


def alive(pid):
    try:
        with open(f"/proc/{pid}/stat", encoding="utf-8") as file:
            return file.read().rpartition(")")[2].split()[0] != "Z"
    except FileNotFoundError:
        return False


@pytest.fixture
def node(tmp_path):
    """A process that runs a task whose run has a child, as submitit's worker does: it and the child's number."""
    said = tmp_path / "pid"
    process = subprocess.Popen([sys.executable, "-c", RUNNER, sys.executable, "-c", SLEEPER, str(said)])
    until(lambda: said.exists() and said.read_text().strip())
    yield process, int(said.read_text())
    process.kill()
    process.wait()


def test_the_status_is_the_commands():
    assert Task([sys.executable, "-c", "import sys; sys.exit(3)"])() == 3


def test_a_copy_of_a_task_has_its_command_alone():
    assert copy.deepcopy(Task(["a", "b"])).command == ["a", "b"]


def test_sigterm_ends_the_whole_group(node):
    process, child = node
    os.kill(process.pid, signal.SIGTERM)
    until(lambda: process.poll() is not None and not alive(child))


def test_a_checkpoint_ends_the_run_and_asks_to_go_on(tmp_path):
    said = tmp_path / "pid"
    task = Task([sys.executable, "-c", SLEEPER, str(said)])

    def asked(number, frame):
        raise TimeoutError

    before = signal.signal(signal.SIGALRM, asked)
    try:
        signal.setitimer(signal.ITIMER_REAL, 3)
        with pytest.raises(TimeoutError):
            task()
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)
    again = task.checkpoint()
    assert again.function.command == task.command
    if said.exists() and said.read_text().strip():
        until(lambda: not alive(int(said.read_text())))
