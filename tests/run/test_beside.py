"""Runs whose images are large enough for the process beside the device: the same rows, whatever becomes of it."""

from __future__ import annotations

import json
import signal
import subprocess

import pytest

from mfr_bench.run.bench import BESIDE_PIXELS
from mfr_bench.store.status import STATUSES

from ..cli.conftest import apart, command, environment, mfr, on_device, sabotaged  # noqa: F401
from ..patience import PATIENCE_S

SIDE = 256
CONFIG = f"""\
name: large
title: Large
scene: {{size: [{SIDE}, {SIDE}], depth_complexity: 4}}
methods: [kplus-array]
params: {{k: 2}}
sweep: {{scene.depth_complexity: [3, 4]}}
measure: {{target_rel_ci: 0.5, min_samples: 3, max_samples: 3, keep: [error, loss, image, fragments]}}
"""
CELLS = 4  # the floor and a method in two scenes
CHILD = "import os, sys\nif '--multiprocessing-fork' in sys.orig_argv:\n    "
FAULTS = {
    "it dies at work": CHILD + "import threading; threading.Timer(0.9, os._exit, [1]).start()",
    "nothing can be shared": "import os\nmade = os.memfd_create\ndef none(name):\n    if name == 'array':\n"
                             "        raise OSError(28, 'no space')\n    return made(name)\nos.memfd_create = none",
}


def found(folder) -> dict[tuple[str, int], tuple]:
    """The errors of each cell's images, and what it keeps."""
    rows = [json.loads(path.read_text()) for path in (folder / "cells").glob("*.json")]
    names = ("max_abs_error", "rmse", "flip", "wrong_pixels_all", "psnr_db", "fragments", "hit_ratio")
    return {(row["method"], row["scene"]["depth_complexity"]):
            (row["status"], *(row["values"].get(name) for name in names),
             (folder / "cells" / f"{row['key']}.npz").read_bytes()) for row in rows}


@pytest.fixture(scope="module")
def place(tmp_path_factory):
    here = tmp_path_factory.mktemp("beside")
    (here / "large.yaml").write_text(CONFIG)
    return here


@pytest.fixture(scope="module")
def whole(place):
    """A run that nothing disturbs."""
    ended = apart("run", place / "large.yaml", "--out", place / "whole", "--device", "cpu")
    assert ended.status == 0, ended.err
    return place / "whole"


def test_images_are_compared_and_arrays_compressed_by_another_process(whole, place, mfr, on_device):  # noqa: F811
    assert SIDE * SIDE >= BESIDE_PIXELS
    spent_s = json.loads((whole / "manifest.json").read_text())["beside_s"]
    assert {"scene", "oracle", "check", "flip", "compress"} <= set(spent_s)
    assert mfr("run", place / "large.yaml", "--out", place / "here").status == 0  # all in this process
    assert json.loads((place / "here" / "manifest.json").read_text())["beside_s"] == {}
    assert len(found(whole)) == CELLS
    assert found(whole) == found(place / "here")


@pytest.mark.parametrize("fault", FAULTS)
def test_whatever_becomes_of_it_the_rows_are_the_same(whole, place, fault, tmp_path):
    ended = apart("run", place / "large.yaml", "--out", tmp_path / "out", "--device", "cpu",
                  env=sabotaged(tmp_path / "fault", FAULTS[fault]))
    assert ended.status == 0, ended.err
    assert found(tmp_path / "out") == found(whole)


def test_an_image_may_wait_for_the_one_before_while_cells_take_turns(tmp_path):
    """The last samples of three cells come in one round, and one image may wait."""
    (tmp_path / "large.yaml").write_text(CONFIG.replace("[kplus-array]", "[kplus-array, ab-array, ab-ll]").replace(
        "sweep: {scene.depth_complexity: [3, 4]}\n", "").replace(", keep: [error, loss, image, fragments]", ""))
    fault = "import mfr_bench.run.aside\nmfr_bench.run.aside.IN_FLIGHT_BYTES = 1"
    ended = apart("run", tmp_path / "large.yaml", "--out", tmp_path / "out", "--device", "cpu",
                  env=sabotaged(tmp_path / "fault", fault))
    assert ended.status == 0, ended.err


def test_ctrl_c_keeps_what_is_measured_while_its_images_are_still_compared(whole, place, tmp_path):
    out = tmp_path / "out"
    process = subprocess.Popen(command("run", place / "large.yaml", "--out", out, "--device", "cpu"),
                               env=environment(), stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    process.stderr.readline()  # the first row
    process.send_signal(signal.SIGINT)
    complaint = process.communicate(timeout=PATIENCE_S)[1]
    assert process.returncode == 130 and "are kept" in complaint
    kept = found(out)
    assert kept and all(not STATUSES[row[0]].failed for row in kept.values())
    assert apart("run", place / "large.yaml", "--out", out, "--device", "cpu").status == 0
    assert found(out) == found(whole)
