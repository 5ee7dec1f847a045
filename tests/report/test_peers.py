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
        for name, value in peers.chosen(row.get("parameters") or row.get("choice") or "").items():
            assert method.param(name).parse(value) == value, f"{method.id}: {name}: {value}"


def test_each_interval_holds_its_ratio():
    for row in (*peers.table("measured.csv"), *peers.table("worth.csv")):
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


def test_the_page_opens_with_what_the_rows_of_each_implementation_give_on_each_device(tables):
    others = {**ROW, "implementation": "a-b/c_d and e"}
    tables("measured.csv", others | {"ratio": "0.9"}, ROW | {"ratio": "1.1"}, others | {"ratio": "1.111"},
           others | {"ratio": "1.0", "device": "llvmpipe-b"})
    page = peers.as_markdown().splitlines()
    at = page.index("| [a-b/c_d and e](#a-bc_d-and-e) | a device | 2 | 1.000 | 0.900 | 1.111 | 1 |")
    assert page[at + 1] == "| [a-b/c_d and e](#a-bc_d-and-e) | b | 1 | 1.000 | 1.000 | 1.000 | 0 |"
    assert page[at + 2] == "| [others](#others) | a device | 1 | 1.100 | 1.100 | 1.100 | 0 |"
    assert at < page.index("### a-b/c_d and e") < page.index("### others")


def test_a_table_with_other_columns_is_refused(tables, tmp_path):
    (tmp_path / "reasons.csv").write_text("method,why\n")
    with pytest.raises(StoreError, match=r"reasons.csv: columns .*expected"):
        peers.as_markdown()


def test_every_method_says_in_what_it_differs_from_its_source():
    assert {row["method"] for row in peers.table("differences.csv")} == set(catalog())


def test_every_time_is_of_a_difference():
    told = {(row["method"], row["choice"]) for row in peers.table("differences.csv")}
    assert {(row["method"], row["choice"]) for row in peers.table("worth.csv")} <= told


DIFFERENCE = {"method": "ab-ll", "source": "so", "here": "otherwise", "choice": "sort: hybrid", "note": ""}
TIMES = {"n": "16", "k": "", "first_ms": "9.0", "second_ms": "10.0", "ratio": "0.9", "ratio_low": "0.89",
         "ratio_high": "0.91", "device": peers.USUAL, "date": "2026-11-29"}
WORTH = {"method": "ab-ll", "choice": "sort: hybrid", **TIMES}


def test_a_difference_has_a_time_or_a_note(tables):
    tables("differences.csv", DIFFERENCE)
    with pytest.raises(StoreError, match=r"ab-ll, so: neither measured nor with a note"):
        peers.as_markdown()
    tables("worth.csv", WORTH, {**WORTH, "k": "8"}, {**WORTH, "device": "llvmpipe-b"})
    assert ("| 0.9 [0.89, 0.91] (n = 16); 0.9 [0.89, 0.91] (n = 16, k = 8); 0.9 [0.89, 0.91] (n = 16, b) |"
            in peers.as_markdown())
    tables("differences.csv", {**DIFFERENCE, "choice": "", "note": "No choice gives it."})
    assert "| otherwise |  | No choice gives it. |" in peers.as_markdown()


WAYS = {"source": "a paper", "faster": "ab-sb", "faster_with": "", "slower": "ab-ll", "slower_with": "sort: hybrid"}


def test_a_ranking_is_measured_and_another_order_has_its_reason(tables):
    tables("rankings.csv", {**WAYS, "n": "16", "k": "", "reason": ""})
    with pytest.raises(StoreError, match="ab-sb before ab-ll, a paper: not measured"):
        peers.as_markdown()
    tables("ranked.csv", {**WAYS, **TIMES})
    with pytest.raises(StoreError, match="another order, and no reason"):
        peers.as_markdown()
    tables("ranked.csv", {**WAYS, **TIMES, "ratio": "1.1"})
    assert "| a paper | `ab-sb` | `ab-ll` (sort: hybrid) | 1.1 [0.89, 0.91] (n = 16) |  |" in peers.as_markdown()


@pytest.mark.parametrize("name", ["rankings.csv", "ranked.csv"])
def test_rankings_are_of_methods_and_parameters_that_there_are(name):
    for row in peers.table(name):
        for each in ("faster", "slower"):
            catalog()[row[each]].variant(peers.chosen(row[f"{each}_with"]))
