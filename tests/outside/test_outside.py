"""Methods of packages and folders outside: found, measured, named in results; a broken one costs itself and a line."""

import csv
import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import mfr_bench
from mfr_bench.outside.loader import code_hash

ROOT = Path(mfr_bench.__file__).parents[1]
EXAMPLE = ROOT / "examples" / "my-array"
METHOD = "my_array/method.py"
STORE = "my_array/shaders/methods/my_array/store.frag"


def pip_install(package, folder):
    """Install a package into a folder by pip, without the network."""
    done = subprocess.run([sys.executable, "-m", "pip", "install", "--quiet", "--no-deps", "--no-build-isolation",
                           "--no-index", "--disable-pip-version-check", "--target", folder, package],
                          capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


def mfr(cwd, *arguments, site=""):
    """A command in a folder, with another folder of installed packages in front of this program's."""
    env = {name: value for name, value in os.environ.items() if name not in ("MFR_BENCH_METHODS", "PYTHONPATH")}
    path = os.pathsep.join(filter(None, [str(site), str(ROOT)]))
    return subprocess.run([sys.executable, "-m", "mfr_bench", *map(str, arguments)], cwd=cwd, text=True, check=False,
                          capture_output=True, env=env | {"PYTHONPATH": path})


@pytest.fixture
def folder(tmp_path):
    """A copy of the example, to break."""
    shutil.copytree(EXAMPLE, tmp_path / "my-array", ignore=shutil.ignore_patterns("__pycache__"))
    return tmp_path / "my-array"


def test_an_installed_package_is_measured_and_named(tmp_path):
    """The example, installed by pip; its rows name the package, its version and the hash of its code."""
    pip_install(EXAMPLE, tmp_path / "site")
    done = mfr(tmp_path, "run", EXAMPLE / "my-array.yaml", "--out", "out", "--set", "measure.time_limit_s=0.2",
               site=tmp_path / "site")
    assert done.returncode == 0, done.stderr
    with open(tmp_path / "out" / "results.csv") as file:
        rows = {row["method"]: row for row in csv.DictReader(file)}
    code = code_hash(EXAMPLE / "my_array")
    assert rows["my-array"]["status"] == "ok"
    assert float(rows["my-array"]["max_abs_error"]) <= 1e-4
    assert {name: row["package"] for name, row in rows.items()} == {
        "my-array": f"my-array 0.1.0 {code}", "ab-array": "", "floor": ""}
    manifest = json.loads((tmp_path / "out" / "manifest.json").read_text())
    assert manifest["packages"] == [{"name": "my-array", "version": "0.1.0", "hash": code}]


def test_a_config_alone_loads_no_code(folder):
    done = mfr(folder, "run", "my-array.yaml", "--dry-run")
    assert done.returncode == 2
    assert "'my-array'" in done.stderr and "allowed" in done.stderr


@pytest.mark.parametrize(("path", "right", "wrong", "where", "said"), [
    (METHOD, "METHODS = [", "METHODS = [[", "my_array/method.py:", "was never closed"),
    (METHOD, "Buffer(\"counter\"", "Bufer(\"counter\"", "my_array/method.py:23", "name 'Bufer' is not defined"),
    (METHOD, "methods/my_array/fetch.glsl", "methods/my_array/fech.glsl", "my_array/method.py:",
     "methods/my_array/fech.glsl: cannot be read"),
    (METHOD, "METHODS = [", "import os\nos._exit(7)\nMETHODS = [", "my-array:1", "ends the process (status 7)"),
    (METHOD, "METHODS = [", "raise SystemExit\nMETHODS = [", "my-array:1", "ends the process (status 0)"),
    (METHOD, "clear(\"counter\"),", "clear(\"counter\", expand=print),", "my_array/method.py:14",
     "a function of its own (builtins.print); allowed: those of mfr_bench.methods.shared"),
    (METHOD, 'id="my-array"', 'id="floor"', "my-array", "the id 'floor' is declared twice, first in mfr-bench"),
    (STORE, '#include "scene/fragment.glsl"', '#include "scene/fragmnt.glsl"', "my_array/method.py:",
     "methods/my_array/store.frag:5: scene/fragmnt.glsl: cannot be read"),
], ids=["syntax", "name", "fetch", "exit", "system exit", "function", "id", "include"])
def test_a_broken_folder_costs_itself_and_one_line(folder, path, right, wrong, where, said):
    file = folder / path
    assert right in file.read_text()
    file.write_text(file.read_text().replace(right, wrong, 1))
    done = mfr(folder, "methods", "--markdown", "--methods", folder)
    assert done.returncode == 0
    line, = done.stderr.splitlines()
    assert where in line and said in line and line.endswith("; the catalog is without it")
    assert "`ab-array`" in done.stdout and "`my-array`" not in done.stdout


def test_a_shader_of_the_program_cannot_be_replaced(folder):
    own = folder / "my_array" / "shaders" / "scene"
    own.mkdir()
    (own / "fragment.glsl").write_text("// nothing\n")
    done = mfr(folder, "methods", "--markdown", "--methods", folder)
    line, = done.stderr.splitlines()
    assert "mfr-bench has scene/fragment.glsl itself; allowed: names of your own" in line


def test_comments_are_no_code(folder):
    """The hash of a package changes with its declarations and GLSL, not with comments and layout."""
    before = code_hash(folder / "my_array")
    store = folder / STORE
    store.write_text("// another comment\n" + store.read_text())
    (folder / METHOD).write_text("# a comment\n" + (folder / METHOD).read_text())
    assert code_hash(folder / "my_array") == before
    store.write_text(store.read_text().replace("slot <", "slot <="))
    assert code_hash(folder / "my_array") != before


def test_new_method_renames_every_file_and_word(tmp_path):
    done = mfr(tmp_path, "new-method", "two-lists")
    assert done.returncode == 0
    files = {path.relative_to(tmp_path) for path in tmp_path.rglob("*") if path.is_file()}
    assert {Path(line) for line in done.stdout.splitlines()[:-1]} == files
    assert Path("two-lists/two_lists/shaders/methods/two_lists/store.frag") in files
    assert not any(re.search(r"\bmy[-_ ]array", (tmp_path / path).read_text(), re.IGNORECASE) for path in files)
    again = mfr(tmp_path, "new-method", "two-lists")
    assert again.returncode == 2 and "is there already" in again.stderr
    bad = mfr(tmp_path, "new-method", "Two_lists")
    assert bad.returncode == 2 and "allowed: small letters and digits" in bad.stderr


def test_check_finds_a_fault_that_the_template_has_not(folder):
    """A wrong index in the store breaks images and the promise of every layout: exit status 3."""
    store = folder / STORE
    store.write_text(store.read_text().replace("slot * pixels + p", "slot + p"))
    done = mfr(folder, "check", "my-array", "--methods", ".", "--no-race")
    assert done.returncode == 3
    assert "FAILED    every image is as promised" in done.stdout
    assert "ok        every stage of every variant expands" in done.stdout
