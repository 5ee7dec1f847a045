"""Main memory: what a process takes, what is free, whether the kernel has ended processes for lack of it."""

from __future__ import annotations

import os
from contextlib import suppress
from pathlib import Path

PAGE_BYTES = os.sysconf("SC_PAGE_SIZE")
FREE_SHARE = 0.8  # of the memory that is free when a run starts, for the process that measures
GROUP = Path("/sys/fs/cgroup")


def resident_bytes(pid: int) -> int:
    """Memory that a process uses; 0 if it is gone."""
    with suppress(OSError, ValueError, IndexError):
        return PAGE_BYTES * int(Path(f"/proc/{pid}/statm").read_text().split()[1])
    return 0


def free_bytes() -> float:
    """Memory that processes may still take, by the machine and by the container; infinite if neither reports it."""
    return min(_machine(), _container())


def _machine() -> float:
    with suppress(OSError, ValueError, StopIteration):
        lines = Path("/proc/meminfo").read_text().splitlines()
        return 1024.0 * int(next(line.split()[1] for line in lines if line.startswith("MemAvailable:")))
    return float("inf")


def _container() -> float:
    """The limit by version 2 of control groups; the group of a container appears as the root."""
    with suppress(OSError, ValueError):
        return float((GROUP / "memory.max").read_text()) - float((GROUP / "memory.current").read_text())
    return float("inf")


def kernel_kills() -> int:
    """Processes that the kernel has ended for lack of memory since the machine started."""
    with suppress(OSError, ValueError, StopIteration):
        lines = Path("/proc/vmstat").read_text().splitlines()
        return int(next(line.split()[1] for line in lines if line.startswith("oom_kill ")))
    return 0
