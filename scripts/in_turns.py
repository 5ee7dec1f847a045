"""Times the frames of several methods of one scene in turns, within one process, by its processor time.

For drivers that draw on the CPU: the processor time of all threads of the process is what a frame costs, whatever else
the machine does meanwhile. What drifts between turns drifts for all methods alike, so that ratios are those of pairs.
"""

from __future__ import annotations

import csv
import math
import time
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

from mfr_bench.gpu.context import Device
from mfr_bench.gpu.frame import Frame
from mfr_bench.stats import Interval, median_interval

TURN_MS = 10.0  # of processor time that a turn is to take, at least, unless it would be of more than MOST_FRAMES
MOST_FRAMES = 20
FEWEST_ROUNDS = 6  # below, the median of the rounds has no 95 % interval


def turn_ms(device: Device, frame: Frame, frames: int) -> float:
    """Processor time of a frame in ms: of so many, drawn one after another, divided by their number."""
    device.finish()
    begun_s = time.process_time()
    for _ in range(frames):
        frame.draw()
    device.finish()
    return (time.process_time() - begun_s) * 1e3 / frames


def frames_of_a_turn(frame_ms: float) -> int:
    """Frames that take TURN_MS together, one at least and MOST_FRAMES at most."""
    return max(1, min(MOST_FRAMES, math.ceil(TURN_MS / frame_ms) if frame_ms > 0 else MOST_FRAMES))


def in_turns(device: Device, frames: Mapping[str, Frame], rounds: int) -> dict[str, list[float]]:
    """Processor times of a frame of each method in ms, one for each round; every second round goes backwards.

    All methods draw as many frames in a turn as the fastest needs.
    """
    first = {name: turn_ms(device, frame, 1) for name, frame in frames.items()}
    together = frames_of_a_turn(min(first.values()))
    times: dict[str, list[float]] = {name: [] for name in frames}
    for number in range(rounds):
        for name in list(frames) if number % 2 else reversed(frames):
            times[name].append(turn_ms(device, frames[name], together))
    return times


def ratio(over: Sequence[float], under: Sequence[float]) -> Interval:
    """The median of the ratios of the rounds, between the ends of its 95 % interval."""
    return median_interval([a / b for a, b in zip(over, under, strict=True)])


def geometric_mean(values: Iterable[float]) -> float:
    """The geometric mean of positive values, of which there is one at least."""
    logarithms = [math.log(value) for value in values]
    return math.exp(math.fsum(logarithms) / len(logarithms))


def rows_of(path: Path) -> list[dict[str, str]]:
    """The rows of a CSV file, none where there is no file yet."""
    if not path.exists():
        return []
    with path.open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def add_row(path: Path, row: Mapping[str, object]) -> None:
    """Append a row, after a header where the file is new, so that a run that is ended can go on."""
    fresh = not path.exists()
    with path.open("a", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, list(row))
        if fresh:
            writer.writeheader()
        writer.writerow(row)
