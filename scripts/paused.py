#!/usr/bin/env python3
"""Measures whether the processes beside the one that draws disturb the frames that are timed, on a device that shares
its cores with them.

scripts/paused.py [--rounds 60] [--frames 12] [--method kplus-array] [--device cpu] [--compiling]

Each round times so many frames four ways, in random order: twice with nothing to do for the other process (an A/A
pair), with work that waits while the process stands still, as in a run, and with the process at work. The work is to
compare images, or with --compiling to draw first frames of cells, programs of which no cache has. It prints the ratio
of each way to the first: the median of the rounds' ratios with its 95 % interval, by processor time of the process that
draws and by wall time. A minute or two on two cores with llvmpipe.
"""

from __future__ import annotations

import argparse
import os
import random
import time
from collections import deque
from collections.abc import Callable
from contextlib import nullcontext

import numpy as np
from ending import at_least, run_script
from in_turns import FEWEST_ROUNDS

from mfr_bench.config.model import Measure
from mfr_bench.gpu.context import Device
from mfr_bench.gpu.device import open_device
from mfr_bench.gpu.frame import Frame
from mfr_bench.gpu.single import shown
from mfr_bench.gpu.timers import WallTimer
from mfr_bench.methods import catalog
from mfr_bench.methods.spec import Fitted
from mfr_bench.plan import Cell
from mfr_bench.run.answers import ALL, Answers, Compare, Subject, Ties
from mfr_bench.run.aside import OtherProcess, Pending
from mfr_bench.run.jobs import jobs
from mfr_bench.run.precompile import SLOW_S
from mfr_bench.run.worker import precompiler_for
from mfr_bench.scene import Scene, generate
from mfr_bench.stats import median_interval

DRAWN = Scene(size=(128, 128), depth_complexity=16, fragment_probability=0.7)
COMPARED = Scene(size=(384, 384), depth_complexity=8)
K = 8
WAYS = {"idle": "nothing to do", "idle again": "nothing to do, again", "stopped": "stopped, work waits",
        "at work": "at work"}
CLOCKS: dict[str, Callable[[], float]] = {"processor time": time.process_time, "wall time": time.perf_counter}


class Comparing:
    """The process that compares images."""

    def __init__(self, device: Device):
        self._images, self.process = np.random.default_rng(1), OtherProcess(True, Answers())
        self.begin()()  # it has started, and knows the scene

    def begin(self) -> Pending:
        """Give it an image of noise to compare, by FLIP as well, which takes it most of a second."""
        image = self.process.share(self._images.random((COMPARED.size[1], COMPARED.size[0], 4), np.float32))
        return self.process.begin(Compare(Subject(COMPARED), ALL, Ties(False, False), image, quality=True, flip=True),
                                  image)


class Compiling:
    """The process that compiles, without a cache: each of its cells takes a program that it has not kept."""

    ready = False  # it has more cells than a round takes

    def __init__(self, device: Device):
        os.environ["MESA_SHADER_CACHE_DISABLE"] = "true"
        self.process = precompiler_for(device)
        cells = [Cell("paused", "ab-array", "ab-array", catalog()["ab-array"].complete({"sort": "register"}),
                      Scene(size=(24, 20), depth_complexity=n), Measure(), {}) for n in range(2, 66)]
        self._jobs = deque(jobs(cells, catalog(), device.info, "wall"))
        self.process.begin(self._jobs)
        self.process.drew(self._jobs[0], SLOW_S + 1)
        self()

    def begin(self) -> Compiling:
        self._jobs.rotate()
        self.process.drawn_s.clear()
        self.process.begin([*self._jobs])
        return self

    def __call__(self) -> None:
        """Let it finish what it is at; what else it was asked for is not drawn any more."""
        self.process.begin([])
        for job in self._jobs:
            self.process.reached(job)
        while self.process.asked:
            time.sleep(0.01)
            self.process.begin([])
        if self.process.pid is None:
            raise SystemExit("the process that compiles has ended, or this driver has none")


def timed(draw: Callable[[], None]) -> dict[str, float]:
    before = {name: clock() for name, clock in CLOCKS.items()}
    draw()
    return {name: clock() - before[name] for name, clock in CLOCKS.items()}


def rounds(count: int, draw: Callable[[], None], other: Comparing | Compiling) -> dict[str, list[dict[str, float]]]:
    """The times of each way, a round after another."""
    found = {way: [] for way in WAYS}
    for _ in range(count):
        for way in random.sample(list(WAYS), len(WAYS)):
            waiting = None if way.startswith("idle") else other.begin()
            with other.process.paused() if way != "at work" else nullcontext():
                found[way].append(timed(draw))
            if waiting:
                if waiting.ready:
                    raise SystemExit(f"{way}: the work was done before the frames were drawn; fewer --frames")
                waiting()
    return found


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rounds", type=at_least(FEWEST_ROUNDS), default=60)
    parser.add_argument("--frames", type=at_least(1), default=12)
    parser.add_argument("--method", default="kplus-array", choices=catalog(), metavar="METHOD")
    parser.add_argument("--device", default="cpu")
    parser.add_argument("--compiling", action="store_true")
    asked = parser.parse_args()
    device = open_device(asked.device)
    other = (Compiling if asked.compiling else Comparing)(device)
    with shown(device, generate(DRAWN)) as on:
        frame = Frame(device, Fitted(catalog()[asked.method].variant({"k": K}), on.stats), on.scene_buffer, on.canvas)
        frame.draw_fitting()
        timer = WallTimer(device)
        found = rounds(asked.rounds, lambda: [timer.frame_ms(frame.draw) for _ in range(asked.frames)], other)
        frame.release()
    other.process.close()
    for clock in CLOCKS:
        first = [each[clock] for each in found["idle"]]
        print(f"{clock}: {1e3 * np.median(first) / asked.frames:.3g} ms a frame")
        for way in list(WAYS)[1:]:
            ratios = [each[clock] / of for each, of in zip(found[way], first, strict=True)]
            low, middle, high = median_interval(ratios)
            print(f"  {WAYS[way]:21} {middle:.3f} [{low:.3f}, {high:.3f}]")


if __name__ == "__main__":
    run_script(main)
