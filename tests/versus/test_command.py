"""`versus` on two trees and on a repository: what is measured, what it says of a worse tree, and its mistakes."""

import json
import os
import shutil
import signal
import subprocess
import sys
from pathlib import Path

import pytest

import mfr_bench

ROOT = Path(mfr_bench.__file__).parents[1]
EXAMPLE = ROOT / "examples" / "my-array"
QUICK = ("--quiet", "--rounds", "2", "--seconds", "0.1")
CONFIG = """\
name: two
scene: {size: [32, 24], depth_complexity: 6}
methods: [ab-array, kplus-array]
params: {k: 4}
"""


def versus(cwd, *arguments, **environment):
    env = {**os.environ, "PYTHONPATH": str(ROOT), **environment}
    return subprocess.run([sys.executable, "-m", "mfr_bench", "versus", *map(str, arguments)], cwd=cwd, text=True,
                          capture_output=True, check=False, env=env)


def git(folder, *arguments):
    names = {f"GIT_{who}_{what}": text for who in ("AUTHOR", "COMMITTER") for what, text in
             (("NAME", "a"), ("EMAIL", "a@b.invalid"))}
    subprocess.run(["git", *arguments], cwd=folder, check=True, capture_output=True, env=os.environ | names)


def test_a_tree_whose_images_are_wrong_is_worse(tmp_path):
    """A shader of the second tree is wrong: its cell fails there, and the other one is measured in turns.

    A default that is another in the second tree is told, and does not keep the cells from being compared.
    """
    for name in ("mfr_bench", "configs", "shaders", "results/reference"):
        shutil.copytree(ROOT / name, tmp_path / "tree" / name, ignore=shutil.ignore_patterns("__pycache__"))
    store = tmp_path / "tree" / "shaders" / "methods" / "array" / "store.frag"
    assert "slot * pixels + p" in store.read_text()
    store.write_text(store.read_text().replace("slot * pixels + p", "slot + p"))
    region = tmp_path / "tree" / "mfr_bench" / "methods" / "shared" / "screen_region.py"
    assert 'Param("touched", "off"' in region.read_text()
    region.write_text(region.read_text().replace('Param("touched", "off"', 'Param("touched", "bounds"'))
    (tmp_path / "two.yaml").write_text(CONFIG)
    done = versus(tmp_path, ROOT, "tree", "two.yaml", *QUICK, "--json", "--out", "kept")
    assert done.returncode == 4, done.stderr
    assert "self-tests" not in done.stderr  # the device passes them: the tree is to blame
    told = json.loads(done.stdout)
    cells = {cell["method"]: cell for cell in told["cells"]}
    assert any(change["worse"] and "ok -> wrong" in change["what"] for change in cells["ab-array"]["changes"])
    assert cells["kplus-array"]["changes"] == [{"what": "touched off -> bounds", "worse": None}]
    assert 0.5 < cells["kplus-array"]["raw_ratio"] < 2
    assert told["before"] == str(ROOT) and told["after"] == "tree"
    kept = {path.parts[-2] for path in (tmp_path / "kept").glob("*/results.csv")}
    assert kept == {"before", "after"}


@pytest.fixture
def repository(tmp_path):
    """A git repository that holds the example of a package, committed."""
    shutil.copytree(EXAMPLE, tmp_path / "repo" / "my-array", ignore=shutil.ignore_patterns("__pycache__"))
    git(tmp_path / "repo", "init", "-q")
    git(tmp_path / "repo", "add", "-A")
    git(tmp_path / "repo", "commit", "-qm", "first")
    return tmp_path / "repo" / "my-array"


def test_a_package_edited_in_place_is_held_against_its_commit(repository):
    """The program at hand measures both states of the package; what was checked out is gone afterwards."""
    method = repository / "my_array" / "method.py"
    method.write_text(method.read_text().replace('"2*n*P"', '"3*n*P"'))
    done = versus(repository, ".", "my-array.yaml", "--against", "HEAD", "--only", "my-array", *QUICK, "--json",
                  "--set", "scene.size=[24,24]")
    assert done.returncode == 4, done.stderr
    cells = {cell["method"]: cell for cell in json.loads(done.stdout)["cells"]}
    assert set(cells) == {"floor", "my-array"}
    change, = cells["my-array"]["changes"]
    assert change["worse"] and change["what"].startswith("memory ")
    listed = subprocess.run(["git", "worktree", "list"], cwd=repository, capture_output=True, text=True, check=True)
    assert len(listed.stdout.splitlines()) == 1


@pytest.mark.parametrize(("arguments", "said"), [
    (("a", "b"), "allowed: A B CONFIG, or B CONFIG --against A"),
    (("nothing", ".", "smoke"), "is no folder and no revision of"),
    ((".", "empty", "smoke"), "empty holds neither mfr_bench/ nor a method"),
    ((".", ".", "smok"), "nearest: 'smoke'"),
    ((".", ".", "smoke", "--only", "no-method"), "unknown method 'no-method'"),
    ((".", ".", "smoke", "--json", "--csv"), "versus: more than one of --json, --csv and --markdown"),
])
def test_a_mistake_is_one_line(repository, arguments, said):
    (repository / "empty").mkdir()
    done = versus(repository, *arguments, *QUICK)
    line, = done.stderr.splitlines()
    assert done.returncode == 2
    assert said in line


def test_a_tree_that_lacks_what_is_used_is_told(tmp_path):
    (tmp_path / "old" / "mfr_bench").mkdir(parents=True)
    (tmp_path / "old" / "mfr_bench" / "__init__.py").write_text("")
    done = versus(tmp_path, "old", ROOT, "smoke", *QUICK)
    line, = done.stderr.splitlines()
    assert done.returncode == 2 and "old: its code is too old, or too new" in line


def test_outside_a_repository_a_revision_is_no_folder(tmp_path):
    done = versus(tmp_path, "HEAD", ".", "smoke", *QUICK, GIT_CEILING_DIRECTORIES=str(tmp_path.parent))
    line, = done.stderr.splitlines()
    assert done.returncode == 2 and "is in no git repository" in line


def test_ctrl_c_ends_it_at_the_next_cell_and_leaves_nothing_behind(repository):
    command = [sys.executable, "-m", "mfr_bench", "versus", ".", "my-array.yaml", "--against", "HEAD", "--rounds", "50",
               "--seconds", "0.1", "--set", "scene.size=[24,24]"]
    with subprocess.Popen(command, cwd=repository, text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                          env=os.environ | {"PYTHONPATH": str(ROOT)}) as process:
        first = process.stderr.readline()
        process.send_signal(signal.SIGINT)
        said = process.stderr.read()
    assert first.startswith("1 of 300 visits") and process.returncode == 130
    assert said.splitlines()[-1] == "interrupted" and len(said.splitlines()) < 10
    listed = subprocess.run(["git", "worktree", "list"], cwd=repository, capture_output=True, text=True, check=True)
    assert len(listed.stdout.splitlines()) == 1


def test_a_folder_with_another_comparison_is_refused_before_anything_is_measured(tmp_path):
    (tmp_path / "kept" / "after").mkdir(parents=True)
    (tmp_path / "kept" / "after" / "manifest.json").write_text("{}")
    done = versus(tmp_path, ROOT, ROOT, "smoke", "--out", "kept", *QUICK)
    line, = done.stderr.splitlines()
    assert done.returncode == 2 and "--out kept: has the results of another comparison" in line


def test_an_empty_name_is_no_tree(tmp_path):
    for arguments in (("", ".", "smoke"), (".", "smoke", "--against", "")):
        line, = versus(tmp_path, *arguments, *QUICK).stderr.splitlines()
        assert "'' is no folder and no revision" in line
