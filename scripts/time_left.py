#!/usr/bin/env python3
"""Measures how well a run foretells the time that it has left.

scripts/time_left.py record FILE CONFIG... [--profile smoke] [--device cpu]
scripts/time_left.py judge FILE

`record` measures each config anew, into a temporary folder, and appends a line to FILE: the cells, each with its
method, the number of its parameters, fragments and pixels; the programs of its frames and those that count, with the
characters of each; and when each phase of them began, which samples came and when they were done, in the first half of
the run. A config that FILE has is not run again. `judge` replays the lines: what the time left is said to be after 0,
20 and 50 %, over what it was.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import asdict, dataclass, fields
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from ending import Misuse, run_script

from mfr_bench.config.model import Measure
from mfr_bench.plan import forecast, time_left
from mfr_bench.plan.cells import Cell
from mfr_bench.plan.forecast import Forecast, Rates, text_of

SHARES = (0.0, 0.2, 0.5)  # of the run, after which the forecast is judged
USUAL = Measure()
# Of sampling, where a recording names none. The last frame of every cell was drawn for its image.
RULES = {"PASS_SHARE": 0.25, "WARMUP_SHARE": 0.2, "OTHER_FRAMES": 2, "KEPT_FRAMES": 0}
DIGITS = 3  # of a time in ms, and after the point of seconds


@dataclass(frozen=True)
class Scene:
    """What a forecast asks of a scene: fragments and pixels."""

    F: int
    P: int

    def as_dict(self) -> dict[str, int]:
        """The scene as a record has it."""
        return {"F": self.F, "P": self.P}


class Recording(time_left.TimeLeft):
    """A forecast that keeps all that it is told."""

    made: Recording | None = None

    def __post_init__(self) -> None:
        super().__post_init__()
        self.expected = dict(self._stats)
        self.events: list[list[Any]] = []
        self.began_at: float | None = None
        self.number = {key: number for number, key in enumerate(self.cells)}
        Recording.made = self

    def _at(self, elapsed_s: float) -> float:
        if self.began_at is None:
            self.began_at = time.monotonic() - elapsed_s
        return round(elapsed_s, DIGITS)

    def left_s(self, elapsed_s: float) -> float:
        self._at(elapsed_s)
        return super().left_s(elapsed_s)

    def began(self, key: str | None, phase: str, elapsed_s: float) -> None:
        self.events.append(["began", self._at(elapsed_s), self.number.get(key), phase])
        super().began(key, phase, elapsed_s)

    def sampled(self, key: str, samples_ms: Sequence[float]) -> None:
        self.events.append(["sampled", self.events[-1][1], self.number.get(key), *map(_short, samples_ms)])
        super().sampled(key, samples_ms)

    def done(self, key: str, row: Mapping[str, Any], elapsed_s: float) -> None:
        values = [row["values"].get(name) for name in ("time_ms", "time_ms_low", "time_ms_high", "fragments")]
        self.events.append(["done", self._at(elapsed_s), self.number.get(key), *map(_short, values)])
        super().done(key, row, elapsed_s)

    def line(self, config: str, ended_s: float) -> dict[str, Any]:
        """The run as a line of the file has it."""
        variants = {key: (cell.method, text_of(dict(cell.params))) for key, cell in self.cells.items()}
        numbers = {variant: number for number, variant in enumerate(dict.fromkeys(variants.values()))}
        cells = [[cell.method, numbers[variants[key]], self.expected[key].F, self.expected[key].P]
                 for key, cell in self.cells.items()]
        sizes: dict[int, int] = {}
        for code in (*self.programs.values(), *self.counting.values()):
            sizes |= code
        number = {program: place for place, program in enumerate(sizes)}
        code = [[[number[program] for program in made[key]] for made in (self.programs, self.counting)]
                for key in self.cells]
        measure = asdict(next(iter(self.cells.values())).measure)
        unusual = {f.name: measure[f.name] for f in fields(Measure) if measure[f.name] != getattr(USUAL, f.name)}
        return {"config": config, "ended_s": round(ended_s, 2), "end_s": round(self.end_s, 2),
                "slowness": round(self.slowness, 2), "looks_s": round(self.looks_s, 4),
                "rules": {name: getattr(forecast, name) for name in RULES},
                "rates": asdict(self.forecast.rates), "measure": unusual, "cells": cells, "code": code,
                "sizes": list(sizes.values()),
                "events": [event for event in self.events if event[1] <= max(SHARES) * ended_s]}


def _short(value: float | None) -> float | None:
    return value if value is None or isinstance(value, int) else float(f"{value:.{DIGITS}g}")


def record_one(config: str, options: Sequence[str]) -> dict[str, Any]:
    """Measure a config in this process; the line."""
    from mfr_bench.cli.main import cli

    time_left.TimeLeft = Recording
    with TemporaryDirectory() as folder:
        cli.main(["run", config, "--out", f"{folder}/out", "--quiet", *options], standalone_mode=False)
        made = Recording.made
        if made is None or made.began_at is None:
            sys.exit(f"{config}: measured nothing")
        return made.line(config, time.monotonic() - made.began_at)


def record(file: Path, configs: Sequence[str], options: Sequence[str]) -> None:
    """Append a line for each config that the file lacks, each measured by a process of its own."""
    known = {run["config"] for run in read(file)} if file.exists() else set()
    for config in (c for c in configs if c not in known):
        done = subprocess.run([sys.executable, __file__, "one", str(file), config, *options], check=False)
        if done.returncode:
            sys.exit(f"{config}: exit status {done.returncode}")


def read(file: Path) -> list[dict[str, Any]]:
    """The runs of a file."""
    return [json.loads(line) for line in file.read_text().splitlines()]


@contextmanager
def _sampled_by(rules: Mapping[str, float]) -> Iterator[None]:
    """Let the forecast reckon with the rules of sampling that a run was recorded with."""
    real = {name: getattr(forecast, name) for name in rules}
    try:
        vars(forecast).update(rules)
        yield
    finally:
        vars(forecast).update(real)


def replayed(run: Mapping[str, Any], shares: Sequence[float] = SHARES) -> list[float]:
    """The time left as it is said after each share of a run, over what it was then."""
    with _sampled_by(RULES | run.get("rules", {})):
        return _replayed(run, shares)


def _replayed(run: Mapping[str, Any], shares: Sequence[float]) -> list[float]:
    measure = Measure(**{name: tuple(value) if isinstance(value, list) else value
                         for name, value in run["measure"].items()})
    scenes = {(f, p): Scene(f, p) for _, _, f, p in run["cells"]}
    cells = {str(number): Cell(run["config"], method, method, params, scenes[f, p], measure, {})
             for number, ((method, _, f, p), params) in enumerate(zip(run["cells"], _params(run["cells"]),
                                                                      strict=True))}
    code = [{str(number): {program: run["sizes"][program] for program in programs[which]}
             for number, programs in enumerate(run["code"])} for which in (0, 1)]
    ahead = _foreseeing(Forecast((), Rates(**run["rates"])), cells, *code, run["end_s"], run["slowness"],
                        run["looks_s"])
    events, found = iter([*run["events"], None]), []
    event = next(events)
    for share in shares:
        at_s = share * run["ended_s"]
        while event and event[1] <= at_s:
            _tell(ahead, cells, event)
            event = next(events)
        found.append(ahead.left_s(at_s) / (run["ended_s"] - at_s))
    return found


def _params(cells: Sequence[Sequence[Any]]) -> list[dict[str, int]]:
    """Parameters that tell the cells of a scene apart, and are the same in others."""
    count: Counter[tuple[Any, ...]] = Counter()
    found = []
    for cell in cells:
        found.append({"variant": cell[1], "twin": count[tuple(cell)]})
        count[tuple(cell)] += 1
    return found


def _foreseeing(*parts: Any) -> time_left.TimeLeft:
    """A forecast whose scenes are their own statistics."""
    real, time_left.expected_stats = time_left.expected_stats, lambda scene: scene
    try:
        return time_left.TimeLeft(*parts)
    finally:
        time_left.expected_stats = real


def _tell(ahead: time_left.TimeLeft, cells: Mapping[str, Cell], event: Sequence[Any]) -> None:
    what, elapsed_s, number, *values = event
    key = None if number is None else str(number)
    if what == "began":
        ahead.began(key, values[0], elapsed_s)
    elif what == "sampled":
        ahead.sampled(key, values)
    else:
        cell, names = cells.get(key), ("time_ms", "time_ms_low", "time_ms_high", "fragments")
        samples = ahead.samples_ms(key)
        row = {} if cell is None else {"method": cell.method, "params": cell.params, "scene": cell.scene.as_dict(),
                                       "values": dict(zip(names, values, strict=True)), "samples_ms": samples}
        ahead.done(key, row, elapsed_s)


def judge(file: Path) -> None:
    """Print what the runs say, as a table in Markdown."""
    runs = read(file)
    ratios = [replayed(run) for run in runs]
    for run, found in zip(runs, ratios, strict=True):
        print(f"{run['config']:26} {len(run['cells']):4} cells {run['ended_s']:7.1f} s  "
              + "  ".join(f"{ratio:.2f}" for ratio in found))
    print("\n| after | within a factor of 1.5 | within 2 | least | most |\n| ---: | ---: | ---: | ---: | ---: |")
    for share, found in zip(SHARES, zip(*ratios, strict=True), strict=True):
        counts = [sum(1 / factor <= ratio <= factor for ratio in found) for factor in (1.5, 2)]
        print(f"| {100 * share:.0f} % | {counts[0]} of {len(found)} | {counts[1]} of {len(found)} | {min(found):.2f} | "
              f"{max(found):.2f} |")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", choices=("record", "judge", "one"))
    parser.add_argument("file", type=Path)
    parser.add_argument("configs", nargs="*")
    parser.add_argument("--profile", default="smoke")
    parser.add_argument("--device", default="cpu")
    given = parser.parse_args()
    if given.what != "judge" and not given.configs:
        raise Misuse(f"{given.what}: names no config; see mfr-bench configs")
    options = ["--profile", given.profile, "--device", given.device]
    if given.what == "judge":
        judge(given.file)
    elif given.what == "record":
        record(given.file, given.configs, options)
    else:
        line = json.dumps(record_one(given.configs[0], options), separators=(",", ":"))
        with open(given.file, "a") as file:
            file.write(line + "\n")


if __name__ == "__main__":
    run_script(main)
