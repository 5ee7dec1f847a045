"""A process that stands by: it serves what it is told, and outlives nobody."""

from __future__ import annotations

import os
import signal
from pathlib import Path

import pytest

from mfr_bench.run import standby as module
from mfr_bench.run.standby import Standby

from . import fake_first_frames as fake
from .children import ends_with_its_parent


def test_it_serves_what_it_is_told():
    standby = Standby()
    process, link = standby.begin(fake.answers, 7.0)
    try:
        link.send(fake.Cell("cell"))
        assert link.recv() == ("cell", 7.0)
    finally:
        process.kill()
        process.join()


def test_one_that_is_not_needed_ends():
    standby = Standby()
    pid = standby._process.pid
    standby.end()
    standby.end()
    assert not Path(f"/proc/{pid}").exists()
    with pytest.raises(OSError):
        standby.begin(fake.answers, 7.0)


def test_one_that_was_killed_cannot_begin():
    standby = Standby()
    os.kill(standby._process.pid, signal.SIGKILL)
    standby._process.join()
    with pytest.raises(OSError):
        standby.begin(fake.answers, 7.0)


def test_where_there_can_be_no_process_there_is_none(monkeypatch):
    def none(*_):
        raise BlockingIOError

    monkeypatch.setattr(module, "_begun", none)
    standby = Standby()
    standby.end()
    with pytest.raises(OSError):
        standby.begin(fake.answers, 7.0)


STANDS_BY = """
import time
from mfr_bench.run.standby import Standby
standby = Standby()
print(standby._process.pid, flush=True)
time.sleep(60)
"""


def test_it_ends_with_a_process_that_is_killed():
    ends_with_its_parent(STANDS_BY)
