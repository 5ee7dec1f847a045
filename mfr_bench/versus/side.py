"""The process of one source tree, run by its path: answers the parent's lines of JSON with the tree's own code.

Nothing but long-lived names of the package is used here, since the tree may be an older one: what it lacks is told.
The requests are open, stay, prepare, batch and release. Each is answered by one line; `error` holds what went wrong.
"""

from __future__ import annotations

import json
import os
import sys
import time
from contextlib import suppress

UNFIT = (ImportError, AttributeError, TypeError)  # what a tree raises that lacks a name used here
CPU = "cpu"  # the name of the clock that counts processor time


class Side:
    """The cells of one tree on one device."""

    def __init__(self) -> None:
        self.shown = self.frame = None
        self.scene = None

    def open(self, config: str, profile: str | None, only: list[str] | None, overrides: list[str], device: str,
             timer: str | None) -> dict:
        """Open the device and plan the config. `timer`: None lets the calibration choose."""
        from mfr_bench.config import load
        from mfr_bench.gpu.device import open_device
        from mfr_bench.gpu.selftest import calibrate
        from mfr_bench.gpu.timers import GpuTimer, WallTimer
        from mfr_bench.methods import catalog
        from mfr_bench.plan import expand

        self.catalog = catalog()
        experiment, = load(config, self.catalog, profile, tuple(overrides))
        self.cells = expand(experiment, self.catalog, only)
        self.device = open_device(device)
        self.on_cpu = self.device.info["kind"] == "cpu"
        timer = CPU if self.on_cpu else timer or calibrate(self.device).timer
        self.timer = (GpuTimer if timer == "gpu" else WallTimer)(self.device)
        self.timer_name = timer
        return {"timer": timer, "device": dict(self.device.info), "title": experiment.title, "cpus": self._cpus(),
                "cells": [self._told(cell) for cell in self.cells]}

    def _cpus(self) -> list[int]:
        """The processors that this process may use, where the driver draws on them and the system lets one choose."""
        return sorted(os.sched_getaffinity(0)) if self.on_cpu and hasattr(os, "sched_getaffinity") else []

    def stay(self, cpu: int) -> dict:
        """Keep all threads on one processor from now on: the other tree's process is on the same one."""
        for task in os.listdir("/proc/self/task"):
            with suppress(ProcessLookupError):
                os.sched_setaffinity(int(task), (cpu,))
        return {}

    def _told(self, cell) -> dict:
        return {"experiment": cell.experiment, "label": cell.label, "method": cell.method, "params": dict(cell.params),
                "point": _plain(dict(cell.point)), "scene": _plain(cell.scene.as_dict()),
                "measure": _plain(cell.measure.as_dict())}

    def prepare(self, cell: int, check: bool = True) -> dict:
        """Draw a cell until it fits, and check its image if that is wanted: its status, and the values of its row."""
        from mfr_bench.gpu.frame import Frame
        from mfr_bench.methods.spec import Fitted
        from mfr_bench.plan import judge

        chosen = self.cells[cell]
        self._show(chosen.scene)
        variant = self.catalog[chosen.method].variant(chosen.params)
        decision = judge(chosen, self.catalog, self.shown.stats, self.device.limits)
        if decision:
            return {"status": decision[0], "reason": decision[1], "values": {}}
        fitted = Fitted(variant, self.shown.stats)
        self.frame = Frame(self.device, fitted, self.shown.scene_buffer, self.shown.canvas)
        self.frame.draw_fitting()
        return self._told_of(variant) if check else {}

    def _told_of(self, variant) -> dict:
        values = self._checked(variant)
        exact = variant.guarantee.startswith("exact")
        off = exact and values["max_abs_error"] > 1e-4
        wrong = f"max_abs_error {values['max_abs_error']:.3g}" if off else None
        lost = self.frame.lost_fragments()
        if exact and lost:
            wrong = f"{lost} fragments lost"
        values |= {"memory_bytes": sum(self.frame.memory_bytes.values()), "lost_fragments": lost,
                   "fragments": self.shown.stats.F, "timer": self.timer_name}
        return {"status": "wrong" if wrong else "ok", "reason": wrong, "values": _plain(values)}

    def _checked(self, variant) -> dict:
        from mfr_bench.methods.spec import Promise
        from mfr_bench.oracle.quality import quality

        if variant.guarantee == "none":
            return {}
        image = self.frame.image()
        return {**self.shown.errors(variant, image), **quality(image, self.shown.truth.image(Promise()), False)}

    def _show(self, config) -> None:
        """Bring the scene to the device, unless it is there."""
        from mfr_bench.gpu.single import Shown
        from mfr_bench.scene import generate

        if self.scene == config:
            return
        if self.shown:
            self.shown.canvas.release()
            self.shown.scene_buffer.release()
        self.shown, self.scene = Shown(self.device, generate(config)), config

    def batch(self, frames: int) -> dict:
        """The mean time of a frame of so many drawn one after another, in ms.

        Of a driver that draws on the CPU it is the processor time of this process, all threads together.
        """
        start = time.process_time()
        wall_ms = self.timer.frame_ms(self.frame.draw, frames)
        return {"ms": (time.process_time() - start) * 1e3 / frames if self.on_cpu else wall_ms}

    def release(self) -> dict:
        """Let go of the cell that was prepared."""
        if self.frame:
            self.frame.release()
        self.frame = None
        return {}


def _plain(value):
    if isinstance(value, dict):
        return {str(name): _plain(item) for name, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(item) for item in value]
    if hasattr(value, "tolist"):
        return _plain(value.tolist())
    return value


def main() -> None:
    """Answer requests until the parent closes its end. What drivers print goes to stderr."""
    answers = os.fdopen(os.dup(1), "w", encoding="utf-8")
    os.dup2(2, 1)
    side = Side()
    for line in sys.stdin:
        request = json.loads(line)
        try:
            answer = getattr(side, request.pop("do"))(**request)
        except Exception as error:  # noqa: BLE001 - whatever the tree's code raises is the answer
            lines = getattr(error, "lines", None) or [str(error) or type(error).__name__]
            known = type(error).__module__.startswith("mfr_bench") or isinstance(error, MemoryError)
            answer = {"error": "; ".join(lines) if known else f"{type(error).__name__}: {error}",
                      "unfit": isinstance(error, UNFIT)}
        answers.write(json.dumps(answer) + "\n")
        answers.flush()
    os._exit(0)  # without the exit handlers of a driver, which may hang


if __name__ == "__main__":
    main()
