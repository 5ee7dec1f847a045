"""docs/fairness.md: what the tables of comparisons with independent implementations give."""

import csv
import subprocess
import sys
from pathlib import Path

import pytest

from mfr_bench.errors import StoreError
from mfr_bench.methods import catalog
from mfr_bench.report import peers

ROOT = Path(__file__).resolve().parents[2]
ROW = {"method": "ab-ll", "parameters": "", "implementation": "others", "commit": "0123456789ab", "measured": "frame",
       "device": "a device", "date": "2026-11-28", "width": "256", "height": "256", "density": "1.0", "n": "16",
       "k": "", "ours_ms": "12.0", "theirs_ms": "10.0", "ratio": "1.2", "ratio_low": "1.19", "ratio_high": "1.21"}


@pytest.fixture
def tables(tmp_path, monkeypatch):
    """Writes the three tables of a page and returns the folder."""
    monkeypatch.setattr(peers, "peers_dir", lambda: tmp_path)

    def write(name, *rows):
        with open(tmp_path / name, "w", newline="", encoding="utf-8") as file:
            writer = csv.DictWriter(file, peers.COLUMNS[name])
            writer.writeheader()
            writer.writerows(rows)

    for name in peers.COLUMNS:
        write(name)
    return write


def test_the_page_is_what_the_tables_give():
    shown = subprocess.run([sys.executable, "-m", "mfr_bench", "methods", "--fairness"], capture_output=True, text=True,
                           check=True).stdout
    assert (ROOT / "docs" / "fairness.md").read_text() == shown, (
        "docs/fairness.md is out of date: mfr-bench methods --fairness >docs/fairness.md")


def test_the_tables_speak_of_methods_and_parameters_that_there_are():
    for row in (*peers.table("measured.csv"), *peers.table("reasons.csv"), *peers.table("differences.csv")):
        method = catalog()[row["method"]]
        chosen = row.get("parameters") or row.get("choice") or ""
        for name, value in (text.split(": ") for text in chosen.split("; ") if text):
            assert value in method.param(name).choices, f"{method.id}: {name}: {value}"


def test_each_interval_holds_its_ratio():
    for row in peers.table("measured.csv"):
        assert float(row["ratio_low"]) <= float(row["ratio"]) <= float(row["ratio_high"]), row


def test_a_ratio_far_from_one_has_its_reason(tables):
    tables("measured.csv", ROW)
    with pytest.raises(StoreError, match=r"no reason for .*ab-ll"):
        peers.as_markdown()
    tables("reasons.csv", {"method": "ab-ll", "parameters": "", "implementation": "others", "reason": "It is so."})
    assert "- `ab-ll` beside others: It is so." in peers.as_markdown()


@pytest.mark.parametrize("ratio", ["0.85", "1.0", "1.15"])
def test_a_ratio_near_one_needs_none(tables, ratio):
    tables("measured.csv", ROW | {"ratio": ratio})
    assert f"| {ratio} [1.19, 1.21] |" in peers.as_markdown()


def test_a_table_with_other_columns_is_refused(tables, tmp_path):
    (tmp_path / "reasons.csv").write_text("method,why\n")
    with pytest.raises(StoreError, match=r"reasons.csv: columns .*expected"):
        peers.as_markdown()
