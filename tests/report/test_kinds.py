"""A kind of figure is one file: what it declares is what a config may ask for, and what is drawn."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import mfr_bench
from mfr_bench import config
from mfr_bench.errors import UsageError
from mfr_bench.methods import catalog
from mfr_bench.report.figures.kinds import KINDS, all_keys, keys_of

from . import planted

PACKAGE = Path(mfr_bench.__file__).parent
DOTS = '''"""Dots, one for each cell."""

from ..kind import Key, Kind
from ..sheet import sheet_of

KIND = Kind("a dot for each cell", keys=(Key("dot", "its size", ("small", "large"), "small"),), y=("time_ms",))


def draw(result, options):
    figure = sheet_of(result, options, result.points, (f"Dots are {options['dot']}.",), 3.5, 2.0).figure()
    axes = figure.add_axes((0.2, 0.3, 0.7, 0.5))
    axes.plot([p.at(options["x"]) for p in result.points], [p.row["time_ms"] for p in result.points], "o")
    return figure
'''
CONFIG = """name: dots
scene: {{kind: quads, size: [8, 8], depth_complexity: 4}}
methods: [kplus-array]
sweep: {{k: [2, 4]}}
figures: [{{kind: dots, x: k, {}}}]
"""
USE = """
import sys
from mfr_bench import config, report, store
from mfr_bench.methods import catalog
experiment, = config.load(sys.argv[1], catalog())
assert not any(name.partition(".")[0] in ("matplotlib", "numpy") for name in sys.modules)
figure, = experiment.figures
folder = store.ResultFolder(sys.argv[2])
folder.write_manifest(folder.manifest() | {"figures": [figure.as_dict()]})
print(*report.write_figures(folder), sep="\\n")
"""


def configured(text: str, folder: Path) -> Path:
    path = folder / "dots.yaml"
    path.write_text(text)
    return path


@pytest.fixture
def copied(tmp_path):
    """The package as files of its own, with one file more."""
    copy = tmp_path / "copy"
    shutil.copytree(PACKAGE, copy / "mfr_bench", ignore=shutil.ignore_patterns("__pycache__"))
    for shared in ("shaders", "configs", "results/reference"):
        (copy / shared).parent.mkdir(exist_ok=True)
        (copy / shared).symlink_to(PACKAGE.parent / shared)
    (copy / "mfr_bench/report/figures/kinds/dots.py").write_text(DOTS)
    return copy


def run(copy: Path, *arguments: object) -> subprocess.CompletedProcess:
    return subprocess.run([sys.executable, *map(str, arguments)], cwd=copy, capture_output=True, text=True,
                          check=False, env={**os.environ, "PYTHONPATH": str(copy)})


def test_one_file_adds_a_kind_to_configs_and_figures(copied, tmp_path):
    folder = planted.folder(tmp_path / "run", [planted.cell("kplus-array", "K", 2.0, params={"k": 2}, point={"k": 2})])
    said = run(copied, "-c", USE, configured(CONFIG.format("dot: large"), tmp_path), folder.path)
    assert not said.stderr, said.stderr
    assert [Path(line).suffix for line in said.stdout.splitlines()] == [".png", ".svg"]
    assert all(Path(line).stat().st_size > 1000 for line in said.stdout.splitlines())


@pytest.mark.parametrize(("key", "told"), [
    ("dot: huge", "figures[0].dot: 'huge' is not allowed; allowed: small | large"),
    ("y: memory_mib", "figures[0].y: unknown column 'memory_mib'; allowed: time_ms"),
    ("fit: linear", "figures[0].fit: no use in a figure of kind dots; allowed: kind, x, y, title, methods, dot"),
])
def test_a_config_is_held_to_what_the_file_declares(copied, tmp_path, key, told):
    said = run(copied, "-m", "mfr_bench", "run", configured(CONFIG.format(key), tmp_path), "--dry-run")
    assert said.returncode == 2 and told in said.stderr


@pytest.mark.parametrize("name", KINDS)
def test_a_key_of_another_kind_is_refused(name, tmp_path):
    """Every key is allowed to the kinds that declare it, and to no other."""
    mine = {key.name for key in keys_of(KINDS[name])}
    for key in all_keys():
        if key.name in mine or key.takes == "texts":
            continue
        value = {"text": "k", "flag": "true"}.get(key.takes) or key.takes[0]
        text = CONFIG.format(f"{key.name}: {value}").replace("kind: dots", f"kind: {name}")
        with pytest.raises(UsageError) as error:
            config.load(str(configured(text, tmp_path)), catalog())
        assert any(f"figures[0].{key.name}: no use in a figure of kind {name}" in line for line in error.value.lines)


def test_kinds_that_share_a_name_share_the_key():
    found = {}
    for kind in KINDS.values():
        for key in keys_of(kind):
            assert found.setdefault(key.name, key) == key
