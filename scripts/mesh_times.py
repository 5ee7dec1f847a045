#!/usr/bin/env python3
"""Measures what a mesh costs before any method draws it, and its oracle: wall and CPU seconds, and the memory in use.

scripts/mesh_times.py MESH [--size 1024x1024] [--direction +x] [--device cpu]

MESH is a file, or the name of one that `mfr-bench meshes fetch` has brought. The device is opened beforehand.
"""

from __future__ import annotations

import argparse
import resource
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from ending import run_script

from mfr_bench.config.model import Scene
from mfr_bench.gpu.device import open_device
from mfr_bench.gpu.scene_buffer import SceneBuffer
from mfr_bench.gpu.targets import Canvas
from mfr_bench.gpu.truth import Truth
from mfr_bench.methods.spec import Promise
from mfr_bench.scene import generate
from mfr_bench.scene.kinds.mesh import View
from mfr_bench.scene.mesh import faces_of


@contextmanager
def timed(what: str) -> Iterator[None]:
    """Print the time of what is done within, and the most memory that the process has had so far."""
    wall_s, cpu_s = time.perf_counter(), time.process_time()
    yield
    wall_s, cpu_s = time.perf_counter() - wall_s, time.process_time() - cpu_s
    print(f"{what:34} {wall_s:6.2f} s wall  {cpu_s:6.2f} s CPU  {most_mib():6.0f} MiB at most")


def most_mib() -> float:
    """The most main memory that this process has had, in MiB."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("mesh")
    parser.add_argument("--size", default="1024x1024", type=lambda text: tuple(map(int, text.split("x"))))
    parser.add_argument("--direction", default="-z")
    parser.add_argument("--device", default="auto")
    given = parser.parse_args()
    path = Path(given.mesh)
    scene = Scene(kind="mesh", file=path.name, folder=str(path.parent.absolute()), size=given.size, alpha=(0.1, 0.6),
                  order="file", view=View(direction=given.direction), depth_complexity=0)
    device = open_device(given.device)
    print(f"{device.info['renderer']}; {most_mib():.0f} MiB before")
    with timed("read the file"):
        faces_of(scene)
    with timed("place and order the triangles"):
        made = generate(scene)
    with timed("upload"):
        scene_buffer, canvas = SceneBuffer(device, made), Canvas(device, made.viewport)
        device.finish()
    with timed("oracle: capture, sort, composite"):
        truth = Truth(device, scene_buffer, canvas)
        truth.answer(Promise())
    print(f"{len(made)} triangles, {int(truth.counts.sum())} fragments")


if __name__ == "__main__":
    run_script(main)
