"""The hold on a worker process: what becomes of one that dies, lies, or does not end."""

from __future__ import annotations

import os
import signal
import time

import pytest

from mfr_bench.run import process as processes
from mfr_bench.run.process import Died, Worker

OPENING = ("import os, signal, sys, time; from multiprocessing.connection import Connection; "
           "fd = int(sys.argv[1]); link = Connection(fd); ")
CAUSE = ("timeout", "no end")


@pytest.fixture
def worker(monkeypatch):
    """worker(code) -> a worker that runs this instead of measuring; `fd` is its end of the link."""
    made = []

    def started(code: str) -> Worker:
        monkeypatch.setattr(processes, "PROGRAM", OPENING + code)
        made.append(Worker("auto"))
        return made[-1]
    yield started
    for one in made:
        os.kill(one.process.pid, signal.SIGKILL) if one.process.poll() is None else None
        one.close()


def end(worker: Worker) -> tuple[list, tuple[str, str]]:
    """Everything that it sends, and why it ends."""
    events = []
    while True:
        try:
            event = worker.receive(0.1)
        except Died as death:
            return events, death.cause
        events += [] if event is None else [event]


@pytest.mark.parametrize(("code", "status", "reason"), [
    ("os.kill(os.getpid(), signal.SIGABRT)", "crashed", "killed by SIGABRT"),
    ("sys.exit(4)", "crashed", "ended with exit status 4"),
    ("print('fine'); print('LLVM  ERROR: out of\\tmemory\\n\\n', file=sys.stderr); sys.stderr.flush(); os._exit(1)",
     "crashed", "ended with exit status 1: LLVM ERROR: out of memory"),
    ("raise ValueError('mine')", "crashed", "ended with exit status 1: ValueError: mine"),
])
def test_a_death_says_how_and_with_which_last_words(worker, code, status, reason):
    assert end(worker(code)) == ([], (status, reason))


def test_one_that_is_given_up_is_waited_for_no_longer_than_for_what_it_has_sent(worker):
    """Its end may take the kernel seconds, and a process that it has started holds the link as long as it likes."""
    one = worker("link.send('a'); import subprocess; "
                 "subprocess.Popen(['sleep', '1000'], pass_fds=[fd], start_new_session=True); time.sleep(1000)")
    assert one.receive(60) == "a"
    one.abandon()
    assert end(one) == ([], ("crashed", "the run has ended"))


def test_what_was_sent_before_a_death_is_received_first(worker):
    events, cause = end(worker("link.send('a'); link.send('b'); os.kill(os.getpid(), 11)"))
    assert (events, cause) == (["a", "b"], ("crashed", "killed by SIGSEGV"))


@pytest.mark.parametrize("code", ["os.write(fd, b'\\0\\0\\0\\4junk')", "os.write(fd, b'\\0\\0\\1\\0half')"])
def test_a_message_that_makes_no_sense_is_a_death(worker, code):
    events, (status, _) = end(worker(code))
    assert (events, status) == ([], "crashed")


def test_a_worker_that_is_killed_ends_for_the_cause_given_first(worker):
    one = worker("time.sleep(600)")
    one.kill(CAUSE)
    one.kill(("crashed", "later"))
    assert end(one) == ([], CAUSE)


def test_a_worker_that_the_kernel_does_not_let_go_is_given_up(worker, monkeypatch):
    one = worker("time.sleep(600)")
    monkeypatch.setattr(processes, "END_S", 0.1)
    monkeypatch.setattr(one.process, "kill", lambda: None)
    one.kill(CAUSE)
    assert end(one) == ([], CAUSE)
    one.close()
    assert one.process.poll() is None


def test_ctrl_c_of_the_terminal_does_not_reach_it(worker):
    one = worker("time.sleep(600)")
    assert os.getsid(one.process.pid) == one.process.pid != os.getsid(0)


def test_memory_is_seen(worker):
    one = worker("held = b'x' * 2**26; link.send('held'); time.sleep(600)")
    while one.receive(0.1) != "held":
        time.sleep(0.01)
    assert 2**26 < one.resident_bytes() < 2**29
    one.kill(CAUSE)
    end(one)
    assert one.resident_bytes() == 0


def test_sending_to_the_dead_is_no_error(worker):
    one = worker("sys.exit(0)")
    one.process.wait()
    one.send("anything")
    one.send("anything")
    assert end(one)[1] == ("crashed", "ended with exit status 0")
