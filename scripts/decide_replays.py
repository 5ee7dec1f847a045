#!/usr/bin/env python3
"""Measures how often `decide` finds the fastest method, by replays over recordings of whole races.

scripts/decide_replays.py record DIR [--scenes 50] [--methods 16] [--frames 200]
scripts/decide_replays.py replay DIR [--replays 100]

`record` writes a config for each of many unlike scenes and measures every candidate for as many frames, in turns and
without elimination; a recording that was cut off goes on. `replay` lets the same candidates race over those frames, the
rounds drawn anew in another order each time, and compares who wins with who is fastest over all frames.
"""

from __future__ import annotations

import argparse
import os
import random
from pathlib import Path
from statistics import median
from tempfile import TemporaryDirectory

import numpy as np
import yaml
from ending import Misuse, at_least, run_script

from mfr_bench.config import load
from mfr_bench.decide.candidates import candidates
from mfr_bench.decide.experiment import config_of
from mfr_bench.decide.question import EXACT_ERROR, Question
from mfr_bench.measure.elimination import Elimination
from mfr_bench.methods import catalog
from mfr_bench.methods.spec import Fitted, Promise
from mfr_bench.plan import Cell, expand, judge
from mfr_bench.run.eliminating import WARM_UP

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


def config(number: int, rng: random.Random, methods: int) -> dict:
    """A config of a scene and some of the candidates of its question, drawn at random."""
    made = scene(rng, KINDS[number % len(KINDS)])
    error = EXACT_ERROR if number % 3 else 1 / 255
    question = Question(tuple(made["size"]), made["depth_complexity"], made.get("pixel_density", 1.0), None, error)
    found, _ = candidates(catalog(), question)
    return config_of(question, made, rng.sample(found, min(methods, len(found))), 1.0)


def record(folder: Path, scenes: int, methods: int, frames: int) -> None:
    """Measure the scenes that the folder lacks, each into a file of its own, scene-NN.npz."""
    from mfr_bench.gpu.device import open_device

    folder.mkdir(parents=True, exist_ok=True)
    device = open_device("auto")
    rng = random.Random(scenes)  # noqa: S311 - scenes, not secrets
    for number in range(scenes):
        made, path = config(number, rng, methods), folder / f"scene-{number:02}.npz"
        if path.exists():
            continue
        names, times_ms = rounds(device, made, frames, random.Random(number))  # noqa: S311 - as above
        with path.with_suffix(".part").open("wb") as file:
            np.savez_compressed(file, methods=np.array(names), times_us=np.rint(1e3 * times_ms).astype(np.uint32))
        path.with_suffix(".part").rename(path)
        print(f"{path.name}: {len(names)} of {methods} candidates, load {os.getloadavg()[0]:.1f}", flush=True)


def rounds(device, made: dict, frames: int, rng: random.Random) -> tuple[list[str], np.ndarray]:
    """The names of the candidates that keep the error, and their frame times in ms: (candidates, frames).

    Every round draws one frame of each, in random order, as the races of `decide` do.
    """
    from mfr_bench.gpu.single import shown
    from mfr_bench.gpu.timers import WallTimer, undisturbed_ms
    from mfr_bench.scene import generate

    cells = cells_of(made)
    timer = WallTimer(device)
    with shown(device, generate(cells[0].scene)) as on:
        racing = {cell.label: frame for cell in cells if (frame := fitting(device, on, cell))}
        times_ms: dict[str, list[float]] = {name: [] for name in racing}
        for number in range(WARM_UP + frames):
            for name in rng.sample(list(racing), len(racing)):
                time_ms = undisturbed_ms(timer, racing[name].draw)
                if number >= WARM_UP:
                    times_ms[name].append(time_ms)
        for frame in racing.values():
            frame.release()
    return list(times_ms), np.array(list(times_ms.values()))


def cells_of(made: dict) -> list[Cell]:
    """The cells of a config, without the floor."""
    with TemporaryDirectory() as folder:
        path = Path(folder, "scene.yaml")
        path.write_text(yaml.safe_dump(made))
        experiment, = load(str(path), catalog())
    return [cell for cell in expand(experiment, catalog()) if catalog()[cell.method].guarantee != "none"]


def fitting(device, on, cell: Cell):
    """The frame of a cell; None where the device cannot draw it, or its image is further off than allowed."""
    from mfr_bench.gpu.frame import Frame
    from mfr_bench.oracle.quality import quality

    if judge(cell, catalog(), on.stats, device.limits):
        return None
    frame = Frame(device, Fitted(catalog()[cell.method].variant(cell.params), on.stats), on.scene_buffer, on.canvas)
    frame.draw_fitting()
    if quality(frame.image(), on.truth.image(Promise()), False)["max_error_all"] <= cell.measure.max_error:
        return frame
    frame.release()
    return None


def recorded(folder: Path) -> dict[str, dict[str, list[float]]]:
    """The frame times in ms of the cells that keep the error, by scene and cell; scenes with two such cells or more."""
    found = {}
    for path in sorted(folder.glob("scene-*.npz")):
        with np.load(path) as file:
            cells = {str(name): (times / 1e3).tolist() for name, times in zip(file["methods"], file["times_us"],
                                                                                   strict=True)}
        if len(cells) > 1:
            found[path.stem] = cells
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
    if not scenes:
        raise Misuse(f"{folder}: no recorded races; make them: scripts/decide_replays.py record {folder}")
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
    for name, default in (("scenes", 50), ("methods", 16), ("frames", 200), ("replays", 100)):
        parser.add_argument(f"--{name}", type=at_least(1), default=default)
    given = parser.parse_args()
    if given.what == "record":
        record(given.folder, given.scenes, given.methods, given.frames)
    else:
        replays(given.folder, given.replays)
    return 0


if __name__ == "__main__":
    run_script(main)
