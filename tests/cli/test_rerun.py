"""`run` again: what is kept, copied, measured anew, and tried no more."""

import json
import os
import shutil

import pytest

from mfr_bench.store import ResultFolder

from .conftest import CELLS, TINY, cells, written

pytestmark = pytest.mark.usefixtures("on_device")


def test_a_rerun_keeps_every_cell(mfr, tiny, measured):
    before, manifest = written(measured), json.loads((measured / "manifest.json").read_text())
    ended = mfr("run", tiny, "--out", "out")
    assert ended.status == 0
    assert written(measured) == before
    assert ended.err == ""
    assert f"{CELLS} cells: {CELLS} ok; {CELLS} kept from before" in ended.out
    assert json.loads((measured / "manifest.json").read_text()) == manifest


def test_force_measures_again(mfr, tiny, measured):
    before = written(measured)
    ended = mfr("run", tiny, "--out", "out", "--force")
    assert ended.status == 0
    assert all(when > before[name] for name, when in written(measured).items())
    assert "kept from before" not in ended.out


def test_a_rerun_measures_what_is_missing(mfr, tiny, measured):
    before = written(measured)
    lost = next(iter(before))
    (measured / "cells" / lost).unlink()
    ended = mfr("run", tiny, "--out", "out")
    assert f"{CELLS - 1} kept" in ended.out
    assert len(ended.err.splitlines()) == 1
    after = written(measured)
    assert after.keys() == before.keys()
    assert {name for name in after if after[name] != before[name]} == {lost}


def test_a_rerun_measures_a_damaged_cell_again_and_names_it(mfr, tiny, measured):
    key = cells(measured)["ab-array", None]["key"]
    (measured / "cells" / f"{key}.json").write_text('{"schema": 1, "key"')
    ended = mfr("run", tiny, "--out", "out")
    assert ended.status == 0
    assert f"{CELLS} cells: {CELLS} ok; {CELLS - 1} kept" in ended.out
    assert (measured / "cells" / f"{key}.json.damaged").is_file()
    assert cells(measured)["ab-array", None]["status"] == "ok"


def test_a_changed_shader_is_measured_again_and_nothing_else(mfr, tiny, measured, plant):
    plant("methods/array/store.frag", "void main", "const uint unused = 7u;\nvoid main")
    ended = mfr("run", tiny, "--out", "out")
    assert [line.partition("  ")[2].partition(":")[0] for line in ended.err.splitlines()] == ["AB_Array"]
    assert f"{CELLS - 1} kept" in ended.out


def test_folders_merge_by_copying_cells(mfr, tiny, measured, here):
    mfr("run", tiny, "--out", "other", "--set", "k=8")
    shutil.copytree(here / "other" / "cells", measured / "cells", dirs_exist_ok=True)
    ended = mfr("run", tiny, "--out", "out", "--set", "k=8")
    assert ended.err == ""
    assert "3 cells: 3 ok; 3 kept" in ended.out


# --- cells that several results share ------------------------------------------------------------

OTHER = TINY.replace("name: tiny", "name: other").replace(
    "[ab-array, kplus-array]", "[{id: ab-array, label: Mine}, kplus-array, kplus-heap]").replace("[2, 4]", "[4, 5]")


def test_configs_share_cells_and_each_has_them_in_its_own_place(mfr, tiny, here):
    (here / "other.yaml").write_text(OTHER)
    planned = mfr("run", tiny, "other.yaml", "--out", "out", "--dry-run").out
    assert planned.count("  shared with tiny\n") == 3
    assert "  3 to measure, 3 not\n" in planned
    ended = mfr("run", tiny, "other.yaml", "--out", "out")
    assert ended.status == 0
    assert len(ended.err.splitlines()) == 7  # the floor, ab-array, kplus-array at three k, kplus-heap at two
    assert ended.err.splitlines()[-1].startswith("2 configs 7/7")
    first, second = cells(here / "out" / "tiny"), cells(here / "out" / "other")
    assert (len(first), len(second)) == (CELLS, 6)
    assert first["ab-array", None]["samples_ms"] == second["ab-array", None]["samples_ms"]
    assert (first["ab-array", None]["label"], second["ab-array", None]["label"]) == ("AB_Array", "Mine")
    assert (first["ab-array", None]["experiment"], second["ab-array", None]["experiment"]) == ("tiny", "other")
    assert first["kplus-array", 4]["key"] == second["kplus-array", 4]["key"]
    assert "4 cells: 4 ok\n" in ended.out and "6 cells: 6 ok\n" in ended.out


def test_cells_of_the_results_beside_are_copied(mfr, tiny, here):
    (here / "other.yaml").write_text(OTHER)
    assert mfr("run", tiny).status == 0
    planned = mfr("run", "other.yaml", "--dry-run").out
    assert planned.count("  copied from results/") == 3
    assert planned.endswith("3 to measure, 3 not\n")
    ended = mfr("run", "other.yaml")
    assert len(ended.err.splitlines()) == 3
    assert "6 cells: 6 ok; 3 copied from other results" in ended.out
    again = mfr("run", "other.yaml")
    assert "6 kept from before" in again.out and "copied" not in again.out


def test_a_folder_of_its_own_has_nothing_beside_it(mfr, tiny, here):
    assert mfr("run", tiny, "--out", "a").status == 0
    assert len(mfr("run", tiny, "--out", "b").err.splitlines()) == CELLS


def test_another_label_is_no_other_measurement(mfr, tiny, here, measured):
    tiny.write_text(TINY.replace("[ab-array,", "[{id: ab-array, label: Renamed},"))
    ended = mfr("run", tiny, "--out", "out")
    assert f"{CELLS} kept from before" in ended.out
    assert cells(here / "out")["ab-array", None]["label"] == "Renamed"
    assert "Renamed" in ended.out


def test_a_folder_takes_one_run_at_a_time(mfr, tiny, measured):
    with ResultFolder(measured).lock():
        ended = mfr("run", tiny, "--out", "out", "--force")
        assert ended.status == 1
        assert ended.complaint == (f"out: process {os.getpid()} measures into this folder; wait for its end, or choose "
                                   "another folder")
        assert mfr("table", "out").status == 0
    assert mfr("run", tiny, "--out", "out").status == 0


# --- cells that failed, and predicted timeouts ---------------------------------------------------


def changed(folder, method, **change):
    """The cell of a method, as if it had ended otherwise."""
    key = next(cell["key"] for (m, _), cell in cells(folder).items() if m == method)
    path = folder / "cells" / f"{key}.json"
    path.write_text(json.dumps(json.loads(path.read_text()) | change))


@pytest.mark.parametrize("status", ["crashed", "timeout", "out_of_memory"])
def test_what_failed_is_tried_again_and_kept_where_that_is_asked_for(mfr, tiny, measured, status):
    changed(measured, "ab-array", status=status, reason="planted", values={})
    kept = mfr("run", tiny, "--out", "out", "--keep-failed")
    assert (kept.status, kept.err) == (1, "")
    assert mfr("run", tiny, "--out", "out", "--dry-run").out.endswith(f"1 to measure, {CELLS - 1} not\n")
    assert mfr("run", tiny, "--out", "out", "--dry-run", "--keep-failed").out.endswith(f"0 to measure, {CELLS} not\n")
    again = mfr("run", tiny, "--out", "out")
    assert (again.status, len(again.err.splitlines())) == (0, 1)
    assert cells(measured)["ab-array", None]["status"] == "ok"


def test_a_result_is_not_tried_again(mfr, tiny, measured):
    changed(measured, "ab-array", status="overflow", reason="planted", values={})
    ended = mfr("run", tiny, "--out", "out")
    assert (ended.status, ended.err) == (0, "")
    assert f"{CELLS} cells: 3 ok, 1 overflow; {CELLS} kept" in ended.out


def test_a_method_that_took_too_long_is_not_tried_on_more_work(mfr, tiny, measured):
    found = cells(measured)["ab-array", None]
    changed(measured, "ab-array", warmup_ms=[], samples_ms=[700.0],
            values=found["values"] | dict.fromkeys(("time_ms_low", "time_ms", "time_ms_high"), 700.0))
    wide = ("run", tiny, "--out", "out", "--set", "scene.size=[64,24]")
    assert "n = 6 took 0.7 s a frame, where time_limit_s allows 0.5 s" not in mfr(*wide, "--dry-run").out
    swept = ("run", tiny, "--out", "out", "--set", "sweep.scene.size=[[32,24],[64,24]]")
    assert mfr(*swept, "--dry-run").out.count("timeout: AB_Array at 32 x 24 pixels, n = 6 took 0.7 s a frame") == 1
    ended = mfr(*swept)
    assert ended.status == 1
    assert "timeout, AB_Array at 32 x 24 pixels, n = 6 took 0.7 s a frame" in ended.err
    assert "8 cells: 7 ok, 1 timeout; 4 kept" in ended.out
    again = mfr(*swept)
    assert (again.status, again.err) == (1, "")
    assert "8 kept from before" in again.out
    assert mfr(*swept, "--try-hopeless").status == 0
