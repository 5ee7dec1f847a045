"""Results that a hand or another program has edited: every command that reads them ends in lines, never a traceback.

MFR_BENCH_EDITS=0:2000 in the environment makes 2,000 edits; the suite makes the first 20 of them.
"""

import json
import os
import random
import shutil
from pathlib import Path

import pytest

from mfr_bench.report.figures import files
from mfr_bench.store import ResultFolder

from ..report import planted

EDITS = range(*map(int, os.environ.get("MFR_BENCH_EDITS", "0:20").split(":")))
VALUES = (None, True, -1, 0, 1, 0.5, -0.0, 1e-300, 1e308, 10**30, 2**63, "", "k", "inf", "$x^{$", "two\nlines", "\x00",
          "\ud800", "scene.", "a" * 500, [], [None], [1, "a"], [[1], {}], {}, {"a": 1}, {"a": {"b": [None]}},
          {"k": [4, 8]})
FIGURES = [
    {"kind": "lines", "x": "k", "y": "time_ms", "floor": True, "panels": "scene.pixel_density", "log": "xy"},
    {"kind": "stacked_passes", "x": "k", "y": "time_ms"},
    {"kind": "bars", "x": "k", "y": "memory_mib", "methods": ["kplus-array", "ab-array"]},
    {"kind": "pareto", "x": "time_ms", "y": "rmse"},
    {"kind": "heat", "x": "k", "rows": "scene.pixel_density", "y": "best_ratio"},
    {"kind": "breaking", "x": "k", "y": "max_abs_error"},
]
COMMANDS = (["table", "made"], ["plot", "made"], ["claims", "made"], ["conformance", "made"],
            ["compare", "made", "other"], ["compare", "other", "made"],
            ["advise", "made", "--max-error", "0.1", "--memory-mb", "64"], ["report", "made", "--out", "page.html"],
            ["pack", "made"], ["table", "made"], ["unpack", "made"])
ENDINGS = (0, 1, 2, 3, 4, 5, 6)


def cells():
    """A few methods at two k and two densities, one out of budget."""
    found = []
    for density in (0.5, 1.0):
        for k in (4, 8):
            where = {"scene": {"pixel_density": density}, "point": {"k": k, "scene.pixel_density": density}}
            found.append(planted.cell("floor", time_ms=1.0, scene={"pixel_density": density}, point=where["point"],
                                      params={"x": k}))
            found += [planted.cell(method, time_ms=2.0 + k, passes={"store": 1.0, "resolve": 0.5}, params={"k": k},
                                   values={"error_bound": 1e-6, "flip": 0.01}, **where)
                      for method in ("kplus-array", "ab-array", "mlab")]
    return [*found, planted.cell("kb-ll", time_ms=None, status="over_budget", reason="needs 9 GiB")]


@pytest.fixture
def made(here):
    """Results that are right, and a copy of them."""
    for name in ("made", "other"):
        folder = planted.folder(here / name, cells(), FIGURES,
                                {"k": [4, 8], "scene.pixel_density": [0.5, 1.0]}, zip={}, params={"k": 8})
    return folder.path.parent / "made"


def places(value, path=()):
    """Every place in a JSON value."""
    yield path
    members = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for name, member in members:
        yield from places(member, (*path, name))


def edit(path: Path, chance: random.Random) -> str:
    """Replace or delete a random value in a JSON file; what was done."""
    record = json.loads(path.read_text())
    found = [p for p in places(record) if p and len(p) < 5]
    by_depth = [[p for p in found if len(p) == depth] for depth in range(1, 5)]
    place = chance.choice(chance.choice([group for group in by_depth if group]))
    holder = record
    for name in place[:-1]:
        holder = holder[name]
    if chance.random() < 0.15:
        del holder[place[-1]]
        what = f"{path.name}: {place} deleted"
    else:
        value = chance.choice(VALUES)
        holder[place[-1]] = value
        what = f"{path.name}: {place} = {value!r}"
    path.write_text(json.dumps(record))
    return what


def test_no_edit_makes_a_traceback(made, mfr, monkeypatch):
    monkeypatch.setattr(os, "fsync", lambda _: None)
    monkeypatch.setattr(files, "render", lambda figure: (figure.draw_without_rendering(), {"png": b"", "svg": b""})[1])
    monkeypatch.setattr(os, "fork", None)  # a child's error would be told twice
    monkeypatch.setattr(files, "_write_shared", files._write)
    pristine = made.parent / "pristine"
    shutil.copytree(made, pristine)
    failed = []
    for number in EDITS:
        chance = random.Random(number)  # noqa: S311 - no secret
        shutil.rmtree(made)
        shutil.copytree(pristine, made)
        path = chance.choice([made / "manifest.json", *sorted(ResultFolder(made).cells_path.glob("*.json"))[:9]])
        what = edit(path, chance)
        for command in COMMANDS:
            try:
                ended = mfr(*command)
                assert ended.status in ENDINGS and "Traceback" not in ended.err
                assert not ended.status or ended.err.strip() or ended.out.strip(), "no line said why"
            except Exception as error:  # noqa: BLE001 - whatever a command raises is what is looked for
                failed.append(f"{number}: {what}: {' '.join(command)}: {type(error).__name__}: {error}")
    assert not failed, "\n".join(failed[:40])
