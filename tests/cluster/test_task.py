"""A task on a node: what ends it ends its children, and nothing else does."""

import copy
import os
import signal
import subprocess
import sys
import threading

import pytest

from mfr_bench.cluster.task import Task

from ..patience import until

SLEEPER = """
import subprocess, sys, time
child = subprocess.Popen([sys.executable, "-c", "import time; time.sleep(600)"])
print(child.pid, file=open(sys.argv[1], "w"), flush=True)
time.sleep(600)
"""
DEAF = "import signal; signal.signal(signal.SIGTERM, signal.SIG_IGN)"
RUNNER = "import sys; from mfr_bench.cluster.task import Task; sys.exit(Task(sys.argv[1:])())"


def alive(pid):
    try:
        with open(f"/proc/{pid}/stat", encoding="utf-8") as file:
            return file.read().rpartition(")")[2].split()[0] != "Z"
    except FileNotFoundError:
        return False


def parent_of(pid):
    with open(f"/proc/{pid}/stat", encoding="utf-8") as file:
        return int(file.read().rpartition(")")[2].split()[1])


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


def test_a_run_ends_with_its_worker_though_that_is_killed(node):
    process, child = node
    run = parent_of(child)
    assert parent_of(run) == process.pid
    os.kill(process.pid, signal.SIGKILL)
    until(lambda: not alive(run))
    os.kill(child, signal.SIGKILL)  # a run ends its own children, as tests of it show; this stand-in does not


@pytest.fixture
def begun(tmp_path):
    """The file that a stand-in for a run writes its child's number to; then SIGALRM reaches this process."""
    said = tmp_path / "pid"
    waiter = threading.Thread(target=lambda: (until(lambda: said.exists() and said.read_text().strip()),
                                              os.kill(os.getpid(), signal.SIGALRM)))
    before = signal.getsignal(signal.SIGALRM)
    waiter.start()
    yield said
    waiter.join()
    signal.signal(signal.SIGALRM, before)


def test_a_run_that_does_not_end_when_asked_is_killed(begun, monkeypatch):
    monkeypatch.setattr("mfr_bench.cluster.task.PATIENCE_S", 0.5)
    signal.signal(signal.SIGALRM, lambda number, frame: os.kill(os.getpid(), signal.SIGTERM))
    assert Task([sys.executable, "-c", DEAF + SLEEPER, str(begun)])() == -signal.SIGKILL
    until(lambda: not alive(int(begun.read_text())))


def test_a_checkpoint_ends_the_run_before_it_asks_to_go_on(begun):
    """submitit asks for it in a signal's handler, within the call of the task."""
    task = Task([sys.executable, "-c", SLEEPER, str(begun)])
    again = []

    def asked(number, frame):
        again.append((task.checkpoint(), task._child.poll()))
        raise TimeoutError

    signal.signal(signal.SIGALRM, asked)
    with pytest.raises(TimeoutError):
        task()
    ((delayed, status),) = again
    assert delayed.function.command == task.command and status is not None
    until(lambda: not alive(int(begun.read_text())))
