"""Two runs of one suite on a machine that is never twice the same: made in memory, from fixed seeds."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from mfr_bench.compare.sides import Entry, Side, identity
from mfr_bench.report.data import Point
from mfr_bench.stats import interleaved_ratio, sampled_interval
from mfr_bench.store import result_rows

from ..report import planted

METHODS = 49
SCENES = (16, 32)  # depth complexities


@dataclass(frozen=True)
class Machine:
    """`cv`: of frame times within a run. `shift`: deviation of a cell's time from run to run, whose distribution is
    `tails`. `load`: deviation of the run's speed, and half as much of each scene's."""

    cv: float
    shift: float
    tails: str = "normal"
    load: float = 0.05

    def shifts(self, random, count):
        draws = {"normal": lambda: random.standard_normal(count),
                 "laplace": lambda: random.laplace(0, 1 / np.sqrt(2), count),
                 "t3": lambda: random.standard_t(3, count) / np.sqrt(3),
                 "bursts": lambda: random.standard_normal(count) * np.where(random.random(count) < 0.05, 5, 1)}
        return self.shift * draws[self.tails]()


def frames(random, middle, cv, count):
    return (middle * np.exp(cv * random.standard_normal(count))).tolist()


def sampled(random, middle, machine):
    """10 to 49 frames, as many as noisy cells take."""
    return frames(random, middle, machine.cv * random.uniform(0.5, 1.5), int(random.choice([10, 15, 22, 33, 49])))


def run(machine, seed, slower=None, factor=1.0, path="run", methods=METHODS, device=None, alone=None, counts=None):
    """One run as a side of a comparison; `slower`: the number of a method whose times are `factor` as long.

    `alone`: the scene in which they are, of all by default. `counts`: frames of each cell, and of those that
    are slower.
    """
    random = np.random.default_rng(seed)
    run_load = np.exp(machine.load * random.standard_normal())
    cells = []
    for scene in SCENES:
        scene_load = run_load * np.exp(machine.load / 2 * random.standard_normal())
        for method, shift in enumerate(machine.shifts(random, methods)):
            changed = method == slower and alone in (None, scene)
            middle = (1 + method / 7) * scene / 16 * scene_load * np.exp(shift) * (factor if changed else 1)
            samples = sampled(random, middle, machine)[:counts and counts[changed]]
            cells.append(cell(f"m{method}", samples, {"depth_complexity": scene}, device))
    return side(cells, path, aa(random, machine))


class Runs:
    """Runs of a machine that differ in one cell: what they have in common is made once.

    Each is what `run` makes with the same arguments, to within rounding.
    """

    def __init__(self, machine, methods=METHODS):
        self.machine, self._methods, self._made = machine, methods, {}

    def side(self, seed, counts=None):
        """A run with nothing slower, `counts` frames of each cell; the frames that are taken are those of one draw."""
        if (seed, counts) not in self._made:
            self._made[seed, counts] = run(self.machine, seed, methods=self._methods, counts=(counts, counts))
        return self._made[seed, counts]

    def slowed(self, seed, method, scene, factor, counts=None, slowed=None):
        """The same with the frames of one cell `factor` times as long, `slowed` of them."""
        if factor == 1 and counts == slowed:
            return self.side(seed, counts)
        common, every = self.side(seed, counts), self.side(seed)
        key = list(every.entries)[SCENES.index(scene) * self._methods + method]
        samples = [factor * sample for sample in every.entries[key].point.cell["samples_ms"][:slowed]]
        (entry,) = side([cell(f"m{method}", samples, {"depth_complexity": scene})]).entries.values()
        return replace(common, entries=common.entries | {key: entry})


def aa(random, machine):
    """The noise floor: one method sampled twice in turns."""
    low, _, high = interleaved_ratio(*(frames(random, 1.0, machine.cv, 22) for _ in range(2)), 10, 1000)
    return max(abs(low - 1), abs(high - 1))


def cell(method, samples, scene=None, device=None, values=None, **parts):
    low, middle, high = sampled_interval(samples)
    times = {"time_ms": middle, "time_ms_low": low, "time_ms_high": high, "samples": len(samples)}
    return planted.cell(method, scene=scene, device=device, values=times | (values or {}), **parts) | {
        "samples_ms": samples}


def side(cells, path="run", noise=0.01, environment=None):
    rows = result_rows(cells)
    points = [Point(c, row, c["label"], None, frozenset()) for c, row in zip(cells, rows, strict=True)]
    entries = {identity("planted", p): Entry(f"{p.label}, n {p.cell['scene']['depth_complexity']}", "planted", p)
               for p in points}
    devices = frozenset((p.cell["device"]["renderer"], p.cell["device"]["version"]) for p in points)
    return Side(path, entries, devices, noise, environment or {}, (), ())
