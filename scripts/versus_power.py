#!/usr/bin/env python3
"""Measures how often `versus` finds 5 % that were planted, and how often it finds a change where there is none.

scripts/versus_power.py DIR [--alike 40] [--planted 20] [--seconds 1] [--rounds 6]

Copies the program into DIR twice, the second with frames that take 5 % more processor time, and compares one copy with
itself on 20 cells, and with the other on 6, in turns. DIR/runs.csv gets a line for each comparison; what it has is not
measured again. Prints the counts with their 95 % intervals (Clopper & Pearson 1934).
For a driver that draws on the CPU.
"""

from __future__ import annotations

import argparse
import csv
import json
import os
import shutil
import subprocess
import sys
from math import comb
from pathlib import Path

from ending import at_least, run_script

ROOT = Path(__file__).resolve().parents[1]
PARTS = ("mfr_bench", "configs", "shaders", "results/reference")
FACTOR = 1.05
ALIKE = """\
name: alike
scene: {size: [64, 64], depth_complexity: 8}
methods: [ab-array, ab-ll, ab-sb, kplus-array, kplus-heap, kb-ab-array, kb-ab-ll, kb, kb-ps, kplus-sb, kb-sr]
sweep: {k: [2, 4]}
"""
PLANTED = """\
name: planted
scene: {size: [64, 64], depth_complexity: 8}
methods: [ab-array, ab-ll, kplus-array, kplus-heap, kb-ab-array]
params: {k: 4}
"""
TIMED = """\
        for _ in range(repeats):
            draw(None)
        self.device.finish()
        return (time.perf_counter() - start) * 1e3 / repeats
"""
SLOWED = f"""\
        begun_s = time.process_time()
        for _ in range(repeats):
            draw(None)
        self.device.finish()
        until_s = begun_s + {FACTOR} * (time.process_time() - begun_s)
        while time.process_time() < until_s:
            pass
        return (time.perf_counter() - start) * 1e3 / repeats
"""
COLUMNS = ("kind", "number", "load", "status", "cells", "slower", "faster", "together", "noise")


def trees(folder: Path) -> tuple[Path, Path]:
    """The program as it is, and with slower frames; copies, so that editing changes nothing."""
    found = folder / "tree", folder / "slower"
    for tree in found:
        for part in () if tree.exists() else PARTS:
            shutil.copytree(ROOT / part, tree / part, ignore=shutil.ignore_patterns("__pycache__"))
    timers = found[1] / "mfr_bench" / "gpu" / "timers.py"
    text = timers.read_text()
    if SLOWED not in text:
        if text.count(TIMED) != 1:
            raise SystemExit(f"{timers}: has no place to plant a delay; adapt TIMED in this script")
        timers.write_text(text.replace(TIMED, SLOWED))
    return found


def compared(folder: Path, kind: str, number: int, given: argparse.Namespace) -> dict:
    """One comparison, as a row of runs.csv."""
    tree, slower = trees(folder)
    config = folder / f"{kind}.yaml"
    config.write_text(ALIKE if kind == "alike" else PLANTED)
    load = os.getloadavg()[0]
    done = subprocess.run([sys.executable, "-m", "mfr_bench", "versus", tree, slower if kind == "planted" else tree,
                           config, "--quiet", "--json", "--rounds", str(given.rounds), "--seconds", str(given.seconds)],
                          capture_output=True, text=True, check=False, env=os.environ | {"PYTHONPATH": str(tree)})
    if not done.stdout:
        raise SystemExit(done.stderr)
    told = json.loads(done.stdout)
    (folder / f"{kind}-{number:02}.json").write_text(done.stdout)
    together = [each["name"] for each in told["together"] if each["verdict"] in ("SLOWER", "FASTER")]
    return dict(zip(COLUMNS, (kind, number, f"{load:.1f}", done.returncode, len(told["cells"]),
                              told["counts"]["SLOWER"], told["counts"]["FASTER"], "; ".join(together),
                              f"{told['noise_floor_rel']:.4f}"), strict=True))


def rows_of(folder: Path) -> list[dict]:
    """The lines of runs.csv so far."""
    path = folder / "runs.csv"
    with path.open(newline="") if path.exists() else open(os.devnull) as file:
        return list(csv.DictReader(file))


def measure(folder: Path, given: argparse.Namespace) -> None:
    """Run what runs.csv lacks: two comparisons of one tree to one with the slower, as far as each is wanted."""
    wanted = sorted([(number / given.alike, "alike", number) for number in range(given.alike)]
                    + [(number / given.planted, "planted", number) for number in range(given.planted)])
    done = {(row["kind"], int(row["number"])) for row in rows_of(folder)}
    for _, kind, number in wanted:
        if (kind, number) not in done:
            row = compared(folder, kind, number, given)
            fresh = not (folder / "runs.csv").exists()
            with (folder / "runs.csv").open("a", newline="") as file:
                writer = csv.DictWriter(file, COLUMNS)
                if fresh:
                    writer.writeheader()
                writer.writerow(row)


def interval(hits: int, trials: int) -> tuple[float, float]:
    """The 95 % interval of a share (Clopper & Pearson 1934), by halving."""
    def share(least: int, tail: float) -> float:
        low, high = 0.0, 1.0
        for _ in range(50):
            p = (low + high) / 2
            above = sum(comb(trials, i) * p**i * (1 - p)**(trials - i) for i in range(least, trials + 1))
            low, high = (p, high) if above < tail else (low, p)
        return low
    return share(hits, 0.025) if hits else 0.0, share(hits + 1, 0.975) if hits < trials else 1.0


def summary(rows: list[dict]) -> list[str]:
    """A line for each kind of comparison: how many raised an alarm, with the interval, and how many cells did."""
    lines = []
    for kind, said in (("alike", "reported a change"), ("planted", "reported slower")):
        mine = [row for row in rows if row["kind"] == kind]
        verdicts = ("slower", "faster", "together") if kind == "alike" else ("slower", "together")
        hits = sum(any(row[name] not in ("", "0") for name in verdicts) for row in mine)
        low, high = interval(hits, len(mine)) if mine else (0.0, 1.0)
        cells = {name: sum(int(row[name]) for row in mine) for name in ("cells", "slower", "faster")}
        loads = [float(row["load"]) for row in mine] or [0.0]
        lines.append(f"{kind}: {hits} of {len(mine)} {said} [{100 * low:.1f} %, {100 * high:.1f} %]; cells: "
                     f"{cells['slower']} slower, {cells['faster']} faster of {cells['cells']}; "
                     f"together: {sum(bool(row['together']) for row in mine)}; "
                     f"load {min(loads):.0f} to {max(loads):.0f}")
    return lines


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path)
    for name, default in (("alike", 40), ("planted", 20), ("rounds", 6)):
        parser.add_argument(f"--{name}", type=at_least(1), default=default)
    parser.add_argument("--seconds", type=float, default=1.0)
    given = parser.parse_args()
    given.folder.mkdir(parents=True, exist_ok=True)
    measure(given.folder, given)
    print("\n".join(summary(rows_of(given.folder))))
    return 0


if __name__ == "__main__":
    run_script(main)
