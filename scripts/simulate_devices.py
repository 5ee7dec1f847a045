#!/usr/bin/env python3
"""Makes results of many simulated devices, packed, to try what reads and merges large collections.

scripts/simulate_devices.py OUT [--devices 10] [--values 37] [--methods 19] [--seed 1]

OUT/sent/<device>/simulated/ has a cell for each method, and the floor, at each number of layers: 20 times 37 are 740.
No device drew anything: frame times are drawn from a model in which devices differ in speed, and each favours other
methods. Manifests, renderers and titles name them simulated.
"""

from __future__ import annotations

import argparse
import math
import random
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import yaml
from ending import at_least, run_script

from mfr_bench.config import load
from mfr_bench.methods import FLOOR, catalog
from mfr_bench.parallel import in_processes
from mfr_bench.plan import expand, expected_stats
from mfr_bench.run.jobs import Job, jobs
from mfr_bench.run.sheet import plain
from mfr_bench.stats import sampled_interval
from mfr_bench.store import SCHEMA, ResultFolder
from mfr_bench.store.pack import write_pack
from mfr_bench.store.record import cell_key, text

NAME, TIMER, SAMPLES = "simulated", "gpu", 10
FRAGMENT_MS, PIXEL_MS = 2e-7, 1e-7  # of the floor on a device of speed 1
SPEEDS, FAVOUR, FRAME = 1.0, 0.3, 0.02  # spreads of the logarithms: of devices, of methods on one, of frames
PASSES = {"clear": 0.1, "store": 0.6, "resolve": 0.3}  # shares of a frame
KINDS = ("Alder 10", "Birch 20", "Cedar 30", "Douglas 40", "Elm 50")  # of devices, by what they favour


@dataclass(frozen=True)
class Model:
    """The experiment as its config has it, its cells, and how much slower than the floor each method is."""

    experiment: Any
    found: Sequence[Job]
    slower: Mapping[str, float]

    @classmethod
    def of(cls, folder: Path, values: int, methods: int, seed: int) -> Model:
        """The model of a config that is written to the folder first."""
        rng = random.Random(seed)  # noqa: S311 - times, not secrets
        chosen = [name for name, method in catalog().items()
                  if name != FLOOR and method.guarantee.startswith("exact") and not method.needs][:methods]
        path = folder / f"{NAME}.yaml"
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(yaml.safe_dump({
            "name": NAME, "title": "Simulated devices: no device drew these frames",
            "scene": {"size": [1024, 1024], "pixel_density": 0.5, "depth_complexity": 4}, "methods": chosen,
            "sweep": {"scene.depth_complexity": [4 * (i + 1) for i in range(values)]},
            "figures": [{"kind": "lines", "x": "depth_complexity", "y": "time_ms", "log": "xy"}]}))
        experiment, = load(str(path), catalog())
        return cls(experiment, jobs(expand(experiment, catalog()), catalog(), {}, TIMER),
                   {name: 1.2 if name == FLOOR else rng.uniform(2, 12) for name in (FLOOR, *chosen)})

    def manifest(self, device: Mapping[str, Any], keys: Sequence[str]) -> dict[str, Any]:
        """The manifest of one device's folder; keys: of its cells."""
        made = self.experiment
        return {"name": NAME, "title": made.title, "simulated": True, "config": f"{NAME}.yaml",
                "scene": made.scene.as_dict(), "params": dict(made.params), "sweep": plain(made.sweep),
                "zip": {}, "figures": [figure.as_dict() for figure in made.figures],
                "measure": made.measure.as_dict(),
                "methods": [{"id": m.id, "label": m.label, "params": dict(m.params)} for m in made.methods],
                "device": dict(device), "timer": TIMER, "cells": list(keys), "started": "2026-01-01T00:00:00Z",
                "noise_floor_rel": 0.01}


def device_of(number: int) -> dict[str, str]:
    """A device as records and manifests name it."""
    kind = KINDS[number % len(KINDS)]
    return {"slug": f"simulated-{number:04}", "renderer": f"Simulated {kind}-{number:04}", "vendor": "no vendor",
            "version": f"4.6 simulated {number % 3}.0", "kind": "gpu", "uuid": f"simulated-{number:04}", "pci": None}


def records(model: Model, number: int, seed: int) -> Iterator[dict[str, Any]]:
    """The records of one device."""
    device, kind = device_of(number), KINDS[number % len(KINDS)]
    own, alike = (random.Random(f"{seed} {of}") for of in (number, kind))  # noqa: S311 - times, not secrets
    speed = math.exp(own.gauss(0, SPEEDS))
    favours = {name: math.exp(alike.gauss(0, FAVOUR) + own.gauss(0, FAVOUR / 4)) for name in model.slower}
    for job in model.found:
        stats = expected_stats(job.cell.scene)
        frame_ms = speed * favours[job.cell.method] * model.slower[job.cell.method] * (
            FRAGMENT_MS * stats.F + PIXEL_MS * stats.P)
        times = [frame_ms * math.exp(own.gauss(0, FRAME)) for _ in range(SAMPLES)]
        yield record(job, device, times, stats)


def record(job: Job, device: Mapping[str, Any], times_ms: Sequence[float], stats: Any) -> dict[str, Any]:
    """A cell's record with these frame times in ms."""
    low, middle, high = sampled_interval(times_ms)
    cell = job.cell
    made = {"schema": SCHEMA, "experiment": NAME, "label": cell.label, "point": plain(cell.point), "key": "",
            "method": cell.method, "params": dict(cell.params), "scene": cell.scene.as_dict(),
            "measure": cell.measure.as_dict(), "status": "ok", "reason": "simulated",
            "values": {"fragments": stats.F, "covered_pixels": sum(stats.histogram[1:]), "samples": len(times_ms),
                       "timer": TIMER, "time_ms": middle, "time_ms_low": low, "time_ms_high": high, "noisy": False,
                       "stop_reason": "precise", "memory_bytes": 8 * stats.F, "max_abs_error": 0.0, "rmse": 0.0,
                       "max_error_all": 0.0, "flip": 0.0, "hit_ratio": 1.0, "wrong_pixels": 0, "sessions": 1},
            "glsl_hash": job.glsl_hash,
            "device": {name: device[name] for name in ("slug", "renderer", "version", "uuid", "pci")},
            "measured": "2026-01-01T00:00:00Z", "warmup_ms": list(times_ms[:8]), "samples_ms": list(times_ms),
            "passes": {name: [share * time_ms for time_ms in times_ms[:7]] for name, share in PASSES.items()},
            "buffers": {"store": 8 * stats.F}, "frames": []}
    return made | {"key": cell_key(made, TIMER)}


def write_device(model: Model, out: Path, number: int, seed: int) -> int:
    """Write the folder of one device, packed; its cells."""
    made = {f"{each['key']}.json": text(each) for each in records(model, number, seed)}
    device = device_of(number)
    folder = ResultFolder(out / "sent" / device["slug"] / NAME)
    write_pack(folder.pack_path, made)
    folder.write_manifest(model.manifest(device, [name.removesuffix(".json") for name in made]))
    return len(made)


def main(arguments: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("out", type=Path)
    for name, default in (("devices", 10), ("values", 37), ("methods", 19), ("seed", 1)):
        parser.add_argument(f"--{name}", type=at_least(1), default=default)
    asked = parser.parse_args(arguments)
    model = Model.of(asked.out, asked.values, asked.methods, asked.seed)
    write = partial(write_device, model, asked.out, seed=asked.seed)
    cells = sum(in_processes(write, range(1, asked.devices + 1)))
    print(f"{asked.out / 'sent'}: {asked.devices} simulated devices, {cells} cells")
    return 0


if __name__ == "__main__":
    run_script(main)
