#!/usr/bin/env python3
"""Measures commands on large collections: time, processor time of all their processes, memory of the largest.

scripts/at_scale.py devices FOLDER [--count 1000]    simulated devices: make, merge, table, plot
scripts/at_scale.py cells FOLDER [--count 10000]     one folder of so many cells: table, plot, claims, compare
scripts/at_scale.py plan FOLDER [--count 100000]     a dry run of so many cells

Everything is written to FOLDER; the tables that commands print go to FOLDER/<command>.txt. Linux alone.
"""

from __future__ import annotations

import argparse
import os
import re
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import yaml
from ending import at_least, run_script

SIMULATE = (sys.executable, str(Path(__file__).with_name("simulate_devices.py")))
PROGRAM = (sys.executable, "-m", "mfr_bench")
COUNTS = {"devices": 1000, "cells": 10_000, "plan": 100_000}
METHODS = ("ab-array", "ab-ll", "kplus-array", "kplus-heap", "kb-ps", "mlab", "adaptive", "lin-pre", "peel-f2b",
           "kplus-sb")
DEPTHS = 20
EVERY_S = 0.2  # between two looks at the processes
TICKS = os.sysconf("SC_CLK_TCK")


def processes(root: int) -> Iterator[tuple[int, float, int]]:
    """A process and all below it: number, processor time in s, largest memory so far in KiB."""
    below: dict[int, list[tuple[int, float]]] = {}
    for path in Path("/proc").glob("[0-9]*/stat"):
        try:
            fields = path.read_text().rpartition(")")[2].split()
        except OSError:
            continue  # it has ended
        own = int(path.parent.name), (int(fields[11]) + int(fields[12])) / TICKS
        below.setdefault(int(fields[1]), []).append(own)
    found = [own for children in below.values() for own in children if own[0] == root]
    while found:
        number, cpu_s = found.pop()
        found += below.get(number, ())
        try:
            peak = re.search(r"VmHWM:\s+(\d+)", Path(f"/proc/{number}/status").read_text())
        except OSError:
            continue
        yield number, cpu_s, int(peak[1]) if peak else 0


def measured(name: str, folder: Path, *command: str) -> None:
    """Run a command in the folder and print a line on it."""
    started, cpu_s, most_kib = time.monotonic(), {}, 0
    with open(folder / f"{name}.txt", "w") as out, subprocess.Popen(command, cwd=folder, stdout=out) as running:
        while running.poll() is None:
            for number, spent_s, peak_kib in processes(running.pid):
                cpu_s[number], most_kib = spent_s, max(most_kib, peak_kib)
            time.sleep(EVERY_S)
    print(f"{name:10} {time.monotonic() - started:7.1f} s  processor {sum(cpu_s.values()):7.1f} s  largest process "
          f"{most_kib / 1024:6.0f} MiB  exit status {running.returncode}", flush=True)


def devices(folder: Path, count: int) -> None:
    measured("simulate", folder, *SIMULATE, ".", "--devices", str(count))
    measured("merge", folder, *PROGRAM, "merge", "sent", "--into", "all")
    measured("table", folder, *PROGRAM, "table", "all", "--devices")
    measured("plot", folder, *PROGRAM, "plot", "all", "--together", "figures")


def cells(folder: Path, count: int) -> None:
    one, other = (f"sent/simulated-{number:04}" for number in (1, 2))
    measured("simulate", folder, *SIMULATE, ".", "--devices", "2", "--values", str(count // 20))
    measured("table", folder, *PROGRAM, "table", one)
    measured("plot", folder, *PROGRAM, "plot", one)
    measured("claims", folder, *PROGRAM, "claims", one)
    measured("compare", folder, *PROGRAM, "compare", one, other, "--across-devices")


def plan(folder: Path, count: int) -> None:
    shares = count // len(METHODS) // DEPTHS
    sweep = {"scene.depth_complexity": [4 * (i + 1) for i in range(DEPTHS)],
             "scene.pixel_density": [round((i + 1) / shares, 5) for i in range(shares)]}
    (folder / "plan.yaml").write_text(yaml.safe_dump({
        "name": "plan", "title": "A plan of many cells", "scene": {"size": [512, 512], "depth_complexity": 4},
        "methods": list(METHODS), "sweep": sweep}))
    measured("dry-run", folder, *PROGRAM, "run", "plan.yaml", "--dry-run", "--device", "cpu", "--out", "out")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", choices=COUNTS)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--count", type=at_least(20))
    asked = parser.parse_args()
    asked.folder.mkdir(parents=True, exist_ok=True)
    {"devices": devices, "cells": cells, "plan": plan}[asked.what](asked.folder, asked.count or COUNTS[asked.what])


if __name__ == "__main__":
    run_script(main)
