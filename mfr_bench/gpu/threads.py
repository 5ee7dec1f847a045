"""Gives each thread of a software rasterizer processors of its own.

Linux wakes the threads of a short frame where they ran last, and evens out the load only after some milliseconds: both
threads of a machine of two cores often share one, for seconds at a time, and such a frame takes up to 1.8 times as
long.
"""

from __future__ import annotations

import os
import re
from contextlib import suppress
from pathlib import Path

TASKS = Path("/proc/self/task")  # Linux: a folder for each thread of this process
RASTERIZER = re.compile(r"llvmpipe-(\d+)\s*$")  # as Mesa names the threads of llvmpipe, and those of lavapipe


def spread_rasterizers() -> int:
    """Bind the threads of Mesa's software rasterizers, and only these, each to its share of the usable processors.

    Returns how many were bound: 0 on other drivers and systems, where there is one processor, and where the system
    refuses it.
    """
    if not hasattr(os, "sched_setaffinity"):
        return 0
    numbers = _rasterizers()
    cpus = sorted(os.sched_getaffinity(0))
    of_each = shares(1 + max(numbers.values(), default=-1), cpus)
    return sum(_bind(thread, of_each[number]) for thread, number in numbers.items()) if len(cpus) > 1 else 0


def shares(threads: int, cpus: list[int]) -> list[set[int]]:
    """The processors of each thread: all of them are dealt out, as evenly as can be; more threads than these share."""
    if threads >= len(cpus):
        return [{cpus[thread % len(cpus)]} for thread in range(threads)]
    return [set(cpus[thread::threads]) for thread in range(threads)]


def _rasterizers() -> dict[int, int]:
    """The number of each rasterizer's thread among those of its rasterizer, by the id of the thread."""
    found = {}
    for folder in TASKS.iterdir() if TASKS.is_dir() else ():
        with suppress(OSError):  # a thread that has ended meanwhile
            if named := RASTERIZER.match((folder / "comm").read_text()):
                found[int(folder.name)] = int(named[1])
    return found


def _bind(thread: int, cpus: set[int]) -> bool:
    try:
        os.sched_setaffinity(thread, cpus)
    except OSError:
        return False
    return True
