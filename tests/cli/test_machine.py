"""The output that other programs read: --json, --junit and --summary of run, table, compare."""

import json
import xml.etree.ElementTree as ET

from mfr_bench.report.machine import Case, junit

from .conftest import CELLS


def test_run_and_table_print_the_same_rows_and_nothing_else(here, tiny, mfr, on_device):
    ran = mfr("run", tiny, "--out", "out", "--json", "--junit", "run.xml", "--summary", "summary.md")
    assert ran.status == 0, ran.err
    result, = json.loads(ran.out)
    assert result["name"] == "tiny" and result["unmeasured"] == 0
    assert len(result["cells"]) == CELLS
    assert all(cell["status"] == "ok" and cell["time_ms"] > 0 for cell in result["cells"])
    assert json.loads(mfr("table", "out", "--json").out) == [result]
    suites = ET.parse(here / "run.xml").getroot()
    assert (suites.get("tests"), suites.get("failures"), suites.get("errors")) == (str(CELLS), "0", "0")
    assert {case.get("classname") for case in suites.iter("testcase")} == {"tiny"}
    assert (here / "summary.md").read_text().startswith("# tiny: Tiny\n")


def test_a_wrong_image_is_a_failure_in_the_report(here, tiny, mfr, on_device, plant):
    plant("methods/array/store.frag", "slot * pixels + p", "slot + p")
    ran = mfr("run", tiny, "--out", "out", "--junit", "run.xml")
    assert ran.status == 3
    cases = ET.parse(here / "run.xml").getroot().iter("testcase")
    failed, = (case for case in cases if case.find("failure") is not None)
    assert failed.get("name") == "AB_Array"
    assert "wrong" in failed.find("failure").get("message").lower()


def test_compare_appends_to_a_summary_and_tells_missing_cells(here, tiny, mfr, on_device):
    mfr("run", tiny, "--out", "a")
    mfr("run", tiny, "--out", "b", "--only", "ab-array")
    (here / "summary.md").write_text("before\n")
    mfr("compare", "a", "b", "--junit", "compare.xml", "--summary", "summary.md")
    told = (here / "summary.md").read_text()
    assert told.startswith("before\n# a -> b\n") and "2 MISSING" in told
    errors = [case for case in ET.parse(here / "compare.xml").getroot().iter("testcase")
              if case.find("error") is not None]
    assert len(errors) == 2
    assert {case.find("error").get("message") for case in errors} == {"only in a"}


def test_a_run_writes_its_page_and_says_where(here, tiny, mfr, on_device):
    ran = mfr("run", tiny, "--out", "out", "--report", "pages/all.html")
    assert ran.out.splitlines()[-1] == "page    pages/all.html"
    assert (here / "pages" / "all.html").read_text().startswith("<!DOCTYPE html>")


def test_a_summary_that_cannot_be_written_is_one_line(here, tiny, mfr, on_device):
    mfr("run", tiny, "--out", "a")
    ended = mfr("table", "a", "--json", "--summary", "no/such/summary.md")
    assert ended.status == 1
    assert ended.err.splitlines() == ["no/such/summary.md: cannot be written: No such file or directory"]


def test_xml_counts_and_escapes():
    text = junit([Case("a", "x < y & z"), Case("a", "b", "skipped", "not \"here\""), Case("b", "c", "error", "gone")])
    root = ET.fromstring(text)
    assert [suite.get("tests") for suite in root] == ["2", "1"]
    assert [case.get("name") for case in root.iter("testcase")] == ["x < y & z", "b", "c"]
    assert root.find(".//skipped").get("message") == 'not "here"'
