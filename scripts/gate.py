#!/usr/bin/env python3
"""Measures by real runs how often `compare` finds a slowdown in one of 28 cells, or calls a change where none is.

scripts/gate.py measure DIR [--rounds 5] [--device cpu]
scripts/gate.py judge DIR

`measure` makes a source tree for each slowdown, in which the store pass of KB-LL runs an idle loop at k = 16, and lets
each tree measure the same 28 cells in every round, in random order, in a process of its own. A measurement that was cut
off goes on: runs that are whole are kept. How long the loops are comes from trials before the rounds. `judge` compares
each run with that of its round whose tree has no loop, and prints a table in Markdown.
"""

from __future__ import annotations

import argparse
import csv
import json
import math
import os
import random
import shutil
import subprocess
import sys
from dataclasses import dataclass
from itertools import combinations
from pathlib import Path
from statistics import median

from ending import Misuse, at_least, run_script

from mfr_bench.compare import compare
from mfr_bench.compare.judge import FASTER, SLOWER
from mfr_bench.compare.sides import Side, load_side

ROOT = Path(__file__).resolve().parents[1]
SLOWED, K = "kb-ll", 16
STORE = "shaders/methods/ll/store.frag"
FACTORS = (1.05, 1.3, 2.0, 10.0, 100.0)
PLAIN, AGAIN = "plain", "again"  # trees without a loop, run twice in each round
CELLS = 28  # of CONFIG, with the floor
TRIAL = "trial", 300  # a tree, and the turns of its loop, from whose time the others follow
TRIALS = 7  # pairs of runs without and with that loop: a machine is slower for seconds at a time
CONFIG = """\
name: gate
title: The gate
scene: {kind: quads, size: [96, 96], pixel_density: 0.5, depth_complexity: 16, seed: 7}
methods: [ab-array, ab-ll, ab-sb, peel-f2b, peel-dual, kb-ps, kb-mdt32, kb-ab-array, kb-ab-ll, kb-ll, kplus-array,
          kplus-heap, mlab]
zip: {scene.depth_complexity: [16, 32], k: [8, 16]}
measure: {target_rel_ci: 0.05, min_samples: 7, max_samples: 50, time_limit_s: 0.2, wait_s: 60}
"""
LOOP = """\
void main() {{
    float idle = gl_FragCoord.z;
    for (int turn = 0; turn < (BOUND == {k}u ? {turns} : 0); ++turn) idle = fract(idle * 1.7 + 0.3);
    if (idle > 2.0) discard;
"""


@dataclass(frozen=True)
class Gate:
    """What one comparison says: of the slowed cell, how many times as long it took; the names of other changes."""

    found: bool
    raw: float
    others: tuple[str, ...]


def tree(folder: Path, turns: int) -> Path:
    """A source tree whose KB-LL runs a loop of so many turns for each fragment that it stores at k = 16."""
    if not folder.exists():
        for part in ("mfr_bench", "shaders", "configs"):
            shutil.copytree(ROOT / part, folder / part, ignore=shutil.ignore_patterns("__pycache__"))
        text = (folder / STORE).read_text()
        slowed = text.replace("void main() {\n", LOOP.format(k=K, turns=turns), 1)
        if slowed == text:
            sys.exit(f"{STORE} has no 'void main() {{'; edit scripts/gate.py")
        (folder / STORE).write_text(slowed if turns else text)
    return folder


def mfr(source: Path, *arguments: object) -> subprocess.CompletedProcess[str]:
    """Run mfr-bench from a source tree."""
    return subprocess.run([sys.executable, "-m", "mfr_bench", *map(str, arguments)], check=False, text=True,
                          capture_output=True, env=os.environ | {"PYTHONPATH": str(source)}, cwd=source)


def turns_of(folder: Path, device: str) -> dict[str, int]:
    """The turns of each tree's loop, from what a trial's loop adds to the time of the slowed cell; found once.

    The median of several pairs of runs counts, which take turns in going first.
    """
    kept = folder / "turns.json"
    if not kept.exists():
        each = median(trial(folder, number, device) for number in range(1, TRIALS + 1)) / TRIAL[1]
        kept.write_text(json.dumps({f"{factor:g}": max(1, round((factor - 1) / each)) for factor in FACTORS}))
    return {PLAIN: 0, AGAIN: 0} | json.loads(kept.read_text())


def trial(folder: Path, number: int, device: str) -> float:
    """What the trial's loop adds to a frame of the slowed cell, over the time without it."""
    trees = [(PLAIN, 0), TRIAL]
    times_ms = {name: trial_ms(folder, number, name, turns, device) for name, turns in trees[::(-1) ** number]}
    return times_ms[TRIAL[0]] / times_ms[PLAIN] - 1


def trial_ms(folder: Path, number: int, name: str, turns: int, device: str) -> float:
    """The time of a frame of the slowed cell with a loop of so many turns, in ms, by a run of its own."""
    out = folder / "trials" / f"{number}" / name
    run_in(tree(folder / "trees" / name, turns), folder, out, device, "--only", SLOWED)
    with open(out / "results.csv") as file:
        return next(float(row["time_ms"]) for row in csv.DictReader(file)
                    if row["method"] == SLOWED and row["k"] == str(K))


def run_in(source: Path, folder: Path, out: Path, device: str, *options: str) -> None:
    """Measure the gate's cells with the program of a source tree."""
    done = mfr(source, "run", folder / "gate.yaml", "--out", out, "--device", device, "--quiet", *options)
    if done.returncode:
        sys.exit(f"{out}: exit status {done.returncode}\n{done.stderr}")


def measure(folder: Path, rounds: int, device: str) -> int:
    """Measure what is missing; the exit status."""
    (folder / "trees").mkdir(parents=True, exist_ok=True)
    (folder / "gate.yaml").write_text(CONFIG)
    turns = turns_of(folder, device)
    for number in range(1, rounds + 1):
        order = list(turns)
        random.Random(number).shuffle(order)  # noqa: S311 - an order, not a secret
        for name in order:
            out = folder / "runs" / f"{number}" / name
            if whole(out):
                continue
            source = tree(folder / "trees" / (PLAIN if name == AGAIN else name), turns[name])
            run_in(source, folder, out, device)
            print(f"round {number}: {name}", flush=True)
    return 0


def side(path: Path) -> Side:
    """The results of one run."""
    return load_side(str(path))


def gate(before: Side, after: Side) -> Gate:
    """Compare two runs."""
    found, raw, others = False, math.nan, []
    for verdict in compare(before, after).verdicts:
        cell = verdict.after.point.cell
        if cell["method"] == SLOWED and cell["params"]["k"] == K:
            found, raw = verdict.verdict == SLOWER, verdict.raw or math.nan
        elif verdict.verdict in (SLOWER, FASTER):
            others.append(f"{verdict.name} {verdict.verdict} ({verdict.raw:.2g})")
    return Gate(found, raw, tuple(others))


def whole(out: Path) -> bool:
    """Whether a run has a row for each cell: one that was cut off has fewer."""
    if not (out / "results.csv").exists():
        return False
    with open(out / "results.csv") as file:
        return sum(1 for _ in csv.DictReader(file)) == CELLS


def judge(folder: Path) -> int:
    """Print what the runs say, as a table in Markdown; the exit status."""
    runs = {path: side(path) for path in sorted((folder / "runs").glob("*/*")) if whole(path)}
    if not runs:
        raise Misuse(f"{folder}: no run is whole; measure some: scripts/gate.py measure {folder}")
    unslowed = [run for path, run in runs.items() if path.name in (PLAIN, AGAIN)]
    none = [gate(a, b) for a, b in combinations(unslowed, 2)]
    alarms = [g for g in none if g.found or g.others]
    print("| times as long | as measured | found | comparisons with another cell called a change |\n"
          "| ---: | ---: | ---: | ---: |")
    print(f"| 1 (nothing planted) | – | – | {len(alarms)} of {len(none)} |")
    for factor in FACTORS:
        found = [gate(runs[path.with_name(PLAIN)], run) for path, run in runs.items()
                 if path.name == f"{factor:g}" and path.with_name(PLAIN) in runs]
        if found:
            raws = sorted(g.raw for g in found)
            print(f"| {factor:g} | {raws[0]:.3g} to {raws[-1]:.3g} | {sum(g.found for g in found)} of {len(found)} | "
                  f"{sum(bool(g.others) for g in found)} of {len(found)} |")
            alarms += [g for g in found if g.others]
    floors = [run.noise for run in runs.values() if run.noise is not None]
    print(f"\nnoise floors: {100 * min(floors):.2g} to {100 * max(floors):.2g} %, median {100 * median(floors):.2g} %")
    for g in alarms:
        print("other changes:", "; ".join(g.others) or "the cell without a loop called SLOWER")
    return 0


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", choices=("measure", "judge"))
    parser.add_argument("folder", type=Path)
    parser.add_argument("--rounds", type=at_least(1), default=5)
    parser.add_argument("--device", default="cpu")
    given = parser.parse_args()
    folder = given.folder.resolve()
    return measure(folder, given.rounds, given.device) if given.what == "measure" else judge(folder)


if __name__ == "__main__":
    run_script(main)
