"""`run`: what is measured, kept, skipped and refused, and how it ends."""

import json
import re

import pytest

from mfr_bench.cli.session import MANY
from mfr_bench.report.data import percent

from .conftest import CELLS, FIGURE, TINY, apart, cells, rows

pytestmark = pytest.mark.usefixtures("on_device")


# --- a run and its results -----------------------------------------------------------------------


def test_every_cell_becomes_a_row_with_a_checked_image(mfr, tiny, here):
    tiny.write_text(TINY + FIGURE)
    ended = mfr("run", tiny, "--out", "out")
    assert ended.status == 0
    found = rows(here / "out" / "results.csv")
    assert [(r["method"], r["k"], r["status"]) for r in found] == [
        ("floor", "", "ok"), ("ab-array", "", "ok"), ("kplus-array", "2", "ok"), ("kplus-array", "4", "ok")]
    assert all(float(r["time_ms"]) > 0 and int(r["samples"]) == 7 for r in found)
    assert all(float(r["max_abs_error"]) <= 1e-4 and r["wrong_pixels"] == "0" for r in found[1:])
    assert found[0]["max_abs_error"] == ""  # blending in submission order promises no image
    assert {r["floor_ms"] for r in found} == {found[0]["time_ms"]}
    assert {p["pass"] for p in rows(here / "out" / "passes.csv") if p["method"] == "ab-array"} >= {"store", "resolve"}
    assert sorted(path.name for path in (here / "out" / "figures").iterdir()) == ["tiny.png", "tiny.svg"]
    assert "| K+B-Array" in (here / "out" / "tables" / "results.md").read_text()


def test_a_time_budget_too_short_for_any_cell_is_said_to_be(mfr, tiny, monkeypatch):
    """Repeated, it would measure nothing either."""
    monkeypatch.setattr("mfr_bench.cli.session.Session._deadlines", lambda *_: (0.0, float("inf")))
    ended = mfr("run", tiny, "--out", "out", "--time-budget", "1s")
    assert ended.status == 0
    line, = (line for line in ended.out.splitlines() if line.startswith("left out for the time budget: "))
    assert line.endswith("; none was finished in this time: with a larger --time-budget the same command measures them")


def test_it_prints_the_tables_then_a_summary(mfr, tiny):
    tiny.write_text(TINY + FIGURE)
    ended = mfr("run", tiny, "--out", "out")
    lines = ended.out.splitlines()
    assert lines[0] == "tiny: Tiny"
    assert any(line.startswith("Time, ms") for line in lines)
    assert lines[-5:] == [f"{CELLS} cells: {CELLS} ok", next(x for x in lines[-5:] if x.startswith("noise floor ")),
                          "tables  out/tables/results.md", "figures out/figures/tiny.png", lines[-1]]
    assert re.fullmatch(r"device busy with frames \d+ % of [\d.]+ s; \S+ \d+ %, \S+ \d+ %, \S+ \d+ %", lines[-1])


@pytest.mark.parametrize("columns", [50, 80, 120])
def test_tables_are_as_wide_as_the_terminal(mfr, measured, monkeypatch, columns):
    monkeypatch.setenv("COLUMNS", str(columns))
    lines = mfr("table", "out").out.splitlines()
    assert max(map(len, lines)) <= columns
    assert sum(line.split()[:1] == ["AB_Array"] for line in lines) >= 4


def test_progress_is_a_line_per_cell_with_the_time_left(mfr, tiny):
    lines = mfr("run", tiny, "--out", "out").err.splitlines()
    assert len(lines) == CELLS
    assert all(line.startswith(f"tiny {i}/{CELLS}") for i, line in enumerate(lines, 1))
    assert all(" left" in line for line in lines[1:-1])
    assert " left" not in lines[-1]
    assert any("K+B-Array k=4: " in line and line.endswith(" ms") for line in lines)


def test_the_manifest_tells_of_the_machine_and_the_timer_at_both_ends(measured):
    manifest = json.loads((measured / "manifest.json").read_text())
    found = manifest["environment"]
    assert found["gpu"] == manifest["device"]["renderer"] and found["cores"] >= 1 and found["kernel"]
    assert set(found["start"]) == set(found["end"]) == {"load", "gpu"}
    assert set(manifest["calibration"]) == set(manifest["calibration_end"])
    assert manifest["calibration"]["resolution_ms"]["wall"] > 0
    assert "calibration_drift" in manifest


def test_an_unsteady_device_is_told_of(measured, mfr):
    path = measured / "manifest.json"
    manifest = json.loads(path.read_text()) | {"calibration_drift": "the same work took twice as long"}
    path.write_text(json.dumps(manifest))
    assert "unsteady: the same work took twice as long" in mfr("table", measured).out


def test_a_run_that_was_unsteady_says_so_itself(mfr, tiny, here, monkeypatch):
    """`table` told it, and the run whose numbers they are did not; nor did its tables on disk."""
    drift = "the same work took 2 times as long at the end of the run as at its start"
    monkeypatch.setattr("mfr_bench.measure.calibration.disagreement", lambda start, end: drift)
    ended = mfr("run", tiny, "--out", "out", "--report", "page.html")
    assert f"unsteady: {drift}" in " ".join(ended.out.split())
    assert f"unsteady: {drift}" in (here / "out" / "tables" / "results.md").read_text()
    assert f"unsteady: {drift}" in (here / "page.html").read_text()


def test_the_manifest_keeps_the_split_and_the_noise_floor(measured):
    manifest = json.loads((measured / "manifest.json").read_text())
    assert {"start-up", "plan", "scene", "upload", "compile", "read-back", "oracle", "check", "flip", "first frames",
            "counting frames", "warm-up", "measure", "passes", "last frames", "count", "reference", "store",
            "calibration", "report", "other"} == set(manifest["split_s"]) - {"wait"}  # where the machine is not quiet
    assert manifest["beside_s"] == {}  # images so small are compared by the process that measures
    assert manifest["noise_floor_rel"] > 0
    assert len(manifest["cells"]) == CELLS
    assert f"noise floor {percent(manifest['noise_floor_rel'])}" in (measured / "tables" / "results.md").read_text()


# --- options -------------------------------------------------------------------------------------


@pytest.mark.parametrize(("only", "found"), [
    ("kplus-array", {"floor", "kplus-array"}), ("kplus-array, ab-array", {"floor", "kplus-array", "ab-array"}),
    ("floor", {"floor"}),
])
def test_only_some_methods(mfr, tiny, here, only, found):
    assert mfr("run", tiny, "--out", "out", "--only", only).status == 0
    assert {method for method, _ in cells(here / "out")} == found


def test_only_may_be_given_several_times(mfr, tiny, here):
    """The last of several was taken alone, without a word."""
    assert mfr("run", tiny, "--out", "out", "--only", "kplus-array", "--only", "ab-array", "--dry-run").status == 0
    assert mfr("run", tiny, "--out", "out", "--only", "floor", "--only", "ab-array").status == 0
    assert {method for method, _ in cells(here / "out")} == {"floor", "ab-array"}


def test_one_cell_is_called_one_cell(mfr, tiny, here):
    assert "\n1 cell: 1 ok" in mfr("run", tiny, "--out", "out", "--only", "floor").out


def test_set_changes_the_config(mfr, tiny, here):
    assert mfr("run", tiny, "--out", "out", "--set", "k=3", "--set", "scene.size=[20,10]").status == 0
    found = cells(here / "out")
    assert set(found) == {("floor", None), ("ab-array", None), ("kplus-array", 3)}
    assert {tuple(cell["scene"]["size"]) for cell in found.values()} == {(20, 10)}


def test_what_changed_the_config_is_in_the_manifest(mfr, tiny, here):
    """The page tells by it how to measure the same again."""
    assert mfr("run", tiny, "--out", "out", "--set", "k=3", "--only", "floor").status == 0
    assert json.loads((here / "out" / "manifest.json").read_text())["settings"] == ["--set", "k=3", "--only", "floor"]


def test_a_profile_is_laid_over(mfr, tiny, here):
    tiny.write_text(TINY + "profiles:\n  less: {sweep.k: [5]}\n")
    assert mfr("run", tiny, "--out", "out", "--profile", "less", "--only", "kplus-array").status == 0
    assert set(cells(here / "out")) == {("floor", None), ("kplus-array", 5)}


def test_without_out_results_go_by_device_and_name(mfr, tiny, here, device):
    assert mfr("run", tiny, "--only", "floor").status == 0
    assert (here / "results" / device.info["slug"] / "tiny" / "results.csv").is_file()


def test_several_configs_have_a_folder_each(mfr, tiny, here):
    (here / "other.yaml").write_text(TINY.replace("name: tiny", "name: other"))
    ended = mfr("run", tiny, "other.yaml", "--out", "out", "--only", "ab-array")
    assert ended.status == 0
    assert sorted(path.name for path in (here / "out").iterdir()) == ["other", "tiny"]
    assert ended.out.count("2 cells: 2 ok") == 2


def test_a_folder_of_configs_is_several(mfr, tiny, here):
    (here / "configs").mkdir()
    for name in ("a", "b"):
        (here / "configs" / f"{name}.yaml").write_text(TINY.replace("name: tiny", f"name: {name}"))
    assert mfr("run", "configs", "--out", "out", "--only", "floor").status == 0
    assert sorted(path.name for path in (here / "out").iterdir()) == ["a", "b"]


def test_only_does_not_change_which_folder_a_config_has(mfr, tiny, here):
    other = TINY.replace("name: tiny", "name: other").replace("[ab-array, kplus-array]", "[kplus-heap]")
    (here / "other.yaml").write_text(other)
    assert mfr("run", tiny, "other.yaml", "--out", "out", "--only", "kplus-heap").status == 0
    assert [path.name for path in (here / "out").iterdir()] == ["other"]


def test_a_config_given_twice_runs_once(mfr, tiny):
    ended = mfr("run", tiny, f"./{tiny.name}", "--out", "out", "--only", "floor")
    assert ended.out.count("1 cell: 1 ok") == 1


def test_configs_of_one_name_would_share_a_folder(mfr, tiny, here):
    (here / "same.yaml").write_text(TINY)
    ended = mfr("run", tiny, "same.yaml", "--out", "out")
    assert ended.status == 2
    assert ended.complaint == f"same.yaml: name: 'tiny' is also the name in {tiny}; allowed: a name of its own"


# --- the plan alone ------------------------------------------------------------------------------


def test_a_dry_run_prints_the_plan_and_writes_nothing(mfr, tiny, here):
    ended = mfr("run", tiny, "--dry-run", "--out", "out")
    assert ended.status == 0
    assert not (here / "out").exists()
    assert f"{CELLS} cells -> out" in ended.out
    assert ended.out.count("  measure\n") == CELLS
    assert ended.out.endswith(f"{CELLS} to measure, 0 not\n")


def test_a_dry_run_says_what_fits_the_time_budget(mfr, tiny, monkeypatch):
    ended = mfr("run", tiny, "--dry-run", "--out", "out", "--time-budget", "10h")
    assert ended.out.endswith("all of it should fit the time budget of 10 h 00 min\n")
    monkeypatch.setattr("mfr_bench.plan.time_left.TimeLeft.within", lambda self, seconds: list(self.cells)[:1])
    ended = mfr("run", tiny, "--dry-run", "--out", "out", "--time-budget", "20m")
    assert ended.status == 0
    assert ended.out.splitlines()[-2] == f"  1 to measure, {CELLS - 1} not, {CELLS - 1} for lack of time"
    assert " ".join(ended.out.split()).endswith(
        f"in the time budget of 20 min 00 s there should be time for 1 of {CELLS} cells; the same command, repeated, "
        "measures the others")
    assert ended.out.count("left out: the time budget ends before it, by the forecast") == CELLS - 1


def test_a_dry_run_says_what_is_skipped_and_why(mfr, tiny):
    ended = mfr("run", tiny, "--dry-run", "--set", "measure.memory_budget_mb=0.02")
    assert "over_budget: needs 0.0381 MiB, the budget is 0.02 MiB" in ended.out
    assert ended.out.endswith("2 to measure, 2 not\n")


def test_a_dry_run_says_what_is_kept(mfr, tiny, measured):
    mfr("run", tiny, "--out", "out")
    ended = mfr("run", tiny, "--out", "out", "--dry-run", "--set", "sweep.k=[4,5]")
    assert ended.out.count("kept: already measured") == 3
    assert ended.out.endswith("1 to measure, 3 not\n")


# --- cells that end otherwise --------------------------------------------------------------------


def test_a_wrong_image_is_a_row_and_exit_3(mfr, tiny, here, plant):
    plant("scene/primitive.glsl", "packUnorm4x8(in_rgba)", "packUnorm4x8(in_rgba.brga)")
    ended = mfr("run", tiny, "--out", "out")
    assert ended.status == 3
    found = cells(here / "out")["ab-array", None]
    assert found["status"] == "wrong"
    assert found["reason"].startswith("max_abs_error ")
    assert found["values"]["wrong_pixels"] > 0
    assert found["values"]["time_ms"] > 0  # measured, but never shown as a time
    assert f"{CELLS} cells: 1 ok, {CELLS - 1} wrong" in ended.out
    assert mfr("run", tiny, "--out", "out").status == 3  # kept, and still wrong


def test_a_shader_that_does_not_compile_is_a_row_and_exit_1(mfr, tiny, here, plant):
    plant("methods/array/store.frag", "void main() {", "void main() {\n    undeclared = 1;")
    ended = mfr("run", tiny, "--out", "out")
    assert ended.status == 1
    found = cells(here / "out")
    assert {key: cell["status"] for key, cell in found.items()} == {
        ("floor", None): "ok", ("ab-array", None): "crashed", ("kplus-array", 2): "ok", ("kplus-array", 4): "ok"}
    reason = found["ab-array", None]["reason"]
    assert "methods/array/store.frag:" in reason
    assert "undeclared" in reason
    assert "method ab-array, pass store" in reason
    assert "REJECTS=0" in reason
    assert "\n" not in reason
    assert f"AB_Array: crashed, {reason}" in ended.err


def test_what_the_device_lacks_is_a_result(mfr, tiny, here, device, monkeypatch):
    from dataclasses import replace

    monkeypatch.setattr(device, "limits", replace(device.limits, features=frozenset()))
    tiny.write_text(TINY.replace("[ab-array, kplus-array]", "[ab-array, {id: kplus-array, sync: interlock}]"))
    ended = mfr("run", tiny, "--out", "out")
    assert ended.status == 0
    found = cells(here / "out")["kplus-array", 4]
    assert (found["status"], found["reason"]) == ("unsupported", "needs fragment_shader_interlock")
    assert "time_ms" not in found["values"]
    assert "4 cells: 2 ok, 2 unsupported" in ended.out


def test_what_the_budget_forbids_is_a_result(mfr, tiny, here):
    ended = mfr("run", tiny, "--out", "out", "--set", "measure.memory_budget_mb=0.001")
    assert ended.status == 0
    found = {row["method"]: row for row in rows(here / "out" / "results.csv")}
    assert found["ab-array"]["status"] == "over_budget"
    assert found["ab-array"]["time_ms"] == ""
    assert found["ab-array"]["memory_model_bytes"] != ""
    assert found["floor"]["status"] == "ok"


def test_an_empty_scene_is_measured(mfr, tiny, here):
    assert mfr("run", tiny, "--out", "out", "--set", "scene.depth_complexity=0").status == 0
    assert {cell["status"] for cell in cells(here / "out").values()} == {"ok"}


def test_an_animated_scene_is_measured(mfr, tiny, here):
    assert mfr("run", tiny, "--out", "out", "--set", "scene.animate=true", "--set",
               "scene.fragment_probability=0.5").status == 0
    assert {cell["status"] for cell in cells(here / "out").values()} == {"ok"}


# --- places that cannot be written ---------------------------------------------------------------


def test_an_out_below_a_file_is_one_line(mfr, tiny):
    ended = mfr("run", tiny, "--out", "tiny.yaml/out")
    assert ended.status == 1
    assert ended.complaint.startswith("tiny.yaml/out/manifest.json: cannot be written: Not a directory; ")


def test_an_out_that_is_a_file_is_one_line(mfr, tiny):
    ended = mfr("run", tiny, "--out", "tiny.yaml")
    assert ended.status == 2
    assert "'tiny.yaml' is a file" in ended.complaint


def test_figures_that_cannot_be_written_cost_neither_cells_nor_tables(mfr, tiny, here):
    tiny.write_text(TINY + FIGURE)
    (here / "out").mkdir()
    (here / "out" / "figures").write_text("in the way")
    ended = mfr("run", tiny, "--out", "out")
    assert ended.status == 1
    assert "out/figures/tiny.png: cannot be written" in ended.err.splitlines()[-1]
    assert "Time, ms" in ended.out
    assert len(cells(here / "out")) == CELLS


def test_the_module_runs_as_the_command_does(tiny):
    ended = apart("run", tiny, "--out", "out", "--only", "floor")
    assert (ended.status, "1 cell: 1 ok" in ended.out) == (0, True)


def test_a_dry_run_predicts_the_time_by_what_was_measured_and_says_so(mfr, tiny, measured):
    before = mfr("run", tiny, "--out", "new", "--dry-run").out
    assert "  predicted: about " in before and f"{CELLS} by calibration alone" in before
    after = mfr("run", tiny, "--out", "out", "--dry-run", "--force").out
    assert f"{CELLS} measured here" in after
    assert "predicted" not in mfr("run", tiny, "--out", "out", "--dry-run").out  # nothing is left to measure
    (tiny.parent / "other.yaml").write_text(TINY.replace("name: tiny", "name: other"))
    both = mfr("run", tiny, tiny.parent / "other.yaml", "--out", "both", "--dry-run").out.splitlines()
    assert both[-1].startswith(f"{CELLS} cells to measure in all: about ")  # both need the same


def test_a_quiet_run_prints_results_alone(mfr, tiny):
    ended = mfr("run", tiny, "--out", "out", "--quiet")
    assert ended.status == 0
    assert ended.err == ""
    assert f"{CELLS} cells: {CELLS} ok" in ended.out and "device busy" not in ended.out


# --- entries that meet in one cell ---------------------------------------------------------------

MEETING = """name: meeting
scene: {size: [16, 16], depth_complexity: 6}
measure: {min_samples: 2, max_samples: 2, time_limit_s: 5}
"""
FIXED_K = ("methods: [kplus-array, {id: kplus-array, label: reference, k: 2}]\nsweep: {k: [1, 2, 4]}\n",
           [("Blending floor", ""), ("K+B-Array", "1"), ("K+B-Array", "2"), ("K+B-Array", "4"), ("reference", "")])
ALL_NAMED = ("methods:\n- {id: kplus-array, label: first}\n- {id: kplus-array, label: second, k: 2}\n"  # noqa: ISC004
             "- {id: kplus-array, label: third, k: 1}\nsweep: {k: [1, 2]}\n",
             [("Blending floor", ""), ("first", "1"), ("first", "2"), ("second", ""), ("third", "")])
TWO_NAMES = ("methods: [{id: ab-array, label: x}, {id: ab-array, label: y}]\n",
             [("Blending floor", ""), ("x", ""), ("y", "")])


@pytest.mark.parametrize(("methods", "expected"), [FIXED_K, ALL_NAMED, TWO_NAMES], ids=["fixed", "named", "two"])
def test_a_cell_has_a_row_for_every_label_and_point_that_it_serves(mfr, here, methods, expected):
    """It is measured once; run, dry run, results.csv and tables count and name the same rows."""
    (here / "meeting.yaml").write_text(MEETING + methods)
    planned = mfr("run", "meeting.yaml", "--out", "out", "--dry-run").out
    assert f"{len(expected)} cells -> out" in planned
    ended = mfr("run", "meeting.yaml", "--out", "out")
    assert f"{len(expected)} cells: {len(expected)} ok" in ended.out
    found = rows(here / "out" / "results.csv")
    assert sorted((r["label"], str(json.loads(r["point"]).get("k", ""))) for r in found) == expected
    measured_once = {r["key"] for r in found}
    assert len(measured_once) == planned.count("  measure") == len(list((here / "out" / "cells").iterdir()))
    table = (here / "out" / "tables" / "results.md").read_text()
    assert all(label in table for label, _ in expected)
    again = mfr("run", "meeting.yaml", "--out", "out")
    assert f"{len(expected)} kept from before" in again.out
    assert mfr("run", "meeting.yaml", "--out", "out", "--dry-run").out.count("kept: already measured") == len(expected)


def test_figures_of_many_configs_are_drawn_side_by_side_and_are_the_same(mfr, here):
    """Each is told of with its own, and `plot` draws them again to the byte."""
    (here / "many").mkdir()
    names = [f"many{number}" for number in range(MANY)]
    for number, name in enumerate(names):
        text = TINY.replace("size: [32, 24]", f"size: [8, {8 + number}]").replace("tiny", name) + FIGURE
        (here / "many" / f"{name}.yaml").write_text(text)
    ended = mfr("run", here / "many", "--out", "out", "--only", "kplus-array")
    assert ended.status == 0
    drawn = {name: (here / "out" / name / "figures" / f"{name}.png") for name in names}
    assert [line.split()[-1] for line in ended.out.splitlines() if line.startswith("figures ")] == [
        str(path.relative_to(here)) for path in drawn.values()]
    before = {name: path.read_bytes() for name, path in drawn.items()}
    assert mfr("plot", "out").status == 0
    assert {name: path.read_bytes() for name, path in drawn.items()} == before
