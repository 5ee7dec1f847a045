"""Merging: one set from many folders, whatever their order; nothing is written of what contradicts itself."""

from __future__ import annotations

import itertools
import json
import shutil

import numpy as np
import pytest

from mfr_bench.errors import UsageError
from mfr_bench.merge import merged_sets, write_set
from mfr_bench.report.data import load
from mfr_bench.report.tables.pages import _sections
from mfr_bench.store import ResultFolder
from mfr_bench.store.record import cell_key

from ..store.test_store import cell

DEVICE = {"slug": "card-a", "renderer": "Card A", "version": "4.6"}


def record(method, device=DEVICE, **parts):
    made = cell(method=method, **({"device": dict(device)} | parts))
    return made | {"key": cell_key(made, "wall")}


def samples(median_ms, seed=0, count=41):
    return list(median_ms * (1 + np.random.default_rng(seed).uniform(-0.01, 0.01, count)))


def measured_by(uuid, median_ms, **parts):
    taken = samples(median_ms, seed=uuid)
    return record("ab-array", device=DEVICE | {"uuid": f"uuid-{uuid}"}, samples_ms=taken,
                  values={"time_ms": sorted(taken)[20], "samples": len(taken), "sessions": 1}, **parts)


def folder(path, *cells, name="planted", device=DEVICE, started="2026-01-01", **manifest):
    made = ResultFolder(path)
    for each in cells:
        made.write_cell(each)
    made.write_manifest({"name": name, "device": dict(device), "timer": "wall", "started": started,
                         "cells": [each["key"] for each in cells]} | manifest)
    return made


def merge(into, *folders):
    sets, left_out = merged_sets(folders, into)
    return [write_set(each) for each in sets], left_out


def content(path):
    return {str(file.relative_to(path)): file.read_bytes() for file in sorted(path.rglob("*")) if file.is_file()}


@pytest.fixture
def three(tmp_path):
    a, b, c = record("ab-array"), record("ab-ll"), record("kplus-array")
    return (folder(tmp_path / "n1", a, b), folder(tmp_path / "n2", b, c, started="2026-01-02"),
            folder(tmp_path / "n3", c, started="2026-01-03"))


def test_every_cell_stands_once_byte_for_byte(tmp_path, three):
    written, left_out = merge(tmp_path / "all", *three)
    assert [(w.cells, w.new) for w in written] == [(3, 3)] and left_out == []
    sources = {n: c for each in three for n, c in content(each.cells_path).items()}
    assert content(tmp_path / "all" / "cells") == sources
    merged = ResultFolder(tmp_path / "all")
    assert len(merged.manifest()["merged"]) == 3 and len(merged.manifest()["cells"]) == 3


def test_order_steps_and_repetition_change_nothing(tmp_path, three):
    results = []
    for number, order in enumerate(itertools.permutations(three)):
        at = tmp_path / f"all{number}"
        merge(at, *order)
        results.append(content(at))
        steps = tmp_path / f"steps{number}"
        for each in (*order, order[0]):
            merge(steps, each)
        results.append(content(steps))
    assert all(result == results[0] for result in results)


def test_packed_folders_make_a_packed_set(tmp_path, three):
    for each in three:
        each.pack()
    merge(tmp_path / "all", *three)
    merged = ResultFolder(tmp_path / "all")
    assert merged.pack_path.is_file() and not merged.cells_path.exists() and len(merged.cells()) == 3
    before = content(merged.path)
    merge(tmp_path / "all", *three)
    assert content(merged.path) == before


def test_other_experiments_and_devices_go_to_folders_of_their_own(tmp_path):
    other = DEVICE | {"slug": "card-b", "renderer": "Card B"}
    merge(tmp_path / "all", folder(tmp_path / "n1", record("ab-array")),
          folder(tmp_path / "n2", record("ab-array", device=other), device=other),
          folder(tmp_path / "n3", record("ab-array"), name="second"))
    assert sorted(str(p.parent.relative_to(tmp_path / "all")) for p in (tmp_path / "all").rglob("manifest.json")) == [
        "card-a/planted", "card-a/second", "card-b/planted"]


def test_configs_of_one_name_that_differ_keep_all_their_cells(tmp_path):
    merge(tmp_path / "all",
          folder(tmp_path / "n1", record("ab-array"), sweep={"k": [1]}, methods=[{"id": "ab-array", "label": "x"}]),
          folder(tmp_path / "n2", record("ab-ll"), sweep={"k": [2]}, methods=[{"id": "ab-ll", "label": "y"}]))
    from mfr_bench.report import data

    result = data.load(ResultFolder(tmp_path / "all"))
    assert {p.cell["method"] for p in result.points} == {"ab-array", "ab-ll"}


def test_cells_of_shares_stand_in_the_order_of_the_whole_plan(tmp_path):
    a, b, c, d = (record(f"m{i}") for i in range(4))
    shares = (folder(tmp_path / "n1", a, d, places=[0, 3]),
              folder(tmp_path / "n2", b, c, places=[1, 2], started="2027"))
    for order in itertools.permutations((*shares, shares[0])):
        at = tmp_path / "-".join(each.path.name for each in order)
        for each in order:
            merge(at, each)
        found = ResultFolder(at)
        assert [each["key"] for each in found.cells()] == [each["key"] for each in (a, b, c, d)]
        assert found.manifest()["places"] == [0, 1, 2, 3]


@pytest.mark.parametrize("other", [{"places": [0]}, {"places": []}, {"places": [1], "sweep": {"k": [1]}}])
def test_cells_of_another_plan_stand_behind(tmp_path, other):
    a, b = record("ab-array"), record("ab-ll")
    merge(tmp_path / "all", folder(tmp_path / "n1", a, places=[0], started="2027"), folder(tmp_path / "n2", b, **other))
    manifest = ResultFolder(tmp_path / "all").manifest()
    assert manifest["cells"] == [b["key"], a["key"]] and manifest["places"] == []


def refused(into, *folders):
    with pytest.raises(UsageError) as error:
        merge(into, *folders)
    assert not into.exists()
    return "\n".join(error.value.lines)


def test_one_key_with_two_contents_is_refused(tmp_path):
    one, other = record("ab-array"), record("ab-array", values={"max_abs_error": 0.5}, status="wrong")
    said = refused(tmp_path / "all", folder(tmp_path / "n1", one), folder(tmp_path / "n2", other))
    assert f"cell {one['key']} differs" in said and "values.max_abs_error, status" in said


def test_times_of_one_device_measured_twice_are_refused(tmp_path):
    said = refused(tmp_path / "all", folder(tmp_path / "n1", record("ab-array")),
                   folder(tmp_path / "n2", record("ab-array", samples_ms=[9.0, 9.1], values={"time_ms": 9.0})))
    assert "nothing tells the devices apart" in said


def test_a_record_under_the_key_of_another_is_refused(tmp_path):
    altered = record("ab-array") | {"params": {"k": 9}}
    assert "is not what its key names" in refused(tmp_path / "all", folder(tmp_path / "n1", altered))


def test_a_record_of_another_device_than_its_folder_is_refused(tmp_path):
    said = refused(tmp_path / "all", folder(tmp_path / "n1", record("ab-array"), device=DEVICE | {"slug": "card-b"}))
    assert "was measured on card-a, its folder on card-b" in said


def test_a_damaged_manifest_is_the_reason_that_is_told(tmp_path):
    made = folder(tmp_path / "n1", record("ab-array"))
    (made.path / "manifest.json").write_text("{")
    assert "the manifest of its folder, or that cannot be read" in refused(tmp_path / "all", made)


def test_a_damaged_record_costs_itself_and_its_folder_stays_as_it_was(tmp_path, three):
    victim = next(three[0].cells_path.iterdir())
    victim.write_bytes(victim.read_bytes()[:100])
    before = content(three[0].path)
    _, left_out = merge(tmp_path / "all", three[0])
    assert len(left_out) == 1 and "cannot be read" in left_out[0] and content(three[0].path) == before


def test_samples_of_equal_devices_add_up(tmp_path):
    folders = [folder(tmp_path / f"n{i}", measured_by(i, 2.0)) for i in (1, 2, 3)]
    for order in itertools.permutations(folders):
        at = tmp_path / "".join(each.path.name for each in order)
        for each in (*order, order[1]):
            merge(at, each)
        (found,) = ResultFolder(at).cells()
        assert found["values"]["samples"] == 123 == len(found["samples_ms"]) and found["values"]["sessions"] == 3
        assert found["values"]["time_ms_low"] <= found["values"]["time_ms"] <= found["values"]["time_ms_high"]
    assert len({json.dumps(content(tmp_path / "".join(o.path.name for o in order)), default=bytes.hex)
                for order in itertools.permutations(folders)}) == 1


def test_samples_of_devices_that_differ_are_kept_apart(tmp_path):
    folders = [folder(tmp_path / "n1", measured_by(1, 2.0)), folder(tmp_path / "n2", measured_by(2, 3.0))]
    sets, _ = merged_sets(folders, tmp_path / "all")
    assert "differ by more than 5 %" in write_set(sets[0]).said[0]
    merged = ResultFolder(tmp_path / "all")
    (found,) = merged.cells()
    (grid,) = [g for g in _sections(load(merged), passes=False) if g.title == "Equal devices"]
    assert [row[:3] for row in grid.rows] == [("uuid-1", "1", "1"), ("uuid-2", "1", "1")]
    ratios = sorted(float(row[3]) for row in grid.rows)
    assert ratios == pytest.approx([0.8, 1.2], abs=0.02)
    assert found["values"]["samples"] == 41 and len(merged.replicates()[found["key"]]) == 2


def test_values_that_differ_between_equal_devices_are_kept_apart(tmp_path):
    """A method whose image depends on the order of drawing keeps no merge of many other cells from going on."""
    made = []
    for i, error in ((1, 0.25), (2, 0.5), (3, 0.5)):
        one = measured_by(i, 2.0)
        one["values"]["max_abs_error"] = error
        made.append(folder(tmp_path / f"n{i}", one, record("ab-ll")))
    for order in itertools.permutations(made):
        at = tmp_path / "".join(each.path.name for each in order)
        said = [line for each in (*order, order[0]) for written in merge(at, each)[0] for line in written.said]
        assert any("differ in values.max_abs_error: the one with most samples stands" in line for line in said)
        found = ResultFolder(at)
        by_method = {each["method"]: each for each in found.cells()}
        assert len(by_method) == 2 and by_method["ab-array"]["values"]["samples"] == 41
        assert len(found.replicates()[by_method["ab-array"]["key"]]) == 3
    assert len({json.dumps(content(tmp_path / "".join(o.path.name for o in order)), default=bytes.hex)
                for order in itertools.permutations(made)}) == 1


def test_a_status_that_differs_between_equal_devices_is_refused(tmp_path):
    said = refused(tmp_path / "all", folder(tmp_path / "n1", measured_by(1, 2.0)),
                   folder(tmp_path / "n2", measured_by(2, 2.0, status="wrong")))
    assert "in status; allowed: one of them" in said


def test_a_manifest_cannot_name_a_place_outside(tmp_path):
    bad = folder(tmp_path / "n1", record("ab-array"), name="../up")
    good = folder(tmp_path / "n2", record("ab-ll"))
    assert "no name of a folder" in refused(tmp_path / "all", bad, good)


def test_a_set_takes_no_other_experiment(tmp_path, three):
    merge(tmp_path / "all", three[0])
    with pytest.raises(UsageError, match="is the set planted of card-a"):
        merge(tmp_path / "all", folder(tmp_path / "n9", record("ab-ll"), name="second"))


def test_a_merge_that_was_cut_off_goes_on(tmp_path, three):
    merge(tmp_path / "whole", *three)
    merge(tmp_path / "all", *three)
    (tmp_path / "all" / "manifest.json").unlink()
    shutil.rmtree(tmp_path / "all" / "cells")
    merge(tmp_path / "all", *three)
    assert content(tmp_path / "all") == content(tmp_path / "whole")


def test_two_merges_at_once_lose_nothing(tmp_path):
    """Both decide before either writes, as two processes do."""
    one, other = folder(tmp_path / "n1", record("ab-array")), folder(tmp_path / "n2", record("ab-ll"), started="2027")
    plans = [merged_sets([each], tmp_path / "all")[0][0] for each in (one, other)]
    for plan in plans:
        with plan.folder.lock():
            write_set(plan)
    manifest = ResultFolder(tmp_path / "all").manifest()
    assert len(manifest["merged"]) == 2 and len(manifest["cells"]) == 2
    assert len(ResultFolder(tmp_path / "all").cells()) == 2


def test_a_contradiction_that_comes_meanwhile_is_refused(tmp_path):
    one = folder(tmp_path / "n1", record("ab-array"))
    other = folder(tmp_path / "n2", record("ab-array", values={"max_abs_error": 0.5}), started="2027")
    plans = [merged_sets([each], tmp_path / "all")[0][0] for each in (one, other)]
    write_set(plans[0])
    before = content(tmp_path / "all")
    with pytest.raises(UsageError, match="nothing was merged into"):
        write_set(plans[1])
    assert content(tmp_path / "all") == before


def test_two_sets_are_never_written_into_one_folder(tmp_path):
    one, other = folder(tmp_path / "n1", record("ab-array")), folder(tmp_path / "n2", record("ab-ll"), name="other")
    plans = [merged_sets([each], tmp_path / "all")[0][0] for each in (one, other)]
    write_set(plans[0])
    with pytest.raises(UsageError, match="is the set planted of card-a, not other of card-a"):
        write_set(plans[1])
    assert ResultFolder(tmp_path / "all").manifest()["name"] == "planted"
