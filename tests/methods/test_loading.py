"""A mistake in a declaration is one line with file, line, allowed and nearest; the other methods still load."""

import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import mfr_bench

ROOT = Path(mfr_bench.__file__).parents[1]
GOOD = (ROOT / "mfr_bench" / "methods" / "array.py").read_text()
GOOD = GOOD.replace('"ab-array"', '"mine"').replace('"kb-ab-array"', '"mine-of-k"')


@pytest.fixture(scope="module")
def copy(tmp_path_factory):
    """A copy of the program, in which a test may add what it likes."""
    at = tmp_path_factory.mktemp("copy")
    for name in ("mfr_bench", "configs", "shaders"):
        shutil.copytree(ROOT / name, at / name, ignore=shutil.ignore_patterns("__pycache__"))
    return at


def methods_with(copy, text):
    """`methods --markdown` with a family file of this text: its output, and its lines on stderr."""
    (copy / "mfr_bench" / "methods" / "mine.py").write_text(text)
    code = "from mfr_bench.cli import main; main()"
    done = subprocess.run([sys.executable, "-B", "-c", code, "methods", "--markdown"], cwd=copy, capture_output=True,
                          text=True, check=False)
    return done.stdout, done.stderr.splitlines()


def test_a_family_without_order_comes_last(copy):
    out, lines = methods_with(copy, GOOD.replace("ORDER = 2", ""))
    assert lines == []
    assert out.rindex("`mine`") > out.index("`ab-array`")


@pytest.mark.parametrize(("right", "wrong", "said"), [
    ("METHODS =", "METHODS_ =", "no METHODS; allowed: METHODS = [Method(...), ...]"),
    ("ORDER = 2", "ORDER = ", "invalid syntax"),
    ("guarantee=\"exact all\"", "guarantee=\"exact al\"",
     "the guarantee 'exact al' is none; allowed: exact all, exact k nearest, exact k best, "),
    ("guarantee=\"exact all\"", "guarantee=\"exact al\"", "; nearest: 'exact all'"),
    ("guarantee=", "garantee=", "unexpected keyword argument 'garantee'; allowed: id, name, "),
    ("writes=(\"counter\", \"nodes\")", "writes=(\"counter\", \"node\")",
     "pass store uses 'node', which is no buffer or target of the method; allowed: counter, nodes, "),
    ("\"2*min(room or n, n)*P\"", "\"2*min(rom or n, n)*P\"", "of buffer nodes has the name 'rom'; "),
    ("\"2*min(room or n, n)*P\"", "\"2*min(rom or n, n)*P\"", "nearest: 'room'"),
    ("\"2*min(room or n, n)*P\"", "\"2*min(room or n, n*P\"", "cannot be read; allowed: arithmetic over names"),
    ("guarantee=", "garantee=", "; nearest: 'guarantee'"),
    ("guarantee=\"exact all\",", "", "missing 1 required positional argument: 'guarantee'; allowed: id, name, "),
    ("\"mine\"", "\"floor\"", "the id 'floor' is declared twice, first in baseline.py; allowed: an id of its own"),
])
def test_a_mistake_is_one_line_and_the_catalog_loads(copy, right, wrong, said):
    assert right in GOOD
    out, (line,) = methods_with(copy, GOOD.replace(right, wrong))
    assert said in line
    assert "mfr_bench/methods/mine.py:" in line
    assert "`ab-array`" in out
