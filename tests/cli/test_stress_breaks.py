"""The script that compares where methods break under stress with what llvmpipe 22.3.6 did."""

import importlib.util
import sys
from pathlib import Path

import pytest

SCRIPT = Path(__file__).resolve().parent.parent.parent / "scripts" / "stress_breaks.py"
LEVELS = ("1", "2", "4", "8")


@pytest.fixture
def script(monkeypatch):
    spec = importlib.util.spec_from_file_location("stress_breaks", SCRIPT)
    module = importlib.util.module_from_spec(spec)
    monkeypatch.setitem(sys.modules, "stress_breaks", module)
    spec.loader.exec_module(module)
    return module


def at(script, level, state="image"):
    return script.Break("stress-layers", "KB-LL", "", level, state)


@pytest.mark.parametrize(("found", "recorded", "is_earlier"), [
    ("2", "4", True), ("4", "4", False), ("8", "4", False), ("", "4", False), ("8", "", True), ("", "", False),
    ("2", "gone", False),
])
def test_a_method_breaks_earlier_where_a_milder_level_breaks_it(script, found, recorded, is_earlier):
    assert script.earlier(at(script, found), LEVELS, at(script, recorded)) is is_earlier


@pytest.mark.parametrize(("found", "recorded", "status", "told"), [
    (("2", "lost"), ("4", "image"), 1,
     "stress-layers, KB-LL: breaks at 2: lost; in the record at 4: image\n1 of 1 break earlier; 0 have nothing to"),
    (("8", "image"), ("", "holds"), 1, "breaks at 8: image; in the record nowhere\n1 of 1"),
    (("8", "image"), ("8", "lost"), 0, "0 of 1 break earlier; 0 have"),
    (("2", "image"), ("", "refused"), 0, "0 of 0 break earlier; 1 have nothing to compare with"),
    (("2", "image"), None, 0, "0 of 0 break earlier; 1 have nothing to compare with"),
])
def test_it_tells_what_breaks_earlier(script, monkeypatch, capsys, found, recorded, status, told):
    monkeypatch.setattr(script, "breaks", lambda folder: [(at(script, *found), LEVELS)])
    known = [at(script, *recorded)] if recorded else []
    assert script.compare(Path(), {row.place: row for row in known}) == status
    assert told in capsys.readouterr().out


def test_what_it_records_of_a_run_breaks_no_earlier(script, monkeypatch, capsys, tmp_path, mfr, on_device):
    """`depth-gap` breaks 32-bit keys of 16 bits, and no list."""
    mfr("stress", "depth-gap", "slant", "--only", "kb-mdt32,ab-ll", "--profile", "smoke", "--out", tmp_path)
    monkeypatch.setattr(script, "RECORD", tmp_path / "stress" / "breaks.csv")
    monkeypatch.setattr(sys, "argv", ["stress_breaks", "record", str(tmp_path)])
    assert script.main() == 0
    states = {row.split(",")[1]: row.rsplit(",", 1)[1] for row in script.RECORD.read_text().splitlines()[1:]}
    assert (states["AB_LL"], states["KB-MDT_32 (16-bit keys)"]) == ("holds", "differs")
    monkeypatch.setattr(sys, "argv", ["stress_breaks", str(tmp_path)])
    assert script.main() == 0
    assert capsys.readouterr().out.startswith("0 of ")
