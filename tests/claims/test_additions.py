"""Adding a claim takes one file, or one entry of a file, apart from the planted case that tests it."""

import filecmp
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import mfr_bench

ROOT = Path(mfr_bench.__file__).parents[1]
PLANTED = Path("tests/claims/planted.py")
CLAIM = '''    Claim(
        "my-luminance", "gpupro5_ch2 §2.4", "Two-channel colour keeps luminance.", "unaffected", ("twochannel-fig4",),
        (CountedValue(pick(payload="two_channel"), "luminance_error", at_most(0.004)),),
    ),
)
'''
FILE = f'''"""Claims of a paper of my own."""

from ..evidence import at_most
from ..picks import pick
from ..rules import CountedValue
from ..verdict import Claim

CLAIMS = (
{CLAIM}'''
CASE = '''    "tc-error": ("twochannel-fig4", two_channel),
    "my-luminance": ("twochannel-fig4", lambda good: two_channel(True, luminance=0.002 if good else 0.1)),
'''
SHOW = """
import sys
from mfr_bench.cli import main
from tests.claims import planted
planted.folder("run", *(make(True) if callable(make) else make for make in planted.CASES["my-luminance"]))
for form in (["claims", "run"], *(["claims", "run", f"--{form}"] for form in ("json", "csv", "markdown")),
             ["configs", "--fidelity"]):
    sys.argv = ["mfr-bench", *form]
    try:
        main()
    except SystemExit as ended:
        assert not ended.code
    print("END")
"""


@pytest.fixture
def copy(tmp_path):
    """A copy of the program and of the tests of claims, in which a test may add what it likes."""
    for name in ("mfr_bench", "tests", "configs", "shaders", "results/reference"):
        shutil.copytree(ROOT / name, tmp_path / name, ignore=shutil.ignore_patterns("__pycache__"))
    shutil.copy(ROOT / "pyproject.toml", tmp_path)
    text = (tmp_path / PLANTED).read_text()
    text = text.replace(CASE.splitlines(keepends=True)[0], CASE)
    (tmp_path / PLANTED).write_text(text.replace('"tc-error"}', '"tc-error", "my-luminance"}'))
    return tmp_path


def touched(copy):
    """The files of the copy that are new or changed, but for the planted case."""
    files = [path.relative_to(copy) for name in ("mfr_bench", "tests") for path in (copy / name).rglob("*.py")]
    return {str(path) for path in files if path != PLANTED and not (
        (ROOT / path).exists() and filecmp.cmp(ROOT / path, copy / path, shallow=False))}


def run(copy, *arguments):
    done = subprocess.run([sys.executable, *arguments], cwd=copy, capture_output=True, text=True, check=False,
                          env={**os.environ, "PYTHONPATH": str(copy), "COLUMNS": "200"})
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def added_to_a_file(copy):
    path = copy / "mfr_bench/claims/papers/twochannel.py"
    path.write_text(path.read_text().rstrip().removesuffix(")") + CLAIM)
    return {"mfr_bench/claims/papers/twochannel.py"}


def added_as_a_file(copy):
    (copy / "mfr_bench/claims/papers/mine.py").write_text(FILE)
    return {"mfr_bench/claims/papers/mine.py"}


@pytest.mark.parametrize("add", [added_to_a_file, added_as_a_file])
def test_a_claim_is_one_file(copy, add):
    """It is judged, and stands in every form; the tests of all claims hold of it and of their number."""
    assert touched(copy) == set()
    added = add(copy)
    text, json, csv, markdown, fidelity, _ = run(copy, "-c", SHOW).split("END\n")
    assert "my-luminance: holds" in text
    assert '"id": "my-luminance"' in json and ",my-luminance,holds," in csv and "### my-luminance" in markdown
    assert "| `my-luminance`: Two-channel colour keeps luminance. |" in fidelity
    run(copy, "-m", "pytest", "-q", "-p", "no:cacheprovider", "tests/claims/test_claims.py",
        "tests/claims/test_command.py", "-k", "my-luminance or there_once or verdicts_of")
    assert touched(copy) == added and len(added) == 1
