"""`compare` as a user gives it: exit statuses, forms of output, mistakes."""

import csv
import io
import json

import pytest

from ..report import planted
from .conftest import apart

SCENES = (16, 32)


def made(path, factor=1.0, memory=2**20, name="planted", methods=("a", "b"), **manifest):
    """A result folder whose method `a` takes `factor` ms."""
    records = [planted.cell(method, time_ms=(factor if method == "a" else 2.0) * n / 16, width=0.004, count=22,
                            scene={"depth_complexity": n}, point={"scene.depth_complexity": n},
                            values={"memory_bytes": memory}) for method in methods for n in SCENES]
    return planted.folder(path, records, name=name, noise_floor_rel=0.002, **manifest).path


@pytest.mark.parametrize(("change", "options", "status"), [
    ({}, [], 0), ({}, ["--strict"], 0), ({"factor": 1.1}, [], 4), ({"factor": 0.9}, [], 0),
    ({"factor": 1.1}, ["--threshold", "20"], 0), ({"memory": 2**21}, [], 4), ({"memory": 2**19}, [], 0),
    ({"methods": ("a",)}, [], 5), ({"methods": ("a", "b", "c")}, [], 5), ({"methods": ("a",)}, ["--strict"], 5),
    ({"factor": 1.1, "methods": ("a",)}, ["--strict"], 4)])
def test_the_exit_status_tells_of_regressions_and_doubts(mfr, here, change, options, status):
    ended = mfr("compare", made(here / "old"), made(here / "new", **change), *options)
    assert ended.status == status, ended.out
    assert ended.err == ""


def test_it_says_what_changed_and_counts_the_rest(mfr, here):
    out = mfr("compare", made(here / "old"), made(here / "new", 1.1, environment={"mesa": "23"})).out
    lines = out.splitlines()
    assert any(line.startswith("a, n 16") and "SLOWER" in line and "1.100 [1.0" in line for line in lines)
    assert not any(line.startswith("b, n 16") for line in lines)
    assert "- mesa: unknown -> 23" in lines
    assert lines[-1] == "4 cells: 2 SLOWER, 0 FASTER, 0 UNCLEAR, 2 SAME, 0 MISSING"
    assert any(line.startswith("b, n 16") for line in
               mfr("compare", here / "old", here / "new", "--all").out.splitlines())


def test_other_forms_hold_every_cell(mfr, here):
    folders = made(here / "old"), made(here / "new", 1.1)
    found = json.loads(mfr("compare", *folders, "--json").out)
    assert found["counts"] == {"SLOWER": 2, "FASTER": 0, "UNCLEAR": 0, "SAME": 2, "MISSING": 0}
    slower = found["cells"][0]
    assert slower["verdict"] == "SLOWER" and slower["ratio_low"] < slower["ratio"] < slower["ratio_high"]
    rows = list(csv.DictReader(io.StringIO(mfr("compare", *folders, "--csv").out)))
    assert [row["verdict"] for row in rows] == ["SLOWER", "SLOWER", "SAME", "SAME"]
    markdown = mfr("compare", *folders, "--markdown").out
    assert markdown.startswith("# ") and "| a, n 16" in markdown


def test_folders_of_several_results_match_by_config(mfr, here):
    for side, factor in (("old", 1.0), ("new", 1.1)):
        made(here / side / "one", factor, name="first")
        made(here / side / "two", 1.0, name="second")
    found = json.loads(mfr("compare", "old", "new", "--json").out)
    assert [(c["experiment"], c["verdict"]) for c in found["cells"]] == [
        ("first", "SLOWER")] * 2 + [("first", "SAME")] * 2 + [("second", "SAME")] * 4


def test_lines_fit_a_narrow_terminal(mfr, here, monkeypatch):
    monkeypatch.setenv("COLUMNS", "60")
    out = mfr("compare", made(here / "old"), made(here / "new", 1.1), "--all").out
    assert max(map(len, out.splitlines())) <= 60


def test_mistakes_of_both_sides_are_told_at_once(mfr, here):
    (here / "empty").mkdir()
    ended = mfr("compare", "absent", "empty")
    assert ended.status == 2
    absent, empty = ended.err.splitlines()
    assert absent == "absent: no such folder; allowed: a folder that 'mfr-bench run' wrote, or one above such"
    assert empty == ("empty: no results in or below it; allowed: a folder that 'mfr-bench run' wrote, "
                     "or one above such")


def test_a_mistake_of_a_folder_that_stands_on_both_sides_is_told_once(mfr, here):
    made(here / "twice" / "a")
    made(here / "twice" / "b")
    for folder in ("absent", "twice"):
        line, = mfr("compare", folder, folder).err.splitlines()
        assert line.startswith(f"{folder}: ")


@pytest.mark.parametrize(("options", "complaint"), [
    (["--threshold", "0"], "'0' is not allowed; allowed: percent above 0, up to 100, such as 2"),
    (["--threshold", "much"], "'much' is not allowed"), (["--json", "--csv"], "more than one of --json")])
def test_options_that_mean_nothing_are_refused(mfr, here, options, complaint):
    ended = mfr("compare", made(here / "old"), made(here / "new"), *options)
    assert ended.status == 2
    assert complaint in ended.complaint


def test_results_that_share_nothing_or_twice_the_same_are_refused(mfr, here):
    made(here / "old", name="first")
    made(here / "new", name="second")
    assert "have no cell in common" in mfr("compare", "old", "new").complaint
    made(here / "twice" / "a")
    made(here / "twice" / "b")
    assert "both hold 'planted'" in mfr("compare", "twice", "old").complaint


def test_other_devices_are_compared_only_when_asked(mfr, here):
    made(here / "old")
    other = [planted.cell("a", time_ms=0.1, scene={"depth_complexity": 16}, point={"scene.depth_complexity": 16},
                          device={"renderer": "NVIDIA H200", "version": "4.6", "slug": "nvidia-h200"})]
    planted.folder(here / "new", other)
    assert "another device or driver" in mfr("compare", "old", "new").complaint
    assert "1 FASTER" in mfr("compare", "old", "new", "--across-devices").out


def test_it_needs_no_gl_and_survives_a_closed_pipe(here):
    made(here / "old")
    ended = apart("compare", "old", "old")
    assert ended.status == 0 and "4 SAME" in ended.out


def test_a_damaged_manifest_is_named_where_nothing_can_be_compared(mfr, tmp_path):
    """Its config's name is lost with it, so that no cell has a counterpart."""
    for name in ("one", "other"):
        planted.folder(tmp_path / name, [planted.cell("kb", "KB", 2.0)])
    (tmp_path / "other" / "manifest.json").write_text('{"name": "pla')
    ended = mfr("compare", tmp_path / "one", tmp_path / "other", "--across-devices")
    assert ended.status == 2 and "manifest.json: cannot be read" in ended.err and "no cell in common" in ended.err


@pytest.mark.parametrize("options", [[], ["--across-devices"]], ids=" ".join)
def test_a_side_whose_cells_are_all_unreadable_is_named_with_the_reason(mfr, here, options):
    """It is not taken for the results of another device."""
    made(here / "old")
    made(here / "new")
    for path in (here / "new" / "cells").glob("*.json"):
        path.write_text(json.dumps(json.loads(path.read_text()) | {"schema": 99}))
    ended = mfr("compare", "old", "new", *options)
    *files, complaint = ended.err.splitlines()
    assert ended.status == 2 and complaint.startswith("new: no cell of it can be used")
    assert len(files) == 4 and all("has schema 99, this program reads " in line for line in files)


def test_an_unsteady_run_is_named_by_its_folder(mfr, here):
    """Both sides have the same config, whose name would not tell them apart."""
    made(here / "old")
    made(here / "new", calibration_drift="the same work took twice as long")
    lines = mfr("compare", "old", "new").out.splitlines()
    assert [line for line in lines if "twice as long" in line] == ["- new: the same work took twice as long"]
