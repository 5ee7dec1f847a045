"""Faults of methods and drivers in the process that measures: each costs one cell, and the run goes on."""

from __future__ import annotations

import signal
import subprocess
import time
from pathlib import Path

import pytest

from ..cli.conftest import apart, cells, command, environment, sabotaged
from ..patience import until

CONFIG = """\
name: faults
title: Faults
scene: {size: [32, 24], depth_complexity: 6}
methods: [%s]
measure: {target_rel_ci: 1.0e-9, min_samples: 20, max_samples: 20, time_limit_s: 5, hard_limit_mb: 800}
"""

# Runs when a process starts that measures: what becomes of a method's frame, by its id, from the ninth one on.
FAULTS = """
import os, signal, sys, time
if any("run.worker" in a for a in sys.orig_argv):
    from mfr_bench.errors import DeviceError
    from mfr_bench.gpu import device as devices, frame as frames

    def allocates():
        held = []
        while True:
            held.append(b"x" * 2**24)

    def loses_the_device():
        devices.Device.alive = lambda self: False
        raise DeviceError("GL_CONTEXT_LOST")

    def prints_and_leaves():
        print("DRIVER: giving up", file=sys.stderr, flush=True)
        os._exit(7)

    FAULTS = {"ab-array": lambda: os.kill(os.getpid(), signal.SIGSEGV), "ab-ll": lambda: os.kill(os.getpid(), 9),
              "kplus-heap": allocates, "kb-ps": loses_the_device, "kb-mdt32": prints_and_leaves}
    drawn = {}
    real = frames.Frame.draw

    def draw(self, mark=None):
        method = self.variant.method.id
        drawn[method] = drawn.get(method, 0) + 1
        if drawn[method] > 8 and method in FAULTS:
            FAULTS[method]()
        return real(self, mark)

    frames.Frame.draw = draw
"""


@pytest.fixture(scope="module")
def faulty(tmp_path_factory):
    """A run in which most methods fail, each its own way, and one after it."""
    here = tmp_path_factory.mktemp("faults")
    methods = "ab-array, ab-ll, kplus-heap, kb-ps, kb-mdt32, kplus-array"
    (here / "faults.yaml").write_text(CONFIG % methods)
    ended = apart("run", here / "faults.yaml", "--out", here / "out", env=sabotaged(here / "sabotage", FAULTS))
    return here, ended, {method: cell for (method, _), cell in cells(here / "out").items()}


@pytest.mark.parametrize(("method", "status", "reason"), [
    ("ab-array", "crashed", "sampling: killed by SIGSEGV"), ("ab-ll", "crashed", "sampling: killed by SIGKILL"),
    ("kplus-heap", "out_of_memory", "sampling: the process that measures took "),
    ("kb-ps", "crashed", "GL_CONTEXT_LOST"),
    ("kb-mdt32", "crashed", "sampling: ended with exit status 7: DRIVER: giving up")])
def test_a_fault_is_the_row_of_its_cell(faulty, method, status, reason):
    _, _, found = faulty
    assert found[method]["status"] == status
    assert found[method]["reason"].startswith(reason)
    assert "time_ms" not in found[method]["values"]


def test_the_other_cells_lose_nothing(faulty):
    _, ended, found = faulty
    assert ended.status == 1
    assert "7 cells: 2 ok, 4 crashed, 1 out_of_memory" in ended.out
    assert "Traceback" not in ended.err
    for method in ("floor", "kplus-array"):
        assert found[method]["status"] == "ok"
        assert found[method]["values"]["samples"] == len(found[method]["samples_ms"]) == 20
        assert 1 <= found[method]["values"]["sessions"] <= 6  # five faults, and as many processes after the first


def test_failed_cells_are_tried_again_unless_they_are_to_be_kept(faulty):
    here, _, found = faulty
    kept = apart("run", here / "faults.yaml", "--out", here / "out", "--keep-failed")
    assert (kept.status, kept.err) == (1, "")
    assert "7 kept from before" in kept.out
    again = apart("run", here / "faults.yaml", "--out", here / "out")
    assert again.status == 0
    assert "7 cells: 7 ok; 2 kept from before" in again.out
    after = {method: cell for (method, _), cell in cells(here / "out").items()}
    assert {method for method in after if after[method] == found[method]} == {"floor", "kplus-array"}


VANISHES = """
import os, sys
if any("run.worker" in a for a in sys.orig_argv):
    from mfr_bench.errors import DeviceError
    from mfr_bench.gpu import device as devices, frame as frames
    if os.path.exists("gone"):
        devices.open_device = lambda want="auto": (_ for _ in ()).throw(DeviceError("no driver here"))
    real = frames.Frame.draw

    def draw(self, mark=None):
        if self.variant.method.id == "ab-array":
            open("gone", "w").close()
            os._exit(1)
        return real(self, mark)

    frames.Frame.draw = draw
"""


def test_a_driver_that_vanishes_ends_the_run_in_one_line(tmp_path):
    """The first scene is measured before the deeper one's fault; what it gave is kept."""
    path = tmp_path / "faults.yaml"
    path.write_text(CONFIG % "kplus-array, ab-array" + "sweep: {scene.depth_complexity: [3, 6]}\n")
    assert apart("run", path, "--out", "out", "--only", "kplus-array", "--set", "scene.depth_complexity=3",
                 "--set", "sweep.scene.depth_complexity=[3]", cwd=tmp_path).status == 0
    ended = apart("run", path, "--out", "out", env=sabotaged(tmp_path / "sabotage", VANISHES), cwd=tmp_path)
    assert ended.status == 1
    complaint = ended.err.splitlines()[-1]
    assert complaint.startswith("the OpenGL device ")
    assert " is gone: no driver here; 3 of 6 cells are kept in out; the same command measures" in complaint
    assert (tmp_path / "out" / "results.csv").is_file()


# --- a driver that does not come back ------------------------------------------------------------

# A fullscreen pass of minutes: llvmpipe ends loops near 65,535 iterations, so each of them is long.
ENDLESS = """
from mfr_bench.glsl import includes
real = includes.read
LOOP = '''    float endless = gl_FragCoord.x;
    for (int i = 0; i < 60000; i++) {
        endless = sin(endless) + cos(endless * 3.0) + sin(endless * 5.0) + cos(endless * 7.0) + sqrt(abs(endless));
    }
    if (endless == 12345.0) { discard; }
'''
includes.read = lambda p: real(p).replace("void main() {", "void main() {\\n" + LOOP) if "array/store" in p else real(p)
"""
HANGS = CONFIG % "ab-array" + "profiles: {hang: {scene.size: [512, 512], measure.hard_limit_s: 8}}\n"


def children(pid: int) -> set[int]:
    return {int(child) for child in Path(f"/proc/{pid}/task/{pid}/children").read_text().split()}


def gone(pid: int) -> bool:
    """Whether a process has ended, be it that nobody has asked for its status yet."""
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] == "Z"
    except FileNotFoundError:
        return True


def test_a_shader_that_does_not_end_is_a_timeout(tmp_path):
    (tmp_path / "faults.yaml").write_text(HANGS)
    ended = apart("run", "faults.yaml", "--profile", "hang", "--out", "out", cwd=tmp_path,
                  env=sabotaged(tmp_path / "sabotage", ENDLESS))
    assert ended.status == 1
    found = {method: cell for (method, _), cell in cells(tmp_path / "out").items()}
    assert set(found) == {"floor", "ab-array"}
    assert (found["ab-array"]["status"], found["ab-array"]["reason"]) == (
        "timeout", "first frame: no end within 8 s (measure.hard_limit_s)")


def test_the_process_that_measures_dies_with_its_parent_in_the_midst_of_a_frame(tmp_path):
    (tmp_path / "faults.yaml").write_text(HANGS)
    process = subprocess.Popen(command("run", "faults.yaml", "--profile", "hang", "--out", "out", "--set",
                                       "measure.hard_limit_s=600"), cwd=tmp_path, stdout=subprocess.DEVNULL,
                               stderr=subprocess.DEVNULL, env=environment() | sabotaged(tmp_path / "s", ENDLESS))
    try:
        until(lambda: children(process.pid), "no process measures")
        worker, = children(process.pid)
        time.sleep(4)
    finally:
        process.kill()
        process.wait()
    until(lambda: gone(worker), "the worker outlives its parent")
    assert process.returncode == -signal.SIGKILL
