"""What a user sees at a terminal before a command has anything to say, and where lines are wider than the terminal."""

import io
import os
import subprocess
import sys
import time
from functools import cache
from types import SimpleNamespace

import pytest

from mfr_bench.cli import alive
from mfr_bench.cli.alive import ERASED, SignOfLife

from ..patience import PATIENCE_S, until
from .conftest import environment

# A second goes by between two looks at the clock, but for the first two.
AT_ONCE = """
import itertools, sys, types
from mfr_bench.cli import alive, main
alive.SILENCE_S = 0.01
alive.time = types.SimpleNamespace(monotonic=itertools.chain([0], itertools.count()).__next__)
sys.argv[1:] = {!r}
main()
"""


@cache
def seen(*arguments, piped=False):
    """All that a terminal of 60 columns gets of a command; piped: its stdout goes elsewhere."""
    ours, theirs = os.openpty()
    out = subprocess.PIPE if piped else theirs
    with subprocess.Popen([sys.executable, "-c", AT_ONCE.format(list(arguments))], stdin=subprocess.DEVNULL, stdout=out,
                          stderr=theirs, env=environment(COLUMNS="60", TERM="xterm")) as process:
        os.close(theirs)
        text = b""
        try:
            while part := os.read(ours, 2**16):
                text += part
        except OSError:  # the other end is closed
            os.close(ours)
        process.communicate(timeout=PATIENCE_S)
    return text.decode().replace("\r\n", "\n")


def test_a_silent_command_shows_that_it_is_at_work_until_it_prints():
    signs, _, printed = seen("stress", "--list").rpartition(ERASED)
    shown = signs.split(ERASED)[1:]
    assert shown == [f"mfr-bench stress: at work, {second} s" for second in range(len(shown))] != []
    assert printed.startswith("accumulation  ")


def test_lines_of_two_columns_fit_a_narrow_terminal():
    lines = seen("stress", "--list").rpartition(ERASED)[2].splitlines()
    names = [line for line in lines if not line.startswith(" ")]
    place = len(names[0]) - len(names[0].split(None, 1)[1])
    assert max(map(len, lines)) <= 60
    assert len(lines) > len(names) and all(line[:place].isspace() for line in lines if line not in names)


@pytest.mark.parametrize("arguments", [["stress", "--help"], ["stress", "--list", "--quiet"]], ids=" ".join)
def test_who_asks_for_help_or_quiet_sees_no_sign(monkeypatch, arguments):
    monkeypatch.setattr(alive, "_is_watched", lambda: True)
    monkeypatch.setattr(sys, "argv", ["mfr-bench", *arguments])
    alive.begin("stress")
    assert alive._sign is None


def test_a_reader_of_a_pipe_has_the_terminal_for_itself():
    assert seen("meshes", piped=True) == ""


def test_nothing_is_written_after_the_end(monkeypatch):
    monkeypatch.setattr(alive, "time", SimpleNamespace(monotonic=lambda: 5.0))
    stream = io.StringIO()
    sign = SignOfLife("work", stream, 0.001)
    until(stream.getvalue)
    sign.end()
    sign.end()
    ended = stream.getvalue()
    time.sleep(0.01)
    assert stream.getvalue() == ended and ended.startswith(f"{ERASED}work: at work, 0 s")
    assert ended.endswith(ERASED) and not ended.endswith(2 * ERASED)
