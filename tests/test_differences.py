"""scripts/differences.py: which frames it compares, and what becomes of the tables."""

import importlib.util
import sys
from pathlib import Path
from types import SimpleNamespace

import pytest

from mfr_bench.methods import catalog
from mfr_bench.report import peers

ROOT = Path(__file__).resolve().parents[1]
DEVICE = SimpleNamespace(features=frozenset())


@pytest.fixture(scope="module")
def script():
    spec = importlib.util.spec_from_file_location("differences", ROOT / "scripts" / "differences.py")
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return module


def test_every_choice_is_compared_with_the_method_as_it_is(script):
    pairs = list(script.differences(DEVICE, catalog()))
    rows = [row for row in peers.table("differences.csv") if row["choice"]]
    assert {pair.key for pair in pairs} == {(row["method"], row["choice"]) for row in rows}
    for pair in pairs:
        here, source = pair.ways
        differing = {name for name in here.params if here.params[name] != source.params[name]}
        assert differing == set(peers.chosen(pair.told["choice"])), pair.key
        assert pair.layers in (16, 64)


def test_rankings_are_compared_with_the_k_that_they_name(script):
    found = {(pair.told["faster"], pair.told["slower"], pair.layers, pair.k): pair.ways
             for pair in script.rankings(DEVICE, catalog())}
    slower, faster = found["kplus-array-r", "ab-sb", 64, 64]
    assert (slower.method.id, faster.method.id, faster.params["k"]) == ("ab-sb", "kplus-array-r", 64)
    assert {(at, k) for method, other, at, k in found if (method, other) == ("kplus-heap", "kplus-array")} == {(64, 32)}


def test_emulated_atomics_take_the_place_of_those_that_the_device_lacks(script):
    assert script.fitted_to(DEVICE, catalog()["kb-mdt64"], {}).params["atomic64"] == "emulated"
    assert script.fitted_to(SimpleNamespace(features={"shader_atomic_int64"}), catalog()["kb-mdt64"],
                            {}).params["atomic64"] == "native"


def test_a_row_takes_the_place_of_that_of_the_same_frames(script, monkeypatch, tmp_path):
    monkeypatch.setattr(script, "peers_dir", lambda: tmp_path)
    monkeypatch.setattr(peers, "peers_dir", lambda: tmp_path)
    row = dict.fromkeys(peers.COLUMNS["worth.csv"], "1") | {"method": "b", "choice": "x: y", "n": "64", "k": ""}
    (tmp_path / "worth.csv").write_text(",".join(row) + "\n")
    wanted = [("b", "x: y"), ("a", "x: y")]
    for each in (row, row | {"method": "a", "n": "16"}, row | {"n": "16"}, row | {"ratio": "2"}):
        script.written("worth.csv", [each], wanted)
    assert [(r["method"], r["n"], r["ratio"]) for r in peers.table("worth.csv")] == [
        ("b", "16", "1"), ("b", "64", "2"), ("a", "16", "1")]
    script.written("worth.csv", [], wanted[1:])
    assert [r["method"] for r in peers.table("worth.csv")] == ["a"]
