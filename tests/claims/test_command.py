"""`mfr-bench claims`: text, JSON, CSV and Markdown of planted results."""

from __future__ import annotations

import csv
import io
import json
import subprocess
import sys

import pytest
from click.testing import CliRunner

from mfr_bench.claims import CLAIMS
from mfr_bench.cli.main import cli

from . import planted


@pytest.fixture
def results(tmp_path):
    """Two claims borne out on a GPU, one of them contradicted on a second device."""
    planted.folder(tmp_path / "gpu" / "kplus2015-fig6", "kplus2015-fig6", planted.heap(True))
    planted.folder(tmp_path / "gpu" / "memory", "sbuffer2012-memory", planted.memory_2012(True))
    planted.folder(tmp_path / "cpu" / "memory", "sbuffer2012-memory", planted.memory_2012(False), planted.CPU)
    return tmp_path


def claims(*arguments, width=80):
    done = CliRunner().invoke(cli, ["claims", *map(str, arguments)], env={"COLUMNS": str(width)})
    assert done.exit_code == 0, done.output
    return done.output


@pytest.mark.parametrize("width", [40, 80, 120])
def test_text_fits_the_terminal_and_names_every_claim(results, width):
    text = claims(results, width=width)
    words = max(len(word) for word in text.split())
    assert max(map(len, text.splitlines())) <= max(width, words + 9)
    for claim in CLAIMS:
        assert f"{claim.id}: " in text


def test_text_says_source_paper_rule_measurement_and_verdict(results):
    text = claims(results / "gpu", width=120)
    part = next(p for p in text.split("\n\n") if p.startswith("sb-memory: "))
    assert part.splitlines()[0] == "sb-memory: holds"
    assert "source sbuffer_2012 §4" in part
    assert "156.0 MB (printed 159)" in part
    assert "54.5 MB (printed 51.7)" in part
    assert "rule   memory, ab-ll / ab-sb (counters 30): 1 to 1.5 (slightly; printed: 1.18 to 1.25)" in part
    assert "here   holds: ab-ll / ab-sb" in part
    assert "why    not measured: kplus2015-lsort" in text


def test_text_counts_the_verdicts_of_each_device(results):
    n = len(CLAIMS)
    counts = [line for line in claims(results, width=120).splitlines() if f", {n} claims: " in line]
    assert counts == [f"llvmpipe, {n} claims: holds 0, does not hold 1, not testable here {n - 1}",
                      f"nvidia-h200, {n} claims: holds 2, does not hold 0, not testable here {n - 2}"]


def test_json_holds_every_comparison_with_its_interval(results):
    records = json.loads(claims(results / "gpu", "--json"))
    assert [r["id"] for r in records] == [c.id for c in CLAIMS]
    (heap,) = (r for r in records if r["id"] == "k-heap")
    assert (heap["device"], heap["verdict"], heap["reason"]) == ("nvidia-h200", "holds", None)
    comparison = heap["rules"][0]["comparisons"][0]
    assert comparison["low"] < comparison["value"] < comparison["high"]
    assert comparison["at"]["k"] == 32
    assert comparison["folder"].endswith("kplus2015-fig6")
    (unmeasured,) = (r for r in records if r["id"] == "k-lsort")
    assert [(r["outcome"], r["comparisons"]) for r in unmeasured["rules"]] == [(None, []), (None, [])]
    assert unmeasured["verdict"] == "not testable here"


def test_csv_has_a_row_for_each_claim_and_device(results):
    rows = list(csv.DictReader(io.StringIO(claims(results, "--csv"))))
    assert [(r["device"], r["id"]) for r in rows] == [(d, c.id) for d in ("llvmpipe", "nvidia-h200") for c in CLAIMS]
    found = {(r["device"], r["id"]): r["verdict"] for r in rows}
    assert found["nvidia-h200", "sb-memory"] == "holds"
    assert found["llvmpipe", "sb-memory"] == "does not hold"
    assert all(r["rule"] and r["source"] and r["paper"] and r["claim"] for r in rows)
    assert all(r["measured"] or r["reason"].startswith("not measured: ") for r in rows)


def test_markdown_has_a_table_and_a_section_for_each_claim(results):
    text = claims(results / "gpu", "--markdown")
    assert text.startswith("## Claims on nvidia-h200\n")
    assert text.count("\n### ") == len(CLAIMS)
    table = [line for line in text.splitlines() if line.startswith("|")]
    assert len(table) == 2 + len(CLAIMS)
    assert {line.replace("\\|", "").count("|") for line in table} == {5}


def test_one_form_at_a_time(results):
    done = CliRunner().invoke(cli, ["claims", str(results), "--json", "--csv"])
    assert "more than one of --json, --csv, --devices and --markdown" in str(done.exception)


def test_damaged_cells_are_named_and_the_rest_is_judged(results):
    cells = results / "gpu" / "memory" / "cells"
    cell = next(path for path in sorted(cells.iterdir()) if '"ab-array"' in path.read_text())
    cell.write_text("{")
    done = CliRunner().invoke(cli, ["claims", str(results / "gpu")], env={"COLUMNS": "120"})
    assert done.exit_code == 0
    assert "set aside" in done.stderr
    part = next(p for p in done.stdout.split("\n\n") if p.startswith("sb-memory: "))
    assert part.startswith("sb-memory: not testable here")
    assert "no cells of ab-array" in part


def test_a_folder_without_a_manifest_is_a_mistake(tmp_path):
    done = CliRunner().invoke(cli, ["claims", str(tmp_path)])
    assert "no results in or below it" in str(done.exception)


def test_no_gl_and_no_drawing_is_imported():
    code = ("import sys, mfr_bench.claims; "
            "print([m for m in ('moderngl', 'glcontext', 'matplotlib') if m in sys.modules])")
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_a_column_for_each_device_says_where_a_claim_holds(results):
    head, _, *rows = [line.strip("| ").split(" | ") for line in claims(results, "--devices").splitlines()]
    assert len(rows) == len(CLAIMS) and len(head) == 6
    found = {row[0]: dict(zip(head, row, strict=True)) for row in rows}
    memory = found["sb-memory"]
    assert (memory["holds"], memory["does not hold"]) == ("1", "1")
    assert sorted(memory[device] for device in head[4:]) == ["does not hold", "holds"]
