"""Many devices: merging and comparing read each record a fixed number of times, however many devices there are."""

from __future__ import annotations

import importlib.util
import json
import sys
from collections import Counter
from pathlib import Path

import numpy as np
import pytest

from mfr_bench import parallel
from mfr_bench.cli.merge_command import merge_into
from mfr_bench.errors import UsageError
from mfr_bench.merge import copies, merged_sets, write_set
from mfr_bench.report.devices import as_text, read_experiments
from mfr_bench.store import ResultFolder, find_results
from mfr_bench.store.pack import Pack
from mfr_bench.store.record import cell_key, parsed

SCRIPT = Path(__file__).parents[2] / "scripts" / "simulate_devices.py"
CELLS = 2 * 4  # the floor and three methods, at two numbers of layers


@pytest.fixture
def simulate(monkeypatch):
    """The script's main; what it makes is read by this process alone."""
    spec = importlib.util.spec_from_file_location("simulate_devices", SCRIPT)
    module = importlib.util.module_from_spec(spec)
    monkeypatch.setitem(sys.modules, "simulate_devices", module)
    spec.loader.exec_module(module)
    monkeypatch.setattr(parallel, "usable_cores", lambda: 1)
    return lambda out, devices: module.main([str(out), "--devices", str(devices), "--values", "2", "--methods", "3"])


@pytest.fixture
def work(monkeypatch):
    """How many files of packs were read, and how many packs were opened."""
    counted: Counter[str] = Counter()
    reading, opening = Pack.read, Pack.__init__

    def read(self, name):
        counted["read"] += 1
        return reading(self, name)

    def opened(self, path):
        counted["opened"] += 1
        return opening(self, path)

    monkeypatch.setattr(Pack, "read", read)
    monkeypatch.setattr(Pack, "__init__", opened)
    return counted


def folders(out):
    return [ResultFolder(path) for path in find_results([out / "sent"])]


def test_work_per_cell_is_that_of_fewer_devices(tmp_path, simulate, work):
    spent = {}
    for devices in (2, 6):
        out = tmp_path / str(devices)
        simulate(out, devices)
        work.clear()
        sets, left_out = merged_sets(folders(out), out / "all")
        written = [write_set(each) for each in sets]
        (found,) = read_experiments([ResultFolder(path) for path in find_results([out / "all"])])
        assert [w.records for w in written] == [ResultFolder(each.folder.path).cells() for each in sets]
        assert left_out == [] and [w.new for w in written] == [CELLS] * devices == [CELLS] * len(found.devices)
        spent[devices] = {name: count / devices for name, count in work.items()}
    assert spent[2] == spent[6] and spent[2]["read"] <= 5 * CELLS


def test_a_record_is_checked_once(tmp_path, simulate, monkeypatch):
    """What was found sound is not checked again where it is written; what is other by then is."""
    simulate(tmp_path, 2)
    counted: Counter[str] = Counter()

    def check(cell, timer):
        counted["checked"] += 1
        return cell_key(cell, timer)

    monkeypatch.setattr(copies, "cell_key", check)
    sets, _ = merged_sets(folders(tmp_path), tmp_path / "all")
    write_set(sets[0])
    assert counted["checked"] == 2 * CELLS
    sets[1].sources[0].folder.write_manifest(sets[1].sources[0].manifest | {"timer": "wall"})
    with pytest.raises(UsageError, match="is not what its key names"):
        write_set(sets[1])
    assert counted["checked"] == 3 * CELLS


def test_members_that_records_share_are_parsed_once(tmp_path, simulate):
    simulate(tmp_path, 1)
    (folder,) = folders(tmp_path)
    cells = folder.cells()
    assert len({id(cell["scene"]) for cell in cells}) == 2 and len({id(cell["measure"]) for cell in cells}) == 1
    assert cells == [parsed(folder.content(f"{cell['key']}.json")) for cell in cells]


def test_devices_are_compared_without_their_records(tmp_path, simulate, work):
    """A merge leaves what a comparison needs; it counts only while the set is as it was."""
    simulate(tmp_path, 3)
    merge_into(folders(tmp_path), tmp_path / "all")
    sets = [ResultFolder(path) for path in find_results([tmp_path / "all"])]
    for whole_scenes in (False, True):
        work.clear()
        (kept,) = read_experiments(sets, whole_scenes)
        assert not work
        files = [(each.path / "comparison.json") for each in sets]
        contents = [file.read_bytes() for file in files]
        for file in files:
            file.unlink()
        (read,) = read_experiments(sets, whole_scenes)
        assert work["read"] == 3 * CELLS and as_text(kept, 120) == as_text(read, 120)
        assert np.array_equal(kept.numbers, read.numbers, equal_nan=True)
        assert [device.facts for device in kept.devices] == [device.facts for device in read.devices]
        for file, content in zip(files, contents, strict=True):
            file.write_bytes(content)


@pytest.mark.parametrize("spoil", ["cell", "manifest", "text", "shape"])
def test_what_a_merge_left_of_other_files_counts_no_longer(tmp_path, simulate, work, spoil):
    simulate(tmp_path, 1)
    merge_into(folders(tmp_path), tmp_path / "all")
    (folder,) = (ResultFolder(path) for path in find_results([tmp_path / "all"]))
    file = folder.path / "comparison.json"
    slower = next(cell for cell in folder.cells() if cell["method"] != "floor")
    if spoil == "cell":
        values = slower["values"] | {"time_ms": 9e3, "time_ms_low": 8e3, "time_ms_high": 1e4}
        folder.write_cell(slower | {"values": values})
    elif spoil == "manifest":
        folder.write_manifest(folder.manifest() | {"noise_floor_rel": 0.5})
    elif spoil == "text":
        file.write_bytes(file.read_bytes()[:-200])
    else:
        file.write_bytes(file.read_bytes().replace(b'"cells": [[0,', b'"cells": [[7,'))
    work.clear()
    (found,) = read_experiments([folder])
    assert work["read"] >= CELLS - 1
    assert (found.numbers == 9e3).any() == (spoil == "cell")
    assert (found.devices[0].noise == 0.5) == (spoil == "manifest")


def test_no_record_stays_in_memory_once_its_set_is_checked(tmp_path, simulate):
    simulate(tmp_path, 2)
    sets, _ = merged_sets(folders(tmp_path), tmp_path / "all")
    assert all(not source.folder._pack[1] for each in sets for source in each.sources)


def test_simulated_results_say_so_everywhere(tmp_path, simulate):
    simulate(tmp_path, 1)
    (folder,) = folders(tmp_path)
    manifest = folder.manifest()
    assert manifest["simulated"] is True and "no device drew" in manifest["title"]
    assert "Simulated" in manifest["device"]["renderer"] and {c["reason"] for c in folder.cells()} == {"simulated"}
    assert len(folder.cells()) == CELLS and json.loads((folder.path / "manifest.json").read_bytes())["schema"] == 1
