"""Scenes of packages and folders outside: made by a process of their own, measured, named; a broken one is a line."""

import json
import re
import shutil

import pytest

from mfr_bench.methods.spec.maker import Maker, Number
from mfr_bench.outside.loader import code_hash

from .test_effects import changed, rows_of
from .test_outside import ROOT, mfr, pip_install

EXAMPLE = ROOT / "examples" / "spiral-scene"
MAKER = "spiral_scene/spiral.py"
SMALL = ("--set", "scene.size=[24,24]", "--set", "measure.time_limit_s=0.1", "--only", "ab-array", "--quiet")


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A copy of the example, to break, and a cache of its own."""
    monkeypatch.setenv("MFR_BENCH_SCENES", str(tmp_path / "cache"))
    shutil.copytree(EXAMPLE, tmp_path / "spiral-scene", ignore=shutil.ignore_patterns("__pycache__"))
    return tmp_path / "spiral-scene"


def test_an_installed_scene_is_measured_and_named(tmp_path, monkeypatch):
    monkeypatch.setenv("MFR_BENCH_SCENES", str(tmp_path / "cache"))
    pip_install(EXAMPLE, tmp_path / "site")
    done = mfr(tmp_path, "run", EXAMPLE / "spiral-scene.yaml", "--out", "out", *SMALL, site=tmp_path / "site")
    assert done.returncode == 0, done.stderr
    cells = [json.loads(path.read_text()) for path in (tmp_path / "out" / "cells").glob("*.json")]
    assert {(cell["method"], cell["scene"]["options"], cell["status"]) for cell in cells} == {
        (method, f"arms={arms} layers=16", "ok") for method in ("ab-array", "floor") for arms in (2, 5)}
    assert all(cell["values"]["max_abs_error"] <= 1e-4 for cell in cells if cell["method"] == "ab-array")
    assert {cell["values"]["max_fragments"] for cell in cells} == {16}
    code = code_hash(EXAMPLE / "spiral_scene")
    assert rows_of(tmp_path / "out")["ab-array"]["package"] == f"spiral-scene 0.1.0 {code}"
    manifest = json.loads((tmp_path / "out" / "manifest.json").read_text())
    assert manifest["packages"] == [{"name": "spiral-scene", "version": "0.1.0", "hash": code}]
    assert mfr(tmp_path, "table", "out").returncode == 0
    page = mfr(tmp_path, "report", "out", "--out", "page.html")
    assert page.returncode == 0, page.stderr


def test_a_config_alone_makes_no_scene(folder):
    done = mfr(folder, "run", "spiral-scene.yaml", "--dry-run")
    line, = done.stderr.splitlines()
    assert done.returncode == 2 and "no scene 'spiral'; allowed: none now, or one of a package that is" in line
    assert not (folder.parent / "cache").exists()


@pytest.mark.parametrize(("path", "right", "wrong", "said"), [
    ("spiral-scene.yaml", "arms=2 ", "arm=2 ", "'arm=2' is no option; allowed: KEY=VALUE with KEY of arms, "),
    ("spiral-scene.yaml", "arms=2 ", "arms=65 ", "arms: '65' is not allowed; allowed: a whole number from 1 to 64"),
    ("spiral-scene.yaml", "maker: spiral", "maker: spirals", "no scene 'spirals'; allowed: spiral, or one of a "),
    (MAKER, "def fragments(", "def fragment(", "scene spiral has no fragments; allowed: def fragments("),
    (MAKER, "Number(3, 1, 64)", "Number(0, 1, 64)", "allowed: Number(default, least, most), the default between"),
    (MAKER, "SCENE = Maker(", "SCENE = dict(what=", "SCENE is a dict; allowed: SCENE = Maker(...)"),
    (MAKER, "width, height = size", "width, height, _ = size", "spiral.py:15: ValueError: not enough values to unpack"),
    (MAKER, "width, height = size", "import os; os._exit(9)", "scene spiral: ends its process (status 9)"),
    (MAKER, "np.float32)", "np.float64)", "depth is float64"),
    (MAKER, "+ 0.5) / max(", "+ 0.5) * max(", "depth of fragment"),
], ids=["option", "bound", "maker", "function", "default", "entry", "raises", "exits", "type", "range"])
def test_a_scene_that_fails_is_one_line(folder, path, right, wrong, said):
    changed(folder, path, right, wrong)
    done = mfr(folder, "run", "spiral-scene.yaml", "--methods", ".", "--dry-run", *SMALL)
    assert done.returncode == 2 and said in done.stderr, done.stderr
    assert "Traceback" not in done.stderr and len(done.stderr.splitlines()) <= 3


def test_code_of_the_scene_is_part_of_the_keys(folder):
    def made():
        done = mfr(folder, "run", "spiral-scene.yaml", "--methods", ".", "--out", "out", *SMALL)
        assert done.returncode == 0, done.stderr
        return [len(list(at.iterdir())) for at in (folder / "out" / "cells", folder.parent / "cache")]

    cells, files = made()
    assert cells == 4 and files >= 2
    changed(folder, MAKER, "% 1 < 0.5", "% 1 < 0.25")
    assert made() == [8, 2 * files]


@pytest.mark.parametrize(("options", "values"), [
    (None, {"arms": 3, "wide": 0.5}), ("arms=7", {"arms": 7, "wide": 0.5}),
    (" wide=1  arms=1", {"arms": 1, "wide": 1.0})])
def test_options_set_the_keys_of_an_entry(options, values):
    maker = Maker("arms", {"arms": Number(3, 1, 9), "wide": Number(0.5, 0.0, 1.0)})
    assert maker.values(options) == values


@pytest.mark.parametrize("options", ["arms", "arms=", "arms=1.5", "wide=nan", "wide=1e9", "arm=2", "="])
def test_options_that_are_none_are_refused(options):
    with pytest.raises(ValueError, match="allowed"):
        Maker("arms", {"arms": Number(3, 1, 9), "wide": Number(0.5, 0.0, 1.0)}).values(options)


def test_the_page_shows_the_files_of_the_example():
    page = (ROOT / "docs" / "own-scenes.md").read_text()
    found = {text.partition("\n")[0].lstrip("# "): text.partition("\n")[2]
             for text in re.findall(r"^```(?:python|yaml)\n(.*?)^```$", page, flags=re.MULTILINE | re.DOTALL)}
    assert all(found[path] == (EXAMPLE / path).read_text() for path in (MAKER, "spiral-scene.yaml"))
