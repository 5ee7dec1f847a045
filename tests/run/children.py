"""Processes that a test starts, as the kernel shows them."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

from ..patience import until

ROOT = Path(__file__).parents[2]


def state(pid: int) -> str:
    """The letter of a process's state: T where it is stopped, Z where it has ended and nobody has asked how."""
    return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0]


def ends_with_its_parent(code: str) -> None:
    """Kill a process that runs the code, and fail where the one that it has started, whose id it prints, lives on."""
    process = subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, text=True, cwd=ROOT)
    pid = int(process.stdout.readline())
    process.kill()
    process.communicate()
    until(lambda: not Path(f"/proc/{pid}").exists() or state(pid) == "Z",
          f"process {pid} has outlived the one that it worked for")
