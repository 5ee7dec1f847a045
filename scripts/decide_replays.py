#!/usr/bin/env python3
"""Measures how often `decide` finds the fastest method, by replays over recordings of whole races.

scripts/decide_replays.py record DIR [--scenes 50] [--methods 12] [--frames 200]
scripts/decide_replays.py replay DIR [--replays 100]

`record` writes a config for each of many unlike scenes and measures every candidate for as many frames, in turns and
without elimination; a recording that was cut off goes on. `replay` lets the same candidates race over those frames, the
rounds drawn anew in another order each time, and compares who wins with who is fastest over all frames.
"""

from __future__ import annotations

import argparse
import random
import subprocess
import sys
from pathlib import Path
from statistics import median

import yaml

from mfr_bench.decide.candidates import candidates, within_time
from mfr_bench.decide.question import EXACT_ERROR, Question
from mfr_bench.measure.elimination import Elimination
from mfr_bench.methods import catalog
from mfr_bench.report.data import is_floor, load
from mfr_bench.store import ResultFolder, find_results

GOOD = 1.02  # times the fastest method's time, up to which a winner counts as found
KINDS = ("block", "tiles", "random", "mixed", "slanted", "hairball", "needles", "temple")


def scene(rng: random.Random, kind: str) -> dict:
    """A scene of a kind, with a size, a depth and a coverage of its own."""
    made = {"size": [rng.randrange(24, 97), rng.randrange(24, 73)],
            "depth_complexity": rng.choice((4, 6, 8, 12, 16, 24)),
            "order": rng.choice(("random", "front_to_back", "back_to_front")), "seed": rng.randrange(1, 2**31)}
    if kind in ("hairball", "needles", "temple"):
        return {"kind": kind, "order": "random"} | {key: value for key, value in made.items() if key != "order"}
    density = {"pixel_density": round(rng.uniform(0.1, 1.0), 2)}
    slanted = {"slant": round(rng.uniform(0.1, 0.9), 2), "layout": "mixed"} if kind == "slanted" else {"layout": kind}
    return {"kind": "quads"} | made | density | slanted


def config(number: int, rng: random.Random, methods: int, frames: int) -> dict:
    """A config that races nothing: every candidate of the question draws all frames."""
    made = scene(rng, KINDS[number % len(KINDS)])
    error = EXACT_ERROR if number % 3 else 1 / 255
    question = Question(tuple(made["size"]), made["depth_complexity"], made.get("pixel_density", 1.0), None, error)
    found, _ = within_time(*candidates(catalog(), question), 1e6)
    chosen = rng.sample(found, min(methods, len(found)))
    return {"name": f"scene-{number:02}", "title": f"Recording {number}", "scene": made,
            "methods": [{"id": c.method, "label": c.label, **c.params} for c in chosen],
            "measure": {"min_samples": frames, "max_samples": frames, "time_limit_s": 3600, "max_error": error}}


def record(folder: Path, scenes: int, methods: int, frames: int) -> int:
    """Write the configs, unless they are there, and measure what is missing."""
    configs = folder / "configs"
    configs.mkdir(parents=True, exist_ok=True)
    rng = random.Random(scenes)  # noqa: S311 - scenes, not secrets
    for number in range(scenes):
        path, made = configs / f"scene-{number:02}.yaml", config(number, rng, methods, frames)
        if not path.exists():
            path.write_text(yaml.safe_dump(made, sort_keys=False))
    return subprocess.run([sys.executable, "-m", "mfr_bench", "run", str(configs), "--out", str(folder / "results"),
                           "--quiet"], stdout=subprocess.DEVNULL, check=False).returncode


def recorded(folder: Path) -> dict[str, dict[str, list[float]]]:
    """The frame times in ms of the cells that keep the error, by scene and cell; scenes with two such cells or more."""
    found = {}
    for path in find_results([folder / "results"]):
        result = load(ResultFolder(path))
        bound = result.manifest["measure"]["max_error"]
        cells = {p.label: p.cell["samples_ms"] for p in result.points if not is_floor(p) and p.status == "ok"
                 and p.cell.get("samples_ms") and p.row["max_error_all"] <= bound}
        if len(cells) > 1:
            found[result.name] = cells
    return found


def replay(cells: dict[str, list[float]], rng: random.Random) -> tuple[float, int, int]:
    """The winner's time over the fastest's, the frames that the race drew, and those of the full run."""
    count = min(map(len, cells.values()))
    race = Elimination(list(cells))
    drawn = 0
    for at in rng.sample(range(count), count):
        drawn += len(race.left)
        race.add({name: cells[name][at] for name in race.left})
        if race.decided:
            break
    times = {name: median(samples[:count]) for name, samples in cells.items()}
    return times[race.leader] / min(times.values()), drawn, count * len(cells)


def replays(folder: Path, number: int) -> None:
    """Replay the scenes in turn, and print what came of it."""
    scenes = recorded(folder)
    rng = random.Random(0)  # noqa: S311 - as above
    outcomes = [replay(cells, rng) for turn in range(-(-number // len(scenes))) for cells in scenes.values()][:number]
    good = sum(ratio <= GOOD for ratio, *_ in outcomes)
    shares = sorted(drawn / full for _, drawn, full in outcomes)
    frames = min(len(samples) for cells in scenes.values() for samples in cells.values())
    print(f"{len(scenes)} scenes, {sum(map(len, scenes.values()))} cells, at least {frames} frames each")
    print(f"{good} of {len(outcomes)} replays found a method within {100 * (GOOD - 1):.0f} % of the fastest; "
          f"worst {max(ratio for ratio, *_ in outcomes):.3f} times its time")
    whole = sum(drawn for _, drawn, _ in outcomes) / sum(full for *_, full in outcomes)
    print(f"frames drawn, of those of the full run: {100 * whole:.1f} % in all; "
          f"median {100 * median(shares):.1f} %, most {100 * shares[-1]:.1f} %")


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", choices=("record", "replay"))
    parser.add_argument("folder", type=Path)
    for name, default in (("scenes", 50), ("methods", 12), ("frames", 200), ("replays", 100)):
        parser.add_argument(f"--{name}", type=int, default=default)
    given = parser.parse_args()
    if given.what == "record":
        return record(given.folder, given.scenes, given.methods, given.frames)
    replays(given.folder, given.replays)
    return 0


if __name__ == "__main__":
    sys.exit(main())
