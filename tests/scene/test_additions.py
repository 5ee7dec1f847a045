"""Adding a kind of scene takes one file, which declares it and makes it."""

import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import mfr_bench

ROOT = Path(mfr_bench.__file__).parents[1]
PILE = '''"""`kind: pile`, quads of half the viewport in one corner."""

from __future__ import annotations

from dataclasses import dataclass

from ..spec.kind import CommonKeys, Described, Kind
from ..spec.values import Share


@dataclass(frozen=True, kw_only=True)
class PileKeys:
    height: Share = 0.5


def _too_low(scene):
    what = "height below 0.1; allowed: from 0.1 to 1"
    return (("scene.height",), what) if scene.height < 0.1 else None


class Pile(Kind):
    """A pile."""

    name = "pile"
    Keys = PileKeys
    generator = "kinds.pile.make"
    geometry = "quad"
    rules = (_too_low,)
    rows = (Described("`pile`", "a pile", "of every covered pixel", "the same", "nothing"),)
    key_words = "- `height`: share of the viewport."

    def covered_pixels(self, scene: CommonKeys) -> int:
        return scene.size[0] * rows_of(scene)

    def primitives(self, scene: CommonKeys) -> int:
        return scene.depth_complexity

    def expected_counts(self, scene: CommonKeys) -> list[float]:
        return [0.0] * scene.depth_complexity + [self.covered_pixels(scene)]


def rows_of(scene) -> int:
    return max(1, int(scene.height * scene.size[1]))


def make(scene, frame):
    import numpy as np

    from ..layouts import depths
    from ..quads import Quads

    n = scene.depth_complexity
    index = np.arange(n, dtype=np.uint64)
    rect = np.tile(np.array([0, 0, scene.size[0], rows_of(scene)], dtype=np.int32), (n, 1))
    return Quads(tuple(scene.size), rect, depths(index, scene.seed), np.full((n, 4), 128, np.uint8), 1.0, scene.seed)


KIND = Pile()
'''
USE = """
import sys
from mfr_bench.cli import main
from mfr_bench.config import load
from mfr_bench.errors import UsageError
from mfr_bench.methods import catalog
from mfr_bench.oracle.composite import stats_of
from mfr_bench.plan import expand, expected_stats
from mfr_bench.scene import Scene, generate
from mfr_bench.scene.page import kinds_page

experiment, = load("pile.yaml", catalog())
cell = expand(experiment, catalog())[1]
made, expected = stats_of(generate(cell.scene)), expected_stats(cell.scene)
assert (made.F, made.n, made.histogram) == (expected.F, expected.n, expected.histogram)
assert made.histogram == (192, 0, 0, 0, 0, 0, 64)
assert cell.scene.as_dict()["height"] == 0.25
assert "height" not in Scene(size=(4, 4), depth_complexity=1).as_dict()
assert "| `pile` |" in kinds_page() and "`kind: pile`" in kinds_page()
for override, line in (("scene.height=0.05", "height below 0.1"),
                       ("scene.kind=quads", "height has no use in kind quads; allowed: with kind pile"),
                       ("scene.layout=tiles", "layout has no use in kind pile")):
    try:
        load("pile.yaml", catalog(), None, [override])
    except UsageError as error:
        assert any(line in each for each in error.lines), error.lines
    else:
        raise AssertionError(override)
sys.argv = ["mfr-bench", "scene", "pile.yaml", "--out", "pile.npz"]
main()
"""


@pytest.fixture
def copy(tmp_path):
    """A copy of the program, in which a test may add what it likes."""
    for name in ("mfr_bench", "configs", "shaders"):
        shutil.copytree(ROOT / name, tmp_path / "copy" / name, ignore=shutil.ignore_patterns("__pycache__"))
    return tmp_path / "copy"


def test_a_kind_of_scene_is_one_file(copy):
    """Its keys are checked and recorded, its scene is planned, made and written, and its words stand on the page."""
    (copy / "mfr_bench" / "scene" / "kinds" / "pile.py").write_text(PILE)
    (copy / "pile.yaml").write_text("name: pile\nmethods: [ab-array]\n"
                                    "scene: {kind: pile, size: [16, 16], depth_complexity: 6, height: 0.25}\n")
    done = subprocess.run([sys.executable, "-c", USE], cwd=copy, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
