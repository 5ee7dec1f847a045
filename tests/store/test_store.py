"""The store: whole cell files or none, damage named and set aside, derived rows."""

from __future__ import annotations

import csv
import errno
import json
import math
import os
import re
import shutil

import numpy as np
import pytest

from mfr_bench import store
from mfr_bench.errors import StoreError, UsageError
from mfr_bench.store.columns import VALUES
from mfr_bench.store.record import Shared, parsed

SCENE = {"kind": "quads", "size": [8, 6], "pixel_density": 0.5, "depth_complexity": 4, "layout": "block",
         "order": "random", "fragment_probability": 1.0, "seed": 7}


def cell(name="a", method="kplus-array", scene=SCENE, values=None, **parts):
    found = {"timer": "wall", "time_ms": 2.0} | (values or {})
    found = {"time_ms_low": found["time_ms"], "time_ms_high": found["time_ms"]} | found
    return {"key": store.key({"name": name}), "experiment": "planted", "method": method, "label": method, "params": {},
            "scene": scene, "measure": {}, "point": {}, "status": "ok", "reason": None, "values": found,
            "warmup_ms": [2.2], "samples_ms": [2.0, 2.1], "passes": {}, "buffers": {}, "glsl_hash": "ab",
            "device": {"slug": "llvmpipe"}} | parts


@pytest.fixture
def folder(tmp_path):
    return store.ResultFolder(tmp_path / "device" / "planted")


def path_of(folder, record):
    return folder.cells_path / f"{record['key']}.json"


def rows_of(path):
    with open(path, newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


# --- cells ---------------------------------------------------------------------------------------


def test_a_key_depends_on_values_and_not_on_their_order():
    assert store.key({"a": 1, "b": [1, 2]}) == store.key({"b": [1, 2], "a": 1})
    assert store.key({"a": 1}) != store.key({"a": 2})
    assert store.KEY_FILE.fullmatch(f"{store.key({})}.json")


def test_a_cell_reads_back_as_written(folder):
    record = cell(passes={"store": [1.0, 2.0], "clear": [0.5]})
    folder.write_cell(record)
    found = folder.cell(record["key"])
    assert found == {"schema": store.SCHEMA} | record
    assert list(found["passes"]) == ["store", "clear"]  # the frame's order, not the alphabet's
    assert folder.has(record["key"]) and not folder.has(store.key({"name": "b"}))
    assert folder.damaged == []


def test_numpy_values_infinity_and_nan_are_stored(folder):
    record = cell(values={"psnr_db": math.inf, "rmse": float("nan"), "fragments": np.int64(5)},
                  samples_ms=np.array([1.0, 2.0]))
    folder.write_cell(record)
    values = folder.cell(record["key"])["values"]
    assert (values["psnr_db"], values["rmse"], values["fragments"]) == (math.inf, None, 5)


@pytest.mark.parametrize("wrong", [
    {"values": {"tme_ms": 1.0}}, {"status": "fine"}, {"values": {"fragments": 1.5}}, {"values": {"noisy": 1}},
    {"scene": {}}, {"samples_ms": ["1"]}, {"passes": {"store": 1.0}}, {"key": "short"}, {"label": None}])
def test_a_record_that_no_reader_would_take_is_not_written(folder, wrong):
    with pytest.raises(ValueError):
        folder.write_cell(cell() | wrong)
    assert not folder.cells_path.exists()


def test_cells_come_in_the_manifests_order_then_the_others(folder):
    records = [cell(name) for name in "abcd"]
    for record in records:
        folder.write_cell(record)
    keys = [r["key"] for r in records]
    folder.write_manifest({"cells": [keys[2], keys[0]]})
    assert [c["key"] for c in folder.cells()] == [keys[2], keys[0], *sorted([keys[1], keys[3]])]


def test_two_folders_merge_by_copying_cell_files(folder, tmp_path):
    other = store.ResultFolder(tmp_path / "other")
    folder.write_cell(cell("a"))
    other.write_cell(cell("b"))
    shutil.copytree(other.cells_path, folder.cells_path, dirs_exist_ok=True)
    assert len(folder.cells()) == 2


def test_writing_a_cell_again_replaces_it(folder):
    folder.write_cell(cell("a"))
    folder.write_cell(cell("a", values={"time_ms": 3.0}))
    assert [c["values"]["time_ms"] for c in folder.cells()] == [3.0]


# --- damage --------------------------------------------------------------------------------------


@pytest.mark.parametrize("content", [b"", b"{", b"[]", b"null", b"\xff\xfe", b"[" * 100_000, b'{"schema": 1}'])
def test_a_damaged_cell_is_named_and_set_aside(folder, content):
    good, bad = cell("good"), cell("bad")
    folder.write_cell(good)
    path_of(folder, bad).write_bytes(content)
    assert [c["key"] for c in folder.cells()] == [good["key"]]
    assert len(folder.damaged) == 1 and str(path_of(folder, bad)) in folder.damaged[0]
    assert path_of(folder, bad).with_suffix(".json.damaged").exists()
    folder.write_cell(bad)
    assert folder.has(bad["key"]) and folder.damaged == []


def test_any_cut_off_file_counts_as_damaged(folder):
    record = cell()
    folder.write_cell(record)
    whole = path_of(folder, record).read_bytes()
    for length in range(0, len(whole) - 2, 7):
        path_of(folder, record).write_bytes(whole[:length])
        assert not folder.has(record["key"]), length


@pytest.mark.parametrize("change", [
    {"status": "great"}, {"values": {"time_ms": "fast"}}, {"samples_ms": [None]}, {"key": store.key({"name": "z"})},
    {"scene": {"size": [8]}}, {"params": None}, {"measure": {"min_samples": "10"}},
    {"values": {"time_ms_low": 1.0, "time_ms": 2.0, "time_ms_high": -0.0}}])
def test_a_cell_with_wrong_contents_is_set_aside(folder, change):
    record = cell()
    folder.write_cell(record)
    path_of(folder, record).write_text(json.dumps(folder.cell(record["key"]) | change))
    assert folder.cells() == []
    assert "set aside" in folder.damaged[0]


@pytest.mark.parametrize("schema", [0, 2, None])
def test_another_schema_is_named_and_left_in_place(folder, schema):
    record = cell()
    folder.write_cell(record)
    path_of(folder, record).write_text(json.dumps(folder.cell(record["key"]) | {"schema": schema}))
    assert folder.cells() == []
    assert f"schema {schema!r}" in folder.damaged[0] and path_of(folder, record).exists()


def test_foreign_files_are_named_and_left(folder):
    folder.write_cell(cell())
    (folder.cells_path / "notes.txt").write_text("mine")
    (folder.cells_path / f"{store.key({})}.json").mkdir()
    (folder.cells_path / ".half.json.1.part").write_text("{")
    assert len(folder.cells()) == 1 and len(folder.cells()) == 1
    assert len(folder.damaged) == 2 and (folder.cells_path / "notes.txt").exists()


@pytest.mark.parametrize("content", ["", "[1]", '{"schema": 9}', '{"schema": 1, "cells": 3}'])
def test_a_damaged_manifest_costs_the_order_only(folder, content):
    folder.write_cell(cell())
    (folder.path / "manifest.json").write_text(content)
    assert folder.manifest() == {} and len(folder.cells()) == 1
    assert "manifest.json" in folder.damaged[0]


def test_an_absent_folder_is_empty(folder):
    assert folder.cells() == [] and folder.manifest() == {} and folder.damaged == []


# --- durability ----------------------------------------------------------------------------------


def failing(number):
    def fail(*_args, **_kwargs):
        raise OSError(number, os.strerror(number))
    return fail


@pytest.mark.parametrize("call", ["fsync", "replace"])
def test_a_full_disk_is_one_line_and_keeps_the_earlier_cell(folder, monkeypatch, call):
    record = cell()
    folder.write_cell(record)
    before = path_of(folder, record).read_bytes()
    monkeypatch.setattr(os, call, failing(errno.ENOSPC))
    with pytest.raises(StoreError) as caught:
        folder.write_cell(record | {"reason": "new"})
    monkeypatch.undo()
    message = str(caught.value)
    assert str(path_of(folder, record)) in message and "free some space" in message and "\n" not in message
    assert path_of(folder, record).read_bytes() == before
    assert os.listdir(folder.cells_path) == [path_of(folder, record).name]


@pytest.mark.parametrize("call", ["fsync", "replace"])
def test_of_many_files_each_is_whole_or_as_it_was(folder, monkeypatch, call):
    folder.write_contents({f"{i:020x}.json": b"old" for i in range(3)})
    real, calls = getattr(os, call), []

    def third_fails(*arguments):
        calls.append(arguments)
        return failing(errno.ENOSPC)() if len(calls) == 3 else real(*arguments)

    monkeypatch.setattr(os, call, third_fails)
    with pytest.raises(StoreError, match="free some space"):
        folder.write_contents({f"{i:020x}.json": b"new" for i in range(40)})
    monkeypatch.undo()
    found = {path.name: path.read_bytes() for path in folder.cells_path.iterdir()}
    assert {f"{i:020x}.json" for i in range(3)} <= found.keys() and {*found.values()} <= {b"old", b"new"}
    assert all(re.fullmatch("[0-9a-f]{20}.json", name) for name in found)


def test_many_files_are_on_disk_before_their_folder_is_and_that_once(folder, monkeypatch):
    real, synced = os.fsync, []
    monkeypatch.setattr(os, "fsync", lambda handle: (synced.append(os.path.isdir(f"/proc/self/fd/{handle}")),
                                                     real(handle)))
    folder.write_contents({f"{i:020x}.json": b"" for i in range(40)})
    assert synced[-41:] == [False] * 40 + [True]


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="needs /dev/full")
def test_a_device_without_space_raises_a_store_error(tmp_path, monkeypatch):
    real_open = open
    monkeypatch.setattr("builtins.open", lambda path, mode="r", **rest: real_open("/dev/full", mode, **rest)
                        if str(path).endswith(".part") else real_open(path, mode, **rest))
    with pytest.raises(StoreError, match="No space left"):
        store.write_file(tmp_path / "x.csv", b"x" * 100_000)


def test_a_file_where_a_folder_should_be_raises_a_store_error(tmp_path):
    (tmp_path / "taken").write_text("")
    with pytest.raises(StoreError, match="cannot be written"):
        store.ResultFolder(tmp_path / "taken").write_cell(cell())


def test_an_interrupted_write_leaves_nothing_behind(folder, monkeypatch):
    folder.write_cell(cell("a"))
    monkeypatch.setattr(os, "fsync", lambda _: (_ for _ in ()).throw(KeyboardInterrupt))
    with pytest.raises(KeyboardInterrupt):
        folder.write_cell(cell("b"))
    assert len(os.listdir(folder.cells_path)) == 1


def test_file_and_folder_are_synced_before_and_after_the_rename(folder, monkeypatch):
    folder.write_cell(cell("a"))
    calls = []
    fsync, replace = os.fsync, os.replace
    monkeypatch.setattr(os, "fsync", lambda handle: calls.append("sync") or fsync(handle))
    monkeypatch.setattr(os, "replace", lambda *paths: calls.append("rename") or replace(*paths))
    folder.write_cell(cell("b"))
    assert calls == ["sync", "rename", "sync"]


# --- derived files -------------------------------------------------------------------------------


def test_results_csv_has_the_designs_columns_first():
    design = ("experiment method status reason width height pixel_density depth_complexity k fragment_probability "
              "order seed params fragments samples timer time_ms time_ms_low time_ms_high floor_ms memory_bytes "
              "memory_model_bytes max_abs_error rmse psnr_db flip hit_ratio wrong_pixels")
    assert " ".join(c.name for c in store.COLUMNS).startswith(design)
    assert len({c.name for c in store.COLUMNS}) == len(store.COLUMNS)


def test_a_row_per_cell_with_empty_fields_for_what_was_not_measured(folder):
    folder.write_cell(cell("a", params={"k": 8, "sync": "spin"}, values={"noisy": True, "psnr_db": math.inf}))
    skipped = cell("b", method="kb", status="unsupported", reason='needs "x", and y') | {"values": {}, "samples_ms": []}
    folder.write_cell(skipped)
    store.derive(folder)
    by_method = {row["method"]: row for row in rows_of(folder.path / "results.csv")}
    measured, empty = by_method["kplus-array"], by_method["kb"]
    assert (measured["width"], measured["height"], measured["k"]) == ("8", "6", "8")
    assert (measured["noisy"], measured["psnr_db"], measured["device"]) == ("true", "inf", "llvmpipe")
    assert json.loads(measured["params"]) == {"k": 8, "sync": "spin"}
    assert empty["reason"] == 'needs "x", and y'
    assert {empty[name] for name in VALUES} == {""} and empty["floor_ms"] == "" and empty["k"] == ""


def test_pandas_reads_the_columns_types(folder):
    pandas = pytest.importorskip("pandas")
    folder.write_cell(cell("a", values={"noisy": True, "psnr_db": math.inf, "fragments": 12}))
    store.derive(folder)
    frame = pandas.read_csv(folder.path / "results.csv")
    assert frame["noisy"].tolist() == [True] and frame["psnr_db"].tolist() == [math.inf]
    assert frame["fragments"].dtype.kind == "i"


def test_the_floor_is_joined_by_scene_device_and_timer(folder):
    other = SCENE | {"seed": 8}
    records = [cell("floor", method="floor", values={"time_ms": 1.0}), cell("same"), cell("scene", scene=other),
               cell("device", device={"slug": "h200"}), cell("timer", values={"timer": "gpu"})]
    rows = store.result_rows(records)
    assert [row["floor_ms"] for row in rows] == [1.0, 1.0, None, None, None]


def test_a_floor_without_a_time_gives_no_floor():
    floor = cell("floor", method="floor", status="crashed") | {"values": {"timer": "wall"}}
    assert [row["floor_ms"] for row in store.result_rows([floor, cell()])] == [None, None]


def test_passes_csv_has_medians_intervals_and_shares(folder):
    folder.write_cell(cell(passes={"clear": [1.0] * 6, "store": [2.0, 3.0, 4.0], "resolve": []}))
    store.derive(folder)
    rows = rows_of(folder.path / "passes.csv")
    assert [(r["pass"], r["order"], r["samples"], r["time_ms"], r["share"]) for r in rows] == [
        ("clear", "0", "6", "1.0", "0.25"), ("store", "1", "3", "3.0", "0.75")]
    assert (rows[0]["time_ms_low"], rows[1]["time_ms_low"]) == ("1.0", "")


def test_deriving_twice_gives_the_same_bytes(folder):
    folder.write_cell(cell(passes={"store": [1.0]}))
    store.derive(folder)
    before = (folder.path / "results.csv").read_bytes()
    store.derive(folder)
    assert (folder.path / "results.csv").read_bytes() == before


# --- finding -------------------------------------------------------------------------------------


def test_results_are_found_below_the_given_folders_once(tmp_path):
    for name in ("a", "b/c", "b/c/cells", "b/.hidden"):
        store.write_file(tmp_path / name / "manifest.json", b"{}")
    found = store.find_results([tmp_path / "b", tmp_path])
    assert found == [tmp_path / "b/c", tmp_path / "a"]


def test_a_path_without_results_is_a_usage_error_for_each(tmp_path):
    with pytest.raises(UsageError) as caught:
        store.find_results([tmp_path, tmp_path / "absent"])
    assert len(caught.value.lines) == 2 and "no such folder" in caught.value.lines[1]


SHARED_LINE = '"scene": {"size": [1, 2]}'


@pytest.mark.parametrize("written", [
    '{\n"a": 1,\n' + SHARED_LINE + "\n}\n",
    '{\n"a": [1,\n2],\n' + SHARED_LINE + "\n}\n",
    '{\n"a": {"b": 1,\n' + SHARED_LINE + ',\n"d": 2},\n"d": 3\n}\n',
    '{\n"a": {"b": 1,\n' + SHARED_LINE + ',\n"d": 2}, "d": 3\n}\n',
    '{\n"a": 1, "b": 2,\n' + SHARED_LINE + "\n}\n",
    "{\n" + SHARED_LINE + ',\n"scene": 2\n}\n',
    "{\n" + SHARED_LINE + " \n}\n",
    "{" + SHARED_LINE + "}",
    "{\n\n}\n",
    '[\n"a",\n"b"\n]\n',
])
def test_a_record_is_parsed_alike_line_by_line_and_as_a_whole(written):
    """Whatever the form of its text is, and whichever lines other records had."""
    shared = Shared()
    parsed(("{\n" + SHARED_LINE + "\n}\n").encode(), shared)
    for _ in range(2):
        assert parsed(written.encode(), shared) == parsed(written.encode())


@pytest.mark.parametrize("written", ["{\n" + SHARED_LINE + ',\n"a": NaN\n}\n', "{\n" + SHARED_LINE + ',\n"a": \n}\n',
                                     "{\n" + SHARED_LINE + ",\n}\n", '{\n"a": "\\ud800"\n}\n', "{\n"])
def test_a_record_that_is_no_json_is_refused_alike(written):
    said = []
    for shared in (None, Shared()):
        with pytest.raises(ValueError, match=r".") as error:
            parsed(written.encode(), shared)
        said.append(str(error.value))
    assert said[0] == said[1]
