"""Commands as a user gives them: within this process on the session's device, or in a process of their own."""

from __future__ import annotations

import csv
import json
import os
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

import pytest

import mfr_bench
from mfr_bench import glsl
from mfr_bench.cli import main
from mfr_bench.gpu.device import Listed

from ..patience import PATIENCE_S
from ..run.inprocess import InProcess

TINY = """\
name: tiny
title: Tiny
scene: {size: [32, 24], depth_complexity: 6}
methods: [ab-array, kplus-array]
sweep: {k: [2, 4]}
measure: {target_rel_ci: 0.5, min_samples: 7, max_samples: 7, time_limit_s: 0.5}
"""
FIGURE = "figures: [{kind: lines, x: k, y: time_ms}]\n"
CELLS = 4  # the floor, ab-array, and kplus-array at two k


@dataclass(frozen=True)
class Ended:
    """The exit status of a command, and what it printed."""

    status: int
    out: str
    err: str

    @property
    def complaint(self) -> str:
        """The one line that it printed on stderr, and nothing on stdout."""
        assert self.out == ""
        line, = self.err.splitlines()
        return line


AT_START = Path(__file__).with_name("at_start")
CALIBRATIONS = TemporaryDirectory(prefix="calibrations-")  # gone when this process ends


def environment(**more: str) -> dict[str, str]:
    """The environment of a command, whose processes calibrate no device that another command has calibrated before."""
    root = str(Path(mfr_bench.__file__).parent.parent)
    path = os.pathsep.join(filter(None, [str(AT_START), root, os.environ.get("PYTHONPATH")]))
    kept = {name: value for name, value in os.environ.items() if name != "COLUMNS"}
    return kept | {"PYTHONPATH": path, "MFR_BENCH_CALIBRATIONS": CALIBRATIONS.name} | more


def sabotaged(folder: Path, code: str) -> dict[str, str]:
    """The environment that lets every process, the one that measures included, run this code when it starts."""
    folder.mkdir(exist_ok=True)
    (folder / "sitecustomize.py").write_text("import calibrated\n" + code)
    return {"PYTHONPATH": os.pathsep.join([str(folder), environment()["PYTHONPATH"]])}


def command(*arguments: object) -> list[str]:
    return [sys.executable, "-m", "mfr_bench", *map(str, arguments)]


def apart(*arguments: object, env=None, **options) -> Ended:
    """Run a command in a process of its own."""
    done = subprocess.run(command(*arguments), capture_output=True, text=True, timeout=PATIENCE_S, check=False,
                          env=environment(**(env or {})), **options)
    return Ended(done.returncode, done.stdout, done.stderr)


@pytest.fixture(autouse=True)
def here(tmp_path, monkeypatch):
    """An empty working directory, a terminal of unknown width."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("COLUMNS", raising=False)
    return tmp_path


@pytest.fixture
def tiny(here):
    path = here / "tiny.yaml"
    path.write_text(TINY)
    return path


@pytest.fixture
def mfr(monkeypatch, capsys):
    """mfr(*arguments) -> Ended, in this process. GL has one current context, so commands get the session's device."""
    def run(*arguments: object) -> Ended:
        capsys.readouterr()
        monkeypatch.setattr(sys, "argv", ["mfr-bench", *map(str, arguments)])
        with pytest.raises(SystemExit) as ended:
            main()
        return Ended(ended.value.code, *capsys.readouterr())
    return run


@pytest.fixture
def on_device(device, monkeypatch):
    monkeypatch.setattr("mfr_bench.gpu.device.open_device", lambda want="auto": device)
    monkeypatch.setattr("mfr_bench.gpu.device.list_devices", lambda: [Listed(device.egl.index, device.info)])
    for module in ("process", "device_process"):
        monkeypatch.setattr(f"mfr_bench.run.{module}.Worker", InProcess)
    return device


@pytest.fixture
def plant(monkeypatch):
    """plant(path, right, wrong): replaces a piece of a shader, which has to be there."""
    def planted(path: str, right: str, wrong: str) -> None:
        real = glsl.read
        assert right in real(path), f"{path} no longer says {right!r}; plant the fault elsewhere"
        monkeypatch.setattr(glsl.includes, "read", lambda p: real(p).replace(right, wrong) if p == path else real(p))
    return planted


def cells(folder: Path) -> dict[tuple[str, int | None], dict]:
    """Cell records by method and k."""
    found = [json.loads(path.read_text()) for path in sorted((folder / "cells").glob("*.json"))]
    return {(cell["method"], cell["params"].get("k")): cell for cell in found}


def rows(path: Path) -> list[dict[str, str]]:
    with open(path, newline="") as file:
        return list(csv.DictReader(file))


def written(folder):
    """The time at which each cell file was written."""
    return {path.name: path.stat().st_mtime_ns for path in (folder / "cells").iterdir()}


@pytest.fixture
def measured(mfr, tiny, here):
    assert mfr("run", tiny, "--out", "out").status == 0
    return here / "out"
