"""Many devices: merging and comparing read each record a fixed number of times, however many devices there are."""

from __future__ import annotations

import importlib.util
import json
import sys
from collections import Counter
from pathlib import Path

import pytest

from mfr_bench import parallel
from mfr_bench.merge import merged_sets, write_set
from mfr_bench.report.devices import read_experiments
from mfr_bench.store import ResultFolder, find_results
from mfr_bench.store.pack import Pack

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
