"""Ctrl-C while a device is at work: a wish first, an order the second time."""

import signal
import subprocess
import sys
from types import SimpleNamespace

import pytest

from mfr_bench.cli.interruption import Interruption
from mfr_bench.cli.method_commands import _carried_out
from mfr_bench.cli.progress import STOPPING, Progress

from .conftest import apart, sabotaged

WATCHED = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
SIGNALS = pytest.mark.parametrize("number", WATCHED, ids=lambda s: s.name)


@pytest.fixture(autouse=True)
def usual():
    """The handlers of a process that was just started; pytest's afterwards."""
    former = {number: signal.getsignal(number) for number in WATCHED}
    for number in WATCHED:
        signal.signal(number, signal.default_int_handler if number == signal.SIGINT else signal.SIG_DFL)
    yield
    for number, handler in former.items():
        signal.signal(number, handler)


def at_work(*signals, reached, error=None):
    """Work during which the signals come, one after another; it may end by an error of its own."""
    with Interruption() as interruption:
        for number in signals:
            signal.raise_signal(number)
            reached.append(interruption.asked())
        if error:
            raise error


@SIGNALS
def test_the_first_is_a_wish(number):
    reached = []
    with pytest.raises(KeyboardInterrupt):
        at_work(number, reached=reached)
    assert reached == [True]  # it went on: only leaving raises


@SIGNALS
def test_the_second_is_an_order(number):
    reached = []
    with pytest.raises(KeyboardInterrupt):
        at_work(signal.SIGINT, number, reached=reached)
    assert reached == [True]


def test_a_check_of_ones_own_ends_behind_the_part_in_which_it_came(capsys):
    """Parts take seconds each, and a method has some twenty."""
    begun = []

    def part():
        begun.append("part")
        signal.raise_signal(signal.SIGINT)
        return ()

    with pytest.raises(KeyboardInterrupt), Interruption(device_here=True) as interruption:
        _carried_out([("the first", part), ("the second", part)], interruption.asked)
    assert begun == ["part"] and capsys.readouterr().out == "ok        the first\n"


def test_the_second_ends_the_process_that_has_the_device():
    """An exception could be raised within the bindings' C code, which crashes."""
    at_work = """import signal
from mfr_bench.cli.interruption import Interruption
with Interruption(device_here=True):
    signal.raise_signal(signal.SIGINT)
    print("goes on", flush=True)
    signal.raise_signal(signal.SIGINT)
    print("never reached", flush=True)"""
    ended = subprocess.run([sys.executable, "-c", at_work], capture_output=True, text=True, check=False)
    assert (ended.returncode, ended.stdout, ended.stderr) == (130, "goes on\n", "interrupted\n")


def planned(reached):
    with Interruption() as interruption, interruption.at_once():
        reached.append("planning")
        signal.raise_signal(signal.SIGINT)
        reached.append("never")


def measured(reached):
    with Interruption() as interruption, interruption.at_once():
        with interruption.in_its_time():
            signal.raise_signal(signal.SIGINT)
            reached.append("measured")
        reached.append("never")


def foretold(reached):
    with Interruption() as interruption, interruption.at_once(), interruption.in_its_time():
        signal.raise_signal(signal.SIGINT)
        reached.append("goes on")
        with interruption.at_once():
            reached.append("never")


@pytest.mark.parametrize(("work", "until"), [(planned, "planning"), (measured, "measured"), (foretold, "goes on")])
def test_planning_and_drawing_end_at_the_first_and_measuring_in_its_time(work, until):
    """A wish that came while frames are drawn is obeyed before anything else is begun."""
    reached = []
    with pytest.raises(KeyboardInterrupt):
        work(reached)
    assert reached == [until]


def test_work_that_met_the_wish_ends_in_its_own_way():
    with pytest.raises(ValueError, match="mine"):
        at_work(signal.SIGINT, reached=[], error=ValueError("mine"))


def test_nothing_is_raised_without_a_wish_and_handlers_are_put_back():
    former = [signal.getsignal(number) for number in WATCHED]
    with Interruption() as interruption:
        assert signal.getsignal(signal.SIGTERM) is not signal.SIG_DFL
        assert not interruption.asked()
    assert [signal.getsignal(number) for number in WATCHED] == former


def test_ignored_signals_stay_ignored():
    """Signals are ignored so below nohup, and in the background of a script."""
    signal.signal(signal.SIGHUP, signal.SIG_IGN)
    with Interruption() as interruption:
        signal.raise_signal(signal.SIGHUP)
        assert not interruption.asked()


def test_progress_says_that_it_is_stopping():
    wish = []
    progress = Progress(3, "tiny", lambda: bool(wish))
    assert progress._line() == "tiny 0/3  starting"
    wish.append("stop")
    assert progress._line() == f"tiny 0/3  {STOPPING}"


@pytest.mark.parametrize(("until_s", "said"), [
    (50.0, "52 s left of the time budget"), (5000.0, "forecast: 4 min 00 s left"),
    (-3.0, "2 s left of the time budget")])
def test_progress_foretells_no_more_than_the_time_budget(monkeypatch, until_s, said):
    monkeypatch.setattr("mfr_bench.cli.progress.time.monotonic", lambda: 100.0)
    progress = Progress(3, "tiny", until=100.0 + until_s)
    progress.ahead = SimpleNamespace(left_s=lambda elapsed_s: 240.0, end_s=2.0, share=0.0)
    assert progress._line() == f"tiny 0/3, {said}  starting"


def test_ctrl_c_while_the_program_is_loaded_is_a_line(tmp_path):
    (tmp_path / "click.py").write_text("raise KeyboardInterrupt")
    ended = apart("--help", env=sabotaged(tmp_path, ""))
    assert (ended.status, ended.out, ended.err) == (130, "", "interrupted\n")
