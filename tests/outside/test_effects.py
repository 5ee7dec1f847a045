"""Effects of packages and folders outside: drawn, checked by their models, named in results; a broken one is a line."""

import csv
import json
import os
import re
import shutil

import numpy as np
import pytest

from mfr_bench.effects import EFFECTS, OWN_EFFECTS, Effect, Settings, bring
from mfr_bench.effects.rays import Rays
from mfr_bench.errors import MfrError, UsageError
from mfr_bench.oracle.foreign import image_of
from mfr_bench.outside.loader import code_hash

from .test_outside import ROOT, mfr, pip_install

EXAMPLE = ROOT / "examples" / "median-layer"
MODEL = "median_layer/median.py"
GLSL = "median_layer/shaders/effects/median.glsl"
SMALL = ("--set", "scene.size=[24,24]", "--set", "measure.time_limit_s=0.1", "--quiet")


@pytest.fixture
def folder(tmp_path):
    """A copy of the example, to break."""
    shutil.copytree(EXAMPLE, tmp_path / "median-layer", ignore=shutil.ignore_patterns("__pycache__"))
    return tmp_path / "median-layer"


def changed(folder, path, right, wrong):
    """Replace a text of a file, which has to be there.

    Its time moves on by a second, since Python takes a module of the same size and second for the one that it knows.
    """
    file = folder / path
    text, second = file.read_text(), file.stat().st_mtime + 1
    assert right in text
    file.write_text(text.replace(right, wrong, 1))
    os.utime(file, (second, second))


def rows_of(out):
    with open(out / "results.csv") as file:
        return {row["method"]: row for row in csv.DictReader(file)}


def test_an_installed_effect_is_measured_and_named(tmp_path):
    """The example, installed by pip: images as its model has them, by A-buffers and of the k nearest by a k-buffer."""
    pip_install(EXAMPLE, tmp_path / "site")
    done = mfr(tmp_path, "run", EXAMPLE / "median-layer.yaml", "--out", "out", *SMALL, site=tmp_path / "site")
    assert done.returncode == 0, done.stderr
    rows = rows_of(tmp_path / "out")
    assert {method: row["status"] for method, row in rows.items()} == dict.fromkeys(
        ("ab-array", "ab-ll", "kplus-array", "floor"), "ok")
    assert all(float(rows[method]["max_abs_error"]) <= 1e-6 for method in ("ab-array", "ab-ll", "kplus-array"))
    assert float(rows["kplus-array"]["max_error_all"]) > 0.1  # the middle of 8 is not that of 16
    code = code_hash(EXAMPLE / "median_layer")
    assert {row["package"] for row in rows.values()} == {f"median-layer 0.1.0 {code}"}
    manifest = json.loads((tmp_path / "out" / "manifest.json").read_text())
    assert manifest["packages"] == [{"name": "median-layer", "version": "0.1.0", "hash": code}]
    without = mfr(tmp_path, "table", "out")
    assert without.returncode == 0, without.stderr
    page = mfr(tmp_path, "report", "out", "--out", "page.html")
    assert page.returncode == 0, page.stderr


def test_a_config_alone_brings_no_effect(folder):
    done = mfr(folder, "run", "median-layer.yaml", "--dry-run")
    assert done.returncode == 2 and not done.stdout
    line, = done.stderr.splitlines()
    assert "scene.effect: 'median' is not allowed; allowed: transparency | " in line
    assert "one of a package that is installed or given by --methods FOLDER" in line


def test_a_wrong_name_gets_the_nearest(folder):
    changed(folder, "median-layer.yaml", "effect: median", "effect: medan")
    done = mfr(folder, "run", "median-layer.yaml", "--methods", ".", "--dry-run")
    line, = done.stderr.splitlines()
    assert done.returncode == 2 and line.endswith("; nearest: 'median'")


def test_code_of_the_effect_is_part_of_the_keys(folder):
    """A model that computes the same in another way is measured again, though no GLSL changed."""
    def keys(*options):
        done = mfr(folder, "run", "median-layer.yaml", "--methods", ".", "--out", "out", "--only", "ab-array", *SMALL,
                   *options)
        assert done.returncode == 0, done.stderr
        return {path.name for path in (folder / "out" / "cells").iterdir()}

    first = keys()
    changed(folder, MODEL, "// 2", "// 1 // 2")
    second = keys()
    assert second > first and len(second) == 2 * len(first)


@pytest.mark.parametrize(("path", "right", "wrong", "status", "said"), [
    (GLSL, "- 1u) / 2u", "+ 1u) / 2u", "wrong", "max_abs_error"),
    (MODEL, "    return image", "    raise SystemExit(3)", "crashed", "median.py:21: SystemExit: 3"),
], ids=["GLSL", "exit"])
def test_an_effect_that_fails_costs_its_cells(folder, path, right, wrong, status, said):
    changed(folder, path, right, wrong)
    done = mfr(folder, "run", "median-layer.yaml", "--methods", ".", "--out", "out", "--only", "ab-array", *SMALL)
    assert done.returncode == {"wrong": 3, "crashed": 1}[status], done.stderr
    row = rows_of(folder / "out")["ab-array"]
    assert row["status"] == status and said in row["reason"]
    assert "Traceback" not in done.stderr


RAYS = Rays(np.array([0, 3, 2]), np.array([0.1, 0.2, 0.3, 0.4, 0.5]), np.arange(20, dtype=np.uint8).reshape(5, 4))


@pytest.fixture
def effect(folder):
    """The settings of the effect in the copy, as the process that measures has it."""
    bring({"median": Effect("the middle", place=str(folder / "median_layer"), package={"name": "m", "hash": "0"})})
    yield Settings("median")
    bring({})


def test_the_model_shows_the_middle_fragment(effect):
    expected = [[0, 0, 0, 0], [4 / 255, 5 / 255, 6 / 255, 1], [12 / 255, 13 / 255, 14 / 255, 1]]
    np.testing.assert_allclose(image_of(RAYS, effect), expected)


@pytest.mark.parametrize(("wrong", "said"), [
    ("return image[1:]", r"array of shape \(2, 4\); allowed: \(3, 4\)"), ("return image / 0 * 0", "finite numbers"),
    ("return imag", "median.py:21: NameError: name 'imag' is not defined"),
    ("rays.depth[:] = 0", "ValueError: assignment destination is read-only"), ("return None", "array of shape"),
    ("return 'image'", "ValueError: could not convert string"), ("exit(3)", "median.py:21: SystemExit: 3")])
def test_a_model_that_fails_is_one_line(folder, effect, wrong, said):
    changed(folder, MODEL, "return image", wrong)
    with np.errstate(all="ignore"), pytest.raises(MfrError, match=said) as raised:
        image_of(RAYS, effect)
    assert "\n" not in str(raised.value)


@pytest.mark.parametrize(("path", "right", "wrong", "where", "said"), [
    (MODEL, "def model(", "def modell(", "median.py:11", "effect median has no model; allowed: def model"),
    (MODEL, "ordered=True", "needs='all'", "median.py:11", "needs 'all'; allowed: what in words, and needs nothing |"),
    (MODEL, "ordered=True", "keys=('far',)", "median.py:11", "reads the keys ('far',); allowed: a tuple of layer,"),
    (MODEL, "cases=(Case(FRAGMENTS, shows", "cases=(dict(shows", "median.py:11",
     "allowed: a tuple of Case(fragments, shows)"),
    (MODEL, "EFFECT = Effect(", "EFFECT = [].append(", "median.py:11", "list.append() takes no keyword arguments"),
    (GLSL, "effect_end", "effect_ends", "median.py:11", "effects/median.glsl has no effect_end"),
    (GLSL, "vec3 median", "#include \"no.glsl\"\nvec3 median", "median.py:11", "no.glsl: cannot be read"),
], ids=["model", "needs", "key", "case", "call", "function", "include"])
def test_a_declaration_with_a_mistake_costs_the_effect_and_one_line(folder, path, right, wrong, where, said):
    changed(folder, path, right, wrong)
    done = mfr(folder, "run", "median-layer.yaml", "--methods", ".", "--dry-run")
    assert done.returncode == 2
    assert any(where in line and said in line for line in done.stderr.splitlines()), done.stderr
    assert "'median' is not allowed" in done.stderr and "Traceback" not in done.stderr


def test_an_effect_of_the_program_cannot_be_replaced(folder):
    (folder / GLSL).rename(folder / GLSL.replace("median.", "layers."))
    (folder / MODEL).rename(folder / MODEL.replace("median.", "layers."))
    done = mfr(folder, "methods", "--markdown", "--methods", ".")
    assert "mfr-bench has effects/layers.glsl itself" in done.stderr
    assert "the effect 'layers' is declared twice, first in mfr-bench; allowed: a name of its own" in done.stderr


def test_the_table_of_effects_holds_what_is_brought_last():
    bring({"median": Effect("the middle")})
    try:
        assert Settings("median").effect.what == "the middle" and tuple(EFFECTS) == (*OWN_EFFECTS, "median")
    finally:
        bring({})
    assert tuple(EFFECTS) == OWN_EFFECTS
    with pytest.raises(UsageError, match=r"no effect 'median'; allowed: transparency, .* given by --methods FOLDER"):
        _ = Settings("median").effect


def test_the_page_shows_the_files_of_the_example():
    page = (ROOT / "docs" / "effects.md").read_text()
    found = {text.partition("\n")[0].lstrip("#/ "): text.partition("\n")[2]
             for text in re.findall(r"^```(?:python|glsl|yaml)\n(.*?)^```$", page, flags=re.MULTILINE | re.DOTALL)}
    assert set(found) == {MODEL, GLSL, "median-layer.yaml"}
    assert all((EXAMPLE / path).read_text() == text for path, text in found.items())
