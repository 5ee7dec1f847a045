"""Small cells, a timer that needs no clock, and a run of them in this process."""

from __future__ import annotations

from mfr_bench.config.model import Measure
from mfr_bench.config.model import Scene as SceneConfig
from mfr_bench.methods import catalog
from mfr_bench.plan import Cell
from mfr_bench.run.bench import Bench
from mfr_bench.run.events import Finished, Group, Sampled
from mfr_bench.run.jobs import jobs
from mfr_bench.run.ledger import Ledger
from mfr_bench.run.measuring import Measuring
from mfr_bench.run.sheet import Sheet
from mfr_bench.store import ResultFolder

MEASURE = Measure(target_rel_ci=1e-9, min_samples=7, max_samples=7)
SCENE = SceneConfig(size=(16, 12), depth_complexity=5)


class Clock:
    """A timer whose frames take `ms`, and `noise` more or twice that; `at` runs before the frame of that number."""

    name = "wall"
    resolution_ms = None

    def __init__(self, noise=0.0, at=None, ms=1.0):
        self.frames, self.noise, self.at, self.ms = 0, noise, at or {}, ms

    def frame_ms(self, draw, repeats=1):
        self.frames += 1
        self.at.get(self.frames, lambda: None)()
        for _ in range(repeats):
            draw(None)
        return self.ms + self.noise * (self.frames % 3)

    def passes_ms(self, draw):
        names = {}
        draw(lambda name: names.setdefault(name, 0.25))
        return names


def cell(method="ab-array", scene=SCENE, measure=MEASURE, **params):
    return Cell("test", method, method, catalog()[method].complete(params), scene, measure, dict(params))


class Run:
    """Measures cells into a folder, with a ledger that hears of every event at once."""

    def __init__(self, device, cells, timer, folder, interrupted=lambda: False):
        self.sheet = Sheet(ResultFolder(folder), jobs(cells, catalog(), device.info, "wall"))
        self.events, self.rows = [], []
        self.ledger = Ledger([self.sheet], device.info, report=self.rows.append)
        self.measuring = Measuring(Bench(device, timer, self.hear, interrupted), catalog())

    def hear(self, event):
        self.events.append(event)
        if isinstance(event, Sampled):
            self.ledger.sampled(event)
        if isinstance(event, Finished):
            self.ledger.write(self.sheet.jobs[event.key], event)
            self.ledger.wait()

    def all(self, force=False, until=float("inf")):
        self.ledger.settle(force)
        try:
            for group in self.ledger.groups():
                replicates = self.ledger.without_floor([job.key for job in group])
                self.measuring.group(
                    Group(tuple(group), self.ledger.partials(group), replicates, most_bytes=2**40, until=until))
        finally:
            self.ledger.close()
