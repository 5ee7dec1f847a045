"""Adding a column or a status takes one entry of a table, and for a column the module that gives its value."""

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import mfr_bench

PACKAGE = Path(mfr_bench.__file__).parent
ROOT = PACKAGE.parent
COLUMN = '''    Column("sorted_share", "float", "", "share of the pixels that were sorted", drawn="measure",
           label="sorted"),
    Column("repeats",'''
STATUS = '''    Status("lost_device", "the driver reset the device", retried=True, failed=True, exit_status=1,
           breaks="crashed"),
    Status("timeout",'''
# Measured results as a run leaves them, and every command that reads them.
USE = '''
import sys
from mfr_bench.cli import main
from tests.report import planted
figures = [{"kind": kind, "x": "k", "y": y} for kind, y in (("lines", Y), ("bars", Y), ("stacked_passes", "time_ms"),
                                                            ("breaking", "max_abs_error"))]
cells = [planted.cell("ab-array", params={"k": k}, point={"k": k}, values=VALUES, passes={"store": 1.0})
         for k in (2, 4)] + [planted.cell("kplus-array", time_ms=None, status=STATUS, reason="because", params={"k": 2},
                                          point={"k": 2})]
for name in ("a", "b"):
    planted.folder(name, cells, figures, {"k": [2, 4]})
for command in ("table a", "plot a", "claims a", "compare a b", "conformance a", "report a --out a.html",
                "table --columns"):
    sys.argv = ["mfr-bench", *command.split()]
    try:
        main()
    except SystemExit as ended:
        assert ended.code in (0, None, 5), (command, ended.code)
'''

LOAD = """
from mfr_bench.config import load
from mfr_bench.methods import catalog
assert load("c.yaml", catalog())[0].figures[0].y == "sorted_share"
"""


@pytest.fixture
def copy(tmp_path):
    """A copy of the program, in which a test may add what it likes."""
    for name in ("mfr_bench", "tests", "configs", "shaders", "results/reference"):
        shutil.copytree(ROOT / name, tmp_path / "copy" / name, ignore=shutil.ignore_patterns("__pycache__"))
    return tmp_path / "copy"


def add(copy, path, before, after):
    """Replace a piece of text that is there once."""
    text = (copy / path).read_text()
    assert text.count(before) == 1, f"{path} has {before!r} {text.count(before)} times"
    (copy / path).write_text(text.replace(before, after))


def run_in(folder, copy, code):
    """Standard output of code that imports the changed copy."""
    done = subprocess.run([sys.executable, "-c", code], cwd=folder, capture_output=True, text=True, check=False,
                          env={**os.environ, "PYTHONPATH": str(copy), "COLUMNS": "200"})
    assert done.returncode == 0, done.stderr
    return done.stdout


def use(copy, y="time_ms", values=None, status="crashed"):
    """The output of the commands on made-up results in the changed copy."""
    at = copy.parent / "at"
    at.mkdir()
    return run_in(at, copy, f"Y, VALUES, STATUS = {y!r}, {values or {}!r}, {status!r}\n{USE}"), at


def test_a_column_is_one_entry_and_its_producer(copy):
    add(copy, "mfr_bench/store/columns.py", '    Column("repeats",', COLUMN)
    out, at = use(copy, "sorted_share", {"sorted_share": 0.25})
    header, *rows = (at / "a" / "results.csv").read_text().splitlines()
    assert "sorted_share" in header.split(",") and ",0.25," in rows[0]
    assert "| `sorted_share` | float |  | share of the pixels that were sorted | measure | sorted |" in out
    assert "<!-- sorted -->" in (at / "a" / "figures" / "planted-1.svg").read_text()
    (copy / "c.yaml").write_text("name: c\nscene: {size: [8, 8], depth_complexity: 4}\n"
                                 "methods: [kplus-array]\nsweep: {k: [2, 4]}\n"
                                 "figures: [{kind: lines, x: k, y: sorted_share}]\n")
    run_in(copy, copy, LOAD)


def test_a_status_is_one_entry(copy):
    add(copy, "mfr_bench/store/status.py", '    Status("timeout",', STATUS)
    out, at = use(copy, status="lost_device")
    assert "kplus-array, every cell: lost device: because" in out or "kplus-array: lost device: because" in out
    assert "| `lost_device` | the driver reset the device | none |  | yes | yes |  | 1 | crashed |" in out
    assert "lost device" in (at / "a.html").read_text()
    assert {json.loads(path.read_text())["status"] for path in (at / "a" / "cells").iterdir()} == {"ok", "lost_device"}
