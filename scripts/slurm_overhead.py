#!/usr/bin/env python3
"""Measures what a Slurm of several nodes adds to a run: submitting, waiting, collecting. Needs root; see slurm.sh.

scripts/slurm_overhead.py DIR [CONFIG...] [--nodes 4] [--profile smoke]

It starts Slurm in DIR/slurm, hands the papers' experiments or those named to its nodes, collects what they measured,
stops Slurm, and measures the same on one node. Then it says how long each step took, and whether every cell was
measured once and the merged rows are those of one node but for times; exit status 1 if not. Where another value
differs, that method is measured up to five times more on one node: a value that differs there too is none of Slurm's.
DIR/steps.json keeps what is done: the same command goes on from there. The part on Slurm, whose time is what counts,
then begins anew.
"""

from __future__ import annotations

import argparse
import csv
import json
import os
import re
import shutil
import signal
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from ending import at_least, run_script

from mfr_bench.merge.copies import REPEATED_VALUES
from mfr_bench.store import ResultFolder

SCRIPT = Path(__file__).with_name("slurm.sh")
MFR = [sys.executable, "-m", "mfr_bench"]
TIMES = REPEATED_VALUES | {"floor_ms"}  # columns that no two runs have in common
ALIVE = ("PENDING", "CONFIGURING", "RUNNING", "COMPLETING", "REQUEUED")
FIELD = re.compile(r"(\w+)=(\S*)")
LOOK_S = 1.0
MOST_SHOWN = 10
MOST_REPEATS = 5
TARGET = 0.1
CLUSTER = """\
engine: slurm
store: store
kinds: {{cpu: {{shares: {nodes}, device: cpu, minutes: 600, cpus: 1, partition: low, gres: 'gpu:1'}}}}
"""


def main() -> int:
    """Run what is not done yet, and print the table; 1 where the cells or rows are not those of one node."""
    asked = _arguments()
    at = asked.dir.resolve()
    at.mkdir(parents=True, exist_ok=True)
    configs = [str(Path(name).resolve()) if Path(name).exists() else name for name in asked.configs]
    configs = configs or _said("configs", "--papers").split()
    run = [*configs, "--profile", asked.profile]
    steps = at / "steps.json"
    done = json.loads(steps.read_text()) if steps.exists() else {"run": run, "nodes": asked.nodes}
    if (done["run"], done["nodes"]) != (run, asked.nodes):
        print(f"{at}: holds another measurement: {' '.join(done['run'])} on {done['nodes']} nodes", file=sys.stderr)
        return 2
    for name, step in (("slurm", _on_slurm), ("one", _on_one)):
        if name not in done:
            done[name] = step(at, run, asked.nodes)
            steps.write_text(json.dumps(done, indent=2))
    return _judged(at, done)


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("dir", type=Path, metavar="DIR")
    parser.add_argument("configs", nargs="*", metavar="CONFIG", help="default: the papers' experiments")
    parser.add_argument("--nodes", type=at_least(1), default=4)
    parser.add_argument("--profile", default="smoke")
    return parser.parse_args()


def _said(*command: str, at: Path | None = None) -> str:
    """What mfr-bench prints for a command in a folder. Raises CalledProcessError where it fails."""
    return subprocess.run([*MFR, *command], check=True, cwd=at, stdout=subprocess.PIPE, text=True).stdout


def _timed(at: Path, *command: str) -> float:
    """Seconds that a command of mfr-bench takes in a folder. Raises CalledProcessError where it fails."""
    begun = time.monotonic()
    subprocess.run([*MFR, *command], check=True, cwd=at, stdout=subprocess.DEVNULL)
    return time.monotonic() - begun


# --- the two measurements ----------------------------------------------------------------------------------------


def _on_slurm(at: Path, run: Sequence[str], nodes: int) -> dict[str, Any]:
    for name in ("store", "merged", "again", "slurm"):
        shutil.rmtree(at / name, ignore_errors=True)
    (at / "cluster.yaml").write_text(CLUSTER.format(nodes=nodes))
    os.environ["SLURM_CONF"] = str(at / "slurm" / "slurm.conf")
    signal.signal(signal.SIGTERM, lambda number, frame: sys.exit(1))
    try:
        subprocess.run([SCRIPT, "start", at / "slurm", str(nodes)], check=True)
        begun = time.monotonic()
        submit_s = _timed(at, "submit", *run, "--cluster", "cluster.yaml")
        print(f"submitted after {submit_s:.1f} s", flush=True)
        jobs = _ended_jobs()
        collect_s = _timed(at, "collect", "store", "--into", "merged")
        whole_s = time.monotonic() - begun
        print(_said("status", "store", at=at).splitlines()[-1], flush=True)
    finally:
        subprocess.run(["scancel", "--me", "--full"], check=False)
        subprocess.run([SCRIPT, "stop", at / "slurm"], check=False)
    merge_s = _timed(at, "merge", *map(str, _tasks(at)), "--into", "again")
    return {"submit_s": submit_s, "collect_s": collect_s, "merge_s": merge_s, "whole_s": whole_s, "jobs": jobs}


def _ended_jobs() -> list[dict[str, float]]:
    """When each of Slurm's jobs was submitted, began and ended, once none is left."""
    seen: dict[str, dict[str, str]] = {}
    while True:
        said = subprocess.run(["scontrol", "--oneliner", "show", "job"], check=True, stdout=subprocess.PIPE, text=True)
        for line in said.stdout.splitlines():
            job = dict(FIELD.findall(line))
            seen[job["JobId"]] = job
        if not any(job["JobState"] in ALIVE for job in seen.values()):
            break
        time.sleep(LOOK_S)
    return [{name: time.mktime(time.strptime(job[f"{name}Time"], "%Y-%m-%dT%H:%M:%S"))
             for name in ("Submit", "Start", "End")} for job in seen.values()]


def _on_one(at: Path, run: Sequence[str], nodes: int) -> dict[str, float]:
    return {"run_s": _timed(at, "run", *run, "--device", "cpu", "--shard", "1/1", "--quiet", "--out", "one")}


# --- what came of them -------------------------------------------------------------------------------------------


def _judged(at: Path, done: dict[str, Any]) -> int:
    took, jobs = done["slurm"], done["slurm"]["jobs"]
    tasks_s = max(job["End"] for job in jobs) - min(job["Start"] for job in jobs)
    added_s = took["whole_s"] - tasks_s
    for what, seconds in (
            ("submit", took["submit_s"]),
            ("longest wait of a task in the queue", max(job["Start"] - job["Submit"] for job in jobs)),
            ("tasks, from the first's start to the last's end", tasks_s),
            ("tasks, all together", sum(job["End"] - job["Start"] for job in jobs)),
            ("collect", took["collect_s"]), ("merge of the same folders", took["merge_s"]),
            ("from submit to the end of collect", took["whole_s"]), ("one node", done["one"]["run_s"])):
        print(f"{what:50}{seconds:8.1f} s")
    print(f"{'added to the tasks':50}{added_s:8.1f} s, {100 * added_s / tasks_s:.1f} % of their time "
          f"(at most {100 * TARGET:.0f} %)")
    wrong = [*_not_once(at), *_other_rows(at, done["run"])]
    for line in wrong[:MOST_SHOWN]:
        print(line)
    print(f"differences: {len(wrong) or 'none'}")
    return int(bool(wrong))


def _tasks(at: Path) -> list[Path]:
    return sorted((at / "store" / "tasks").glob("*/results"))


def _keys(root: Path) -> Counter[tuple[str, str]]:
    """How often each cell of each experiment stands in the folders below a root."""
    folders = [ResultFolder(path.parent) for path in root.rglob("manifest.json")]
    return Counter((folder.manifest()["name"], cell["key"]) for folder in folders for cell in folder.cells())


def _not_once(at: Path) -> list[str]:
    """A line for each cell that the tasks, the merged set or the merge have otherwise than one node."""
    one = _keys(at / "one")
    print(f"cells of one node: {one.total()}")
    found = {"tasks": sum(map(_keys, _tasks(at)), Counter()),
             "merged": _keys(at / "merged"), "again": _keys(at / "again")}
    return [f"cell {key} of {name}: {counts[name, key]} times in {where}, {one[name, key]} on one node"
            for where, counts in found.items() for name, key in sorted(one.keys() | counts.keys())
            if counts[name, key] != one[name, key] or counts[name, key] > 1]


def _other_rows(at: Path, run: Sequence[str]) -> list[str]:
    """A line for each value of a merged row that differs from one node's, and for each file of others.

    Times are left out, and values that differ between two runs of one node.
    """
    wrong = []
    one = _files(at / "one")
    for where in ("merged", "again"):
        merged = _files(at / where)
        wrong += [f"{where}: results.csv of {name}: not in both" for name in one.keys() ^ merged.keys()]
        for name in sorted(one.keys() & merged.keys()):
            if [row["key"] for row in one[name]] != [row["key"] for row in merged[name]]:
                wrong.append(f"{where}: results.csv of {name}: its rows are others, or in another order")
                continue
            for row, other in zip(one[name], merged[name], strict=True):
                differing = [c for c in row if c not in TIMES and row[c] != other[c]]
                varying = _varying(at, run, row, differing)
                for column in differing:
                    said = (f"{where}: {name}, {row['method']}, {row['point']}: {column} is {other[column]}, on one "
                            f"node {row[column]}")
                    if column in varying:
                        print(f"{said}; differs between runs of one node, too")
                    else:
                        wrong.append(said)
    return wrong


def _varying(at: Path, run: Sequence[str], row: dict[str, str], columns: Sequence[str]) -> set[str]:
    """Those columns of a row that differ between runs of one node: its method is measured until they do."""
    if not columns:
        return set()
    found: set[str] = set()
    source = next(path for path in (at / "one").rglob("manifest.json") if json.loads(path.read_text())["name"] ==
                  row["experiment"])
    stem = Path(json.loads(source.read_text())["config"]).stem
    config = next(name for name in run if Path(name).stem == stem)
    for number in range(1, MOST_REPEATS + 1):
        out = at / "repeats" / f"{row['experiment']}-{row['method']}-{number}"
        if not out.exists():
            _timed(at, "run", config, *run[run.index("--profile"):], "--device", "cpu", "--only", row["method"],
                   "--shard", "1/1", "--quiet", "--force", "--out", str(out))
        again = next(each for rows in _files(out).values() for each in rows if each["key"] == row["key"])
        found |= {column for column in columns if again[column] != row[column]}
        if len(found) == len(columns):
            break
    return found


def _files(root: Path) -> dict[str, list[dict[str, str]]]:
    """The rows of each results.csv below a root, by experiment."""
    found: dict[str, list[dict[str, str]]] = {}
    for path in sorted(root.rglob("results.csv")):
        with open(path, newline="", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        found[rows[0]["experiment"]] = rows
    return found


if __name__ == "__main__":
    run_script(main)
