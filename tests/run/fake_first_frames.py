"""Other ends of a `Precompiler` that draw nothing; a job may be any value with a `key`."""

from __future__ import annotations

import fcntl
import os
import time
from dataclasses import dataclass

from mfr_bench.run.parent import live_for


@dataclass(frozen=True)
class Cell:
    key: str


def answers(link, parent, spent_s: float) -> None:
    """Answer at once that each cell took so long."""
    live_for(parent)
    while True:
        if not isinstance(message := link.recv(), str):
            link.send((message.key, spent_s))


def dies(link, parent) -> None:
    link.recv()
    os._exit(1)


def hangs(link, parent) -> None:
    live_for(parent)
    time.sleep(600)


def locks(link, parent, path: str, held_s: float) -> None:
    """Lock a file again and again, each time for so long, and leave it alone a third of that between."""
    live_for(parent)
    handle = os.open(path, os.O_RDWR | os.O_CREAT)
    link.send((link.recv().key, 0.0))
    while True:
        fcntl.flock(handle, fcntl.LOCK_EX)
        _work(held_s)
        fcntl.flock(handle, fcntl.LOCK_UN)
        _work(held_s / 3)


def _work(for_s: float) -> None:
    end = time.monotonic() + for_s
    while time.monotonic() < end:
        pass
