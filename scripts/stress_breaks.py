#!/usr/bin/env python3
"""Compares where methods break under stress with where they did on llvmpipe 22.3.6, or records that.

    scripts/stress_breaks.py DIR         the results of `mfr-bench stress --profile smoke --out DIR`
    scripts/stress_breaks.py record DIR  write results/stress/breaks.csv from them

A method breaks earlier where the first level at which its image is not the promised one, or it loses fragments, crashes
or hangs, comes before that of the record. A level that is refused breaks nothing: what a device lacks, `doctor` says.
Prints a line for each that breaks earlier, and ends with status 1 if there is any. What the record's device refused at
every level, or was not measured, cannot be compared; it is counted.
"""

from __future__ import annotations

import csv
import sys
from collections.abc import Iterator
from dataclasses import astuple, dataclass, fields
from pathlib import Path

from ending import run_script

from mfr_bench.report import breaking, data
from mfr_bench.store import ResultFolder

RECORD = Path(__file__).resolve().parent.parent / "results" / "stress" / "breaks.csv"
REFUSED, UNKNOWN = "refused", ""
EARLIER = 1  # exit status


@dataclass(frozen=True)
class Break:
    """The first level that breaks a method in one panel of a stressor; state: how, or that it holds or is refused."""

    stressor: str
    label: str
    panel: str
    level: str
    state: str

    @property
    def place(self) -> tuple[str, str, str]:
        """What it is about."""
        return self.stressor, self.label, self.panel


def breaks(folder: Path) -> Iterator[tuple[Break, tuple[str, ...]]]:
    """Each method's break in each panel of the stressors below a folder, with the levels from mild to harsh."""
    for path in sorted(folder.glob("stress-*/manifest.json")):
        result = data.load(ResultFolder(path.parent))
        for figure in result.figures:
            if figure.get("kind") != "breaking":
                continue
            axis, panels = str(figure["x"]), figure.get("panels")
            points = data.series(result, [p for p in result.points if not data.is_floor(p)],
                                 [name for name in (axis, panels) if name])
            for ladder in breaking.ladders(result, points, axis, panels):
                yield _break(path.parent.name, ladder), tuple(map(data.plain, ladder.points))


def _break(stressor: str, ladder: breaking.Ladder) -> Break:
    states = {data.plain(level): breaking.state(point) for level, point in ladder.points.items()}
    broken = ((level, state) for level, state in states.items() if state not in (breaking.HOLDS, REFUSED))
    left = REFUSED if set(states.values()) == {REFUSED} else breaking.HOLDS
    return Break(stressor, ladder.label, "" if ladder.panel is None else data.plain(ladder.panel),
                 *next(broken, ("", left)))


def earlier(found: Break, levels: tuple[str, ...], recorded: Break) -> bool:
    """Whether the method breaks at a milder level than in the record."""
    if not found.level or recorded.level not in levels:
        return bool(found.level) and not recorded.level
    return levels.index(found.level) < levels.index(recorded.level)


def compare(folder: Path, recorded: dict[tuple[str, str, str], Break]) -> int:
    """Print what breaks earlier than in the record, and return the exit status."""
    lines, compared, others = [], 0, 0
    for found, levels in breaks(folder):
        before = recorded.get(found.place)
        if before is None or before.state == REFUSED:
            others += 1
            continue
        compared += 1
        if earlier(found, levels, before):
            then = f"at {before.level}: {before.state}" if before.level else "nowhere"
            lines.append(f"{found.stressor}, {found.label}{', ' * bool(found.panel)}{found.panel}: breaks at "
                         f"{found.level}: {found.state}; in the record {then}")
    print(*lines, f"{len(lines)} of {compared} break earlier; {others} have nothing to compare with", sep="\n")
    return EARLIER if lines else 0


def main() -> int:
    arguments = sys.argv[1:]
    if not arguments or arguments[0] in ("-h", "--help") or len(arguments) > 2:
        sys.exit(__doc__)
    folder = Path(arguments[-1])
    if not any(folder.glob("stress-*/manifest.json")):
        sys.exit(f"stress_breaks: {folder}: no results of stressors; "
                 f"run: mfr-bench stress --profile smoke --out {folder}")
    if arguments[0] != "record":
        with RECORD.open(newline="") as file:
            return compare(folder, {row.place: row for row in (Break(**row) for row in csv.DictReader(file))})
    RECORD.parent.mkdir(exist_ok=True)
    with RECORD.open("w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(field.name for field in fields(Break))
        writer.writerows(sorted(astuple(found) for found, _ in breaks(folder)))
    return 0


if __name__ == "__main__":
    run_script(main)
