"""docs/conformance.md is what results say: the worst cell of each method, and what could not be run."""

import pytest

from mfr_bench.errors import StoreError
from mfr_bench.methods import catalog
from mfr_bench.report import conformance_page
from mfr_bench.report.data import load

from .planted import MEASURE, cell, folder

SHARES = {"hit_ratio": 0.2, "promised_ratio": 0.25, "lost_fragments": 3, "distinct_images": 7, "wrong_pixels": 41,
          "max_abs_error": 0.02}
SOUND = {"hit_ratio": 0.25, "promised_ratio": 0.25, "lost_fragments": 0, "distinct_images": 1}


@pytest.fixture
def page(tmp_path):
    """Results of two folders: a hazard in one cell of `kb`, an exact method, one that is not run."""
    repeated = MEASURE | {"repeat_images": 50}
    cells = [cell("kb", "KB", params={"k": 4}, point={"k": 4}, values=SOUND, measure=repeated),
             cell("kb", "KB", params={"k": 8}, point={"k": 8}, values=SHARES, measure=repeated),
             cell("kb", "KB", None, params={"k": 64}, point={"k": 64}, status="unsupported", reason="needs slots"),
             cell("ab-array", "AB_Array", values={**SOUND, "hit_ratio": 1.0, "promised_ratio": 1.0})]
    made = [folder(tmp_path / "one", cells), folder(tmp_path / "two", [cell("ab-array", "AB_Array", status="wrong",
                                                                            values={"max_abs_error": 0.5})])]
    return conformance_page(map(load, made), catalog())


def row(page, section, label):
    table = page.split(f"## {section}")[1].split("\n## ")[0]
    return next([f.strip() for f in line.strip("|").split("|")] for line in table.splitlines() if f"| {label} " in line)


def test_a_method_from_outside_is_to_be_named(tmp_path):
    made = folder(tmp_path / "one", [cell("my-array", "My array")])
    with pytest.raises(StoreError, match=r"no method 'my-array'.*name its folder in MFR_BENCH_METHODS"):
        conformance_page([load(made)], catalog())


def test_without_a_cell_the_page_says_so(tmp_path):
    page = conformance_page([load(folder(tmp_path / "one", []))], catalog())
    assert page.endswith("of 1 frame. A cell that the device cannot run is not counted as ok.\n\n"
                         "None of these results has a cell.\n")


def test_where_no_method_has_a_known_failure_the_page_says_so(tmp_path):
    page = conformance_page([load(folder(tmp_path / "one", [cell("ab-array", "AB_Array", values=SOUND)]))], catalog())
    assert page.split("## Methods with a known failure\n\n")[1].startswith("None.\n")


def test_a_row_is_the_worst_of_all_cells(page):
    assert row(page, "All methods", "KB") == ["KB", "`kb`", "approximate", "2", "1", "0", "0.020", "41", "0.8000", "3",
                                              "7"]
    assert row(page, "All methods", "AB_Array")[3:8] == ["1", "0", "1", "0.50", "0"]


def test_the_share_that_ran_everywhere_is_told(page):
    """KB has a cell that was not run, AB_Array a wrong image."""
    assert "0 of 2 methods and variants (0.0 %) ran in every cell without a wrong image." in page


def test_results_in_pieces_are_told_as_one_and_no_cell_twice(tmp_path):
    floor = cell("floor", "Blending floor")
    made = [folder(tmp_path / name, [floor, cell(method, label)])
            for name, method, label in (("one", "kb", "KB"), ("two", "ab-array", "AB_Array"))]
    page = conformance_page(map(load, made), catalog())
    assert page.count("`planted`, 3 cells") == page.count("`planted`, ") == 1
    assert row(page, "All methods", "Blending floor")[3] == "1"
    assert "2 of 2 methods and variants (100.0 %) ran in every cell without a wrong image." in page


def test_hazards_are_told_with_the_failure_that_is_known(page):
    found = row(page, "Methods with a known failure", "KB")
    assert found[2:] == [catalog()["kb"].failure, "1 of 2", "41", "0.8000", "3", "7"]
    assert "AB_Array" not in page.split("## Methods with a known failure")[1]


def test_what_was_not_run_has_its_reason(page):
    assert "- KB: 1 cell unsupported: needs slots" in page
    assert "distinct ones\nof 50 frames" in page
    assert "races between the fragments of a pixel do" in " ".join(page.split())


MESH = {"kind": "mesh", "files": ["a.obj"], "view": {"projection": "orthographic", "direction": "-z", "eye": None},
        "effect": "csg", "operation": "difference"}
EXACT = {"max_abs_error": 1e-7, "tied_pixels": 5, "tied_error": 2e-7, "covered_pixels": 200, "fragments": 900,
         "max_fragments": 9}


def test_meshes_stand_in_a_section_of_their_own(tmp_path):
    """The worst of the exact methods that agree; which others are wrong; no cell of it counts above."""
    cells = [cell("ab-array", "AB_Array", scene=MESH, values=EXACT),
             cell("kplus-array", "K+B-Array", scene=MESH, params={"k": 8}, values=EXACT | {"max_abs_error": 3e-7}),
             cell("peel-f2b", "F2B", scene=MESH, status="wrong", values=EXACT | {"max_abs_error": 0.7}),
             cell("kb-sr", "KB-SR", None, scene=MESH, status="unsupported", reason="needs flat primitives"),
             cell("mlab", "MLAB", scene=MESH, values={"max_abs_error": 0.3})]
    made = [folder(tmp_path / "meshes", cells), folder(tmp_path / "flat", [cell("ab-array", "AB_Array")])]
    page = conformance_page(map(load, made), catalog())
    assert row(page, "Triangles", "`a.obj`") == [
        "`a.obj`", "orthographic -z", "64×64", "csg, difference",
        "900", "9", "2.5 %", "2 of 3", "3e-07", "2e-07", "F2B"]
    assert row(page, "All methods", "AB_Array")[3] == "1" and "F2B" not in page.split("## Triangles")[0]
    assert "- KB-SR: 1 cell unsupported: needs flat primitives" in page.split("## Triangles")[1]


def test_views_and_ranges_of_depths_are_told(tmp_path):
    view = {"projection": "perspective", "direction": "-z", "eye": [1, 2.5, 3], "target": [0, 0, 0]}
    scene = {"kind": "mesh", "files": ["a.obj", "b.stl"], "view": view, "depth_range": "reversed"}
    page = conformance_page([load(folder(tmp_path / "one", [cell("ab-array", "AB_Array", scene=scene)]))], catalog())
    told = "| `a.obj`, `b.stl` | perspective from 1 2.5 3, reversed depths | 64×64 | transparency |"
    assert told in " ".join(page.split())
    assert "## All methods" not in page
