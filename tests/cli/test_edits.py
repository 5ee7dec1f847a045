"""Results that a hand or another program has edited: every command that reads them ends in lines, never a traceback.

MFR_BENCH_EDITS=0:2000 in the environment makes 2,000 edits; the suite makes the first 20 of them.
"""

import base64
import json
import os
import random
import shutil
import time
from contextlib import suppress
from pathlib import Path

import pytest

from mfr_bench.api import load
from mfr_bench.bundle.archive import INDEX, index_of
from mfr_bench.errors import MfrError
from mfr_bench.report.figures import files
from mfr_bench.store import ResultFolder
from mfr_bench.store.pack import zipped
from mfr_bench.store.record import cell_key

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
            ["report", "nights", "--trend", "--out", "trend.html"], ["status", "store"],
            ["merge", "made", "other", "--into", "merged"], ["collect", "store", "--into", "collected"],
            ["submit-results", "made", "--out", "bundle.zip", "--sign-off", "A. Smith"],
            ["verify", "crafted.zip", "--against", "other", "--into", "taken"],
            ["pack", "made"], ["table", "made"], ["unpack", "made"])
WRITTEN = ("merged", "collected", "taken", "nights", "store", "bundle.zip", "crafted.zip")
TASK = {"kind": "cpu", "number": 1, "count": 1, "cells": 17, "plan": "0" * 16, "job": None}
SUBMISSION = {"schema": 1, "engine": "local", "run": ["planted.yaml"], "tasks": [TASK]}
DEVICE_EDITS = 10  # of the edits above, one in so many is also read by commands that measure
PIXEL = base64.b64decode("iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAAAAAA6fptVAAAACklEQVR4nGNgAAAAAgABSK+kcQAAAABJRU5ErkJggg==")
PICTURES = {"png": PIXEL, "svg": b"<svg xmlns='http://www.w3.org/2000/svg'/>"}  # what stands for every figure
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


def keyed(record):
    """The record under the key that its content gives; under its own where that gives none."""
    try:
        return record | {"key": cell_key(record, "wall")}
    except (AttributeError, KeyError, TypeError, ValueError):
        return record


@pytest.fixture
def made(here):
    """Results that are right, and a copy of them."""
    for name in ("made", "other"):
        folder = planted.folder(here / name, list(map(keyed, cells())), FIGURES,
                                {"k": [4, 8], "scene.pixel_density": [0.5, 1.0]}, zip={}, params={"k": 8})
    return folder.path.parent / "made"


def copied_about(made: Path) -> None:
    """The results as one of two nights, as what a task of a store wrote, and as a bundle whose hashes are right."""
    here = made.parent
    for name in WRITTEN:
        shutil.rmtree(here / name, ignore_errors=True)
        (here / name).unlink(missing_ok=True)
    for source, target in ((made, "nights/1"), (here / "other", "nights/2"), (made, "store/tasks/cpu-1/results")):
        shutil.copytree(source, here / target)
    (here / "store" / "submission.json").write_text(json.dumps(SUBMISSION))
    where = f"{planted.DEVICE['slug']}/planted"
    packed = zipped({path.name: path.read_bytes() for path in ResultFolder(made).cells_path.glob("*.json")})
    members = {f"{where}/manifest.json": (made / "manifest.json").read_bytes(), f"{where}/cells.zip": packed}
    (here / "crafted.zip").write_bytes(zipped({INDEX: index_of(members, "A. Smith"), **members}))


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


def under_its_key(path: Path) -> Path:
    """Move an edited cell to the name that its content asks for, as another program would that makes keys too."""
    record = keyed(json.loads(path.read_text()))
    path.write_text(json.dumps(record))
    return path.rename(path.with_name(f"{record['key']}.json"))


def loaded(folder: str) -> None:
    """Read results as a notebook does; a mistake in them is one of the package's own errors."""
    with suppress(MfrError):
        load(folder)


def ended(mfr, *command: str) -> None:
    """Run a command: it ends with one of the statuses, without a traceback, and says why where it is not 0."""
    done = mfr(*command)
    assert done.status in ENDINGS and "Traceback" not in done.err
    assert not done.status or done.err.strip() or done.out.strip(), "no line said why"


@pytest.fixture(autouse=True)
def undrawn(monkeypatch):
    """Figures are laid out and not drawn, in this process; nothing waits for the disk."""
    monkeypatch.setattr(os, "fsync", lambda _: None)
    monkeypatch.setattr(files, "render", lambda figure, mark: (figure.draw_without_rendering(), PICTURES)[1])
    monkeypatch.setattr(files, "in_processes", lambda work, items, *_: map(work, items))


def test_no_edit_makes_a_traceback(made, mfr):
    pristine = made.parent / "pristine"
    shutil.copytree(made, pristine)
    failed = []
    for number in EDITS:
        chance = random.Random(number)  # noqa: S311 - no secret
        shutil.rmtree(made)
        shutil.copytree(pristine, made)
        path = chance.choice([made / "manifest.json", *sorted(ResultFolder(made).cells_path.glob("*.json"))[:9]])
        what = edit(path, chance)
        if path.parent != made and chance.random() < 0.5:
            under_its_key(path)
            what += ", under its key"
        copied_about(made)
        steps = [("load", lambda: loaded("made")), *((" ".join(c), lambda c=c: ended(mfr, *c)) for c in COMMANDS)]
        for name, step in steps:
            try:
                step()
            except Exception as error:  # noqa: BLE001 - whatever a command raises is what is looked for
                failed.append(f"{number}: {what}: {name}: {type(error).__name__}: {error}")
    assert not failed, "\n".join(failed[:40])


def test_every_command_reads_results_that_nobody_edited(made, mfr):
    """Otherwise an edit would show nothing: each command would end before it came to it."""
    copied_about(made)
    assert len(load("made").cells) == len(cells())
    failed = {" ".join(c): (done.status, done.err[:200]) for c in COMMANDS if (done := mfr(*c)).status}
    assert failed == {}


@pytest.mark.usefixtures("on_device")
def test_no_edit_of_earlier_results_stops_a_measurement(measured, tiny, mfr, monkeypatch):
    """`run` keeps, copies or measures again what it finds; `decide` and a forecast learn from it."""
    monkeypatch.setattr("mfr_bench.decide.budget.started", time.monotonic)  # not when the process of the tests began
    decided = ["decide", "--config", str(tiny), "--time-budget", "40s", "--out", "decided"]
    assert mfr(*decided).status == 0
    pristine = [(Path(name), shutil.copytree(name, f"pristine-{name}")) for name in ("out", "decided")]
    failed = []
    for number in EDITS[::DEVICE_EDITS]:
        chance = random.Random(number)  # noqa: S311 - no secret
        for folder, copy in pristine:
            shutil.rmtree(folder)
            shutil.copytree(copy, folder)
        folder = chance.choice(pristine)[0]
        path = chance.choice([folder / "manifest.json", *sorted(ResultFolder(folder).cells_path.glob("*.json"))])
        what = f"{folder}: {edit(path, chance)}"
        for command in (["run", tiny, "--dry-run", "--out", "out"], ["run", tiny, "--out", "out", "--quiet"], decided):
            try:
                ended(mfr, *map(str, command))
            except Exception as error:  # noqa: BLE001 - as above
                failed.append(f"{number}: {what}: {command[0]}: {type(error).__name__}: {error}")
    assert not failed, "\n".join(failed[:40])
