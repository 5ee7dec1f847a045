"""`plot` and `table`: everything again from the store alone, with no OpenGL to import."""

import json
import shutil
import subprocess
import sys

import pytest

from ..patience import PATIENCE_S
from .conftest import CELLS, FIGURE, TINY, Ended, cells, environment, rows

FIGURES = FIGURE.replace("]", ", {kind: bars, x: k, y: memory_bytes}]")

BLOCKED = ("moderngl", "glcontext", "OpenGL", "mfr_bench.gpu", "mfr_bench.run.worker")
NO_GL = f"""
import sys
class Blocked:
    def find_spec(self, name, path=None, target=None):
        if any(name == b or name.startswith(b + ".") for b in {BLOCKED!r}):
            raise ImportError(name + " is not to be imported")
sys.meta_path.insert(0, Blocked())
sys.argv[0] = "mfr-bench"
from mfr_bench.cli import main
main()
"""


def without_gl(*arguments):
    done = subprocess.run([sys.executable, "-c", NO_GL, *map(str, arguments)], capture_output=True, text=True,
                          timeout=PATIENCE_S, env=environment(), check=False)
    return Ended(done.returncode, done.stdout, done.stderr)


@pytest.fixture(scope="module")
def results(device, tmp_path_factory):
    """A measured folder, for copying."""
    place = tmp_path_factory.mktemp("results")
    (place / "tiny.yaml").write_text(TINY + FIGURES)
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(place)
        patch.setattr("mfr_bench.gpu.device.open_device", lambda want="auto": device)
        patch.setattr(sys, "argv", ["mfr-bench", "run", "tiny.yaml", "--out", "out"])
        from mfr_bench.cli import main
        with pytest.raises(SystemExit) as ended:
            main()
    assert ended.value.code == 0
    return place / "out"


@pytest.fixture
def folder(results, here):
    shutil.copytree(results, here / "out")
    return here / "out"


def contents(folder):
    return {str(path.relative_to(folder)): path.read_bytes() for path in sorted(folder.rglob("*")) if path.is_file()}


def test_the_blocked_import_is_what_render_needs(folder):
    (folder.parent / "tiny.yaml").write_text(TINY)
    assert "is not to be imported" in without_gl("render", "tiny.yaml", "--method", "floor", "--out", "x.npy").err


def test_a_run_leaves_gl_to_the_process_that_measures(folder):
    (folder.parent / "tiny.yaml").write_text(TINY)
    ended = without_gl("run", "tiny.yaml", "--out", "again")
    assert ended.status == 0
    assert f"{CELLS} cells: {CELLS} ok" in ended.out


def test_plot_draws_the_same_figures_without_gl(folder):
    before = contents(folder)
    shutil.rmtree(folder / "figures")
    ended = without_gl("plot", "out")
    assert (ended.status, ended.err) == (0, "")
    assert ended.out.splitlines() == [f"out/figures/tiny-{i}.{kind}" for i in (1, 2) for kind in ("png", "svg")]
    assert contents(folder) == before


def test_table_writes_the_same_tables_without_gl(folder):
    before = contents(folder)
    shutil.rmtree(folder / "tables")
    for name in ("results.csv", "passes.csv"):
        (folder / name).unlink()
    ended = without_gl("table", "out")
    assert (ended.status, ended.err) == (0, "")
    assert ended.out.startswith("tiny: Tiny\n")
    assert contents(folder) == before


def test_every_result_below_a_folder_is_found(mfr, folder, here):
    shutil.copytree(folder, here / "deep" / "er")
    shutil.copytree(folder, here / "deep" / "est")
    assert mfr("table", "deep").out.count("tiny: Tiny") == 2
    assert mfr("table", "deep", "deep/er", "out").out.count("tiny: Tiny") == 3


def test_a_row_that_is_copied_in_is_told(mfr, folder):
    record = cells(folder)["ab-array", None]
    key = "0" * len(record["key"])
    text = (folder / "cells" / f"{record['key']}.json").read_text()
    (folder / "cells" / f"{key}.json").write_text(
        text.replace(record["key"], key).replace('"AB_Array"', '"Copied"'))
    assert mfr("table", "out").status == 0
    assert [r["label"] for r in rows(folder / "results.csv")].count("Copied") == 1


def test_damaged_cells_are_set_aside_and_named(mfr, folder):
    names = sorted(path.name for path in (folder / "cells").iterdir())
    (folder / "cells" / names[0]).write_bytes(b"\x00\xff")
    (folder / "cells" / names[1]).write_text('{"schema": 99}')
    (folder / "cells" / "notes.txt").write_text("mine")
    ended = mfr("table", "out")
    assert ended.status == 0
    for name in (names[0], names[1], "notes.txt"):
        assert f"- out/cells/{name}: " in ended.out
    assert len(rows(folder / "results.csv")) == CELLS - 2
    assert (folder / "cells" / f"{names[0]}.damaged").exists()
    assert (folder / "cells" / names[1]).exists()


@pytest.fixture
def no_figures(folder):
    manifest = json.loads((folder / "manifest.json").read_text())
    (folder / "manifest.json").write_text(json.dumps(manifest | {"figures": []}))


def test_plot_names_damaged_cells_on_stderr(mfr, folder, no_figures):
    name = min(path.name for path in (folder / "cells").iterdir())
    (folder / "cells" / name).write_text("[]")
    ended = mfr("plot", "out")
    assert (ended.status, ended.out) == (0, "")
    assert ended.err.startswith(f"out/cells/{name}: ")


def test_plot_together_draws_what_several_results_hold(mfr, folder):
    """A copy stands for a second folder of the same experiment; alone, it has nothing beside it."""
    alone = mfr("plot", "out", "--together", "devices")
    assert (alone.status, alone.out) == (0, "") and "no experiment is in more than one" in alone.err
    shutil.copytree(folder, folder.parent / "again")
    ended = mfr("plot", "out", "again", "--together", "devices")
    assert ended.status == 0
    drawn = [f"devices/tiny-{what}.{kind}" for what in (1, 2, "ratios", "ranks") for kind in ("png", "svg")]
    assert ended.out.splitlines() == [*drawn, "devices/tiny-devices.md"]


@pytest.mark.parametrize("text", ["", "{", "[]", '{"schema": 2}', '{"schema": 1, "cells": 3}',
                                  '{"schema": 1, "noise_floor_rel": "little"}'])
def test_a_damaged_manifest_costs_no_row(mfr, folder, text):
    (folder / "manifest.json").write_text(text)
    ended = mfr("table", "out")
    assert ended.status == 0
    assert len(rows(folder / "results.csv")) == CELLS
    assert "manifest.json" in ended.out


def test_a_folder_without_cells_is_an_empty_table(mfr, folder):
    shutil.rmtree(folder / "cells")
    ended = mfr("table", "out")
    assert ended.status == 0
    assert f"{CELLS} planned cells have no record yet" in ended.out
    drawn = without_gl("plot", "out")
    assert (drawn.status, drawn.out) == (0, "")
    assert [line.split(":")[:2] for line in drawn.err.splitlines()] == [
        [f"out/figures/tiny-{number}", f" not drawn ({kind})"]
        for number, kind in ((1, "lines of time_ms"), (2, "bars of memory_bytes"))]


def test_a_folder_that_can_only_be_read_is_shown_all_the_same(mfr, folder):
    shutil.rmtree(folder / "tables")
    (folder / "tables").write_text("in the way, as permissions are to anyone but root")
    ended = mfr("table", "out")
    assert ended.status == 1
    assert "Time, ms" in ended.out
    line, = ended.err.splitlines()
    assert line.startswith("out/tables/results.md: cannot be written: Not a directory; ")
