"""The page on adding a method shows the files of the example, which work in the repository as well."""

import csv
import re
import shutil
import subprocess
import sys
from pathlib import Path

import mfr_bench

ROOT = Path(mfr_bench.__file__).parents[1]
EXAMPLE = ROOT / "examples" / "my-array"
PAGE = (ROOT / "docs" / "adding-a-method.md").read_text()


def blocks():
    """The page's files by path, as their first lines name them."""
    found = re.findall(r"^```(\w+)\n(.*?)^```$", PAGE, flags=re.MULTILINE | re.DOTALL)
    return {text.partition("\n")[0].lstrip("#/ "): text.partition("\n")[2] for language, text in found
            if language not in ("sh", "console")}


def test_the_page_shows_the_files_of_the_example():
    assert set(blocks()) == {"my_array/method.py", "my_array/shaders/methods/my_array/store.frag",
                             "my_array/shaders/methods/my_array/fetch.glsl", "my-array.yaml"}
    for path, text in blocks().items():
        assert (EXAMPLE / path).read_text() == text, path


EVERY = """
from mfr_bench.config import load
from mfr_bench.methods import catalog
for name in ("pareto", "meshes", "conformance"):
    experiment, = load(name, catalog())
    assert "my-array" in {entry.id for entry in experiment.methods}, name
"""


def test_the_files_work_in_the_repository(tmp_path):
    """The method is measured, exact, of the same memory as the one that it copies, and in every comparison of all.

    Its declaration and its shaders are all that the program needs.
    """
    for name in ("mfr_bench", "configs", "shaders"):
        shutil.copytree(ROOT / name, tmp_path / name, ignore=shutil.ignore_patterns("__pycache__"))
    shutil.copy(EXAMPLE / "my_array" / "method.py", tmp_path / "mfr_bench" / "methods" / "my_array.py")
    shutil.copytree(EXAMPLE / "my_array" / "shaders", tmp_path / "shaders", dirs_exist_ok=True)
    shutil.copy(EXAMPLE / "my-array.yaml", tmp_path)
    done = subprocess.run([sys.executable, "-c", "from mfr_bench.cli import main; main()", "run", "my-array.yaml",
                           "--out", "my-results"], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    with open(tmp_path / "my-results" / "results.csv") as file:
        rows = {row["method"]: row for row in csv.DictReader(file)}
    assert {name: row["status"] for name, row in rows.items()} == {"floor": "ok", "my-array": "ok", "ab-array": "ok"}
    assert {row["package"] for row in rows.values()} == {""}
    assert float(rows["my-array"]["max_abs_error"]) <= 1e-4
    assert rows["my-array"]["memory_bytes"] == rows["ab-array"]["memory_bytes"]
    assert float(rows["my-array"]["time_ms"]) > 0
    done = subprocess.run([sys.executable, "-c", EVERY], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
