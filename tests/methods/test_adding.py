"""The page on adding a method is followed to the letter, in a copy: its own code blocks, its own command."""

import csv
import re
import shutil
import subprocess
import sys
from pathlib import Path

import mfr_bench

ROOT = Path(mfr_bench.__file__).parents[1]
PAGE = (ROOT / "docs" / "adding-a-method.md").read_text()


def blocks():
    """The page's files by path, as their first lines name them, and its commands."""
    found = re.findall(r"^```(\w+)\n(.*?)^```$", PAGE, flags=re.MULTILINE | re.DOTALL)
    files = {text.partition("\n")[0].lstrip("#/ "): text for language, text in found if language != "sh"}
    return files, [text.strip() for language, text in found if language == "sh"]


def test_the_page_is_enough(tmp_path):
    """The method that it adds is measured, exact, and of the same image as the one that it copies."""
    files, (command, _) = blocks()
    for name in ("mfr_bench", "configs", "shaders"):
        shutil.copytree(ROOT / name, tmp_path / name, ignore=shutil.ignore_patterns("__pycache__"))
    for path, text in files.items():
        assert not (tmp_path / path).exists()
        (tmp_path / path).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / path).write_text(text)
    assert set(files) == {"mfr_bench/methods/my_array.py", "shaders/methods/my_array/store.frag",
                          "shaders/methods/my_array/fetch.glsl", "my.yaml"}
    program, *arguments = command.split()
    assert program == "mfr-bench"
    done = subprocess.run([sys.executable, "-c", "from mfr_bench.cli import main; main()", *arguments], cwd=tmp_path,
                          capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    with open(tmp_path / "my-results" / "results.csv") as file:
        rows = {row["method"]: row for row in csv.DictReader(file)}
    assert {name: row["status"] for name, row in rows.items()} == {"floor": "ok", "my-array": "ok", "ab-array": "ok"}
    assert float(rows["my-array"]["max_abs_error"]) <= 1e-4
    assert rows["my-array"]["memory_bytes"] == rows["ab-array"]["memory_bytes"]
    assert float(rows["my-array"]["time_ms"]) > 0
