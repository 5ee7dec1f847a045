#!/usr/bin/env python3
"""Measures whether the process beside the device disturbs the frames that are timed, on a device that shares its cores.

scripts/paused.py [--rounds 60] [--frames 12] [--method kplus-array] [--device cpu]

Each round times so many frames four ways, in random order: twice with nothing to do for the other process (an A/A
pair), with images that wait to be compared while the process stands still, as in a run, and with the process at work.
It prints the ratio of each way to the first: the median of the rounds' ratios with its 95 % interval, by processor time
of the process that draws and by wall time. A minute or two on two cores with llvmpipe.
"""

from __future__ import annotations

import argparse
import random
import time
from collections.abc import Callable
from contextlib import nullcontext

import numpy as np

from mfr_bench.gpu.device import open_device
from mfr_bench.gpu.frame import Frame
from mfr_bench.gpu.single import shown
from mfr_bench.gpu.timers import WallTimer
from mfr_bench.methods import catalog
from mfr_bench.methods.spec import Fitted
from mfr_bench.run.answers import ALL, Answers, Compare, Subject, Ties
from mfr_bench.run.aside import OtherProcess, Pending
from mfr_bench.scene import Scene, generate
from mfr_bench.stats import median_interval

DRAWN = Scene(size=(128, 128), depth_complexity=16, fragment_probability=0.7)
COMPARED = Scene(size=(384, 384), depth_complexity=8)
K = 8
WAYS = {"idle": "nothing to do", "idle again": "nothing to do, again", "stopped": "stopped, images wait",
        "at work": "at work"}
CLOCKS: dict[str, Callable[[], float]] = {"processor time": time.process_time, "wall time": time.perf_counter}


def backlog(process: OtherProcess, images: np.random.Generator) -> Pending:
    """An image of noise that the process is given to compare, by FLIP as well, which takes it most of a second."""
    image = process.share(images.random((COMPARED.size[1], COMPARED.size[0], 4), np.float32))
    return process.begin(Compare(Subject(COMPARED), ALL, Ties(False, False), image, quality=True, flip=True), image)


def timed(draw: Callable[[], None]) -> dict[str, float]:
    before = {name: clock() for name, clock in CLOCKS.items()}
    draw()
    return {name: clock() - before[name] for name, clock in CLOCKS.items()}


def rounds(count: int, draw: Callable[[], None], process: OtherProcess) -> dict[str, list[dict[str, float]]]:
    """The times of each way, a round after another."""
    images, found = np.random.default_rng(1), {way: [] for way in WAYS}
    backlog(process, images)()  # it has started, and knows the scene
    for _ in range(count):
        for way in random.sample(list(WAYS), len(WAYS)):
            waiting = None if way.startswith("idle") else backlog(process, images)
            with process.paused() if way != "at work" else nullcontext():
                found[way].append(timed(draw))
            if waiting:
                if waiting.ready:
                    raise SystemExit(f"{way}: the image was compared before the frames were drawn; fewer --frames")
                waiting()
    return found


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rounds", type=int, default=60)
    parser.add_argument("--frames", type=int, default=12)
    parser.add_argument("--method", default="kplus-array")
    parser.add_argument("--device", default="cpu")
    asked = parser.parse_args()
    device, process = open_device(asked.device), OtherProcess(True, Answers())
    with shown(device, generate(DRAWN)) as on:
        frame = Frame(device, Fitted(catalog()[asked.method].variant({"k": K}), on.stats), on.scene_buffer, on.canvas)
        frame.draw_fitting()
        timer = WallTimer(device)
        found = rounds(asked.rounds, lambda: [timer.frame_ms(frame.draw) for _ in range(asked.frames)], process)
        frame.release()
    process.close()
    for clock in CLOCKS:
        first = [each[clock] for each in found["idle"]]
        print(f"{clock}: {1e3 * np.median(first) / asked.frames:.3g} ms a frame")
        for way in list(WAYS)[1:]:
            low, middle, high = median_interval([each[clock] / of for each, of in zip(found[way], first, strict=True)])
            print(f"  {WAYS[way]:21} {middle:.3f} [{low:.3f}, {high:.3f}]")


if __name__ == "__main__":
    main()
