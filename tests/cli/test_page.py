"""`mfr-bench report` as a user gives it."""

from ..report import planted


def test_the_page_of_all_results_below_a_folder(mfr, here):
    planted.folder(here / "results" / "a", [planted.cell()])
    planted.folder(here / "results" / "b", [planted.cell()])
    ended = mfr("report", "results", "--out", "pages/all.html")
    assert (ended.status, ended.out, ended.err) == (0, "pages/all.html\n", "")
    assert (here / "pages" / "all.html").read_text().count('class="experiment"') == 2


def test_a_folder_without_results_is_named(mfr, here):
    ended = mfr("report", "nowhere")
    assert ended.status == 2 and "nowhere: no such folder" in ended.complaint
    assert not (here / "report.html").exists()


def test_what_cannot_be_used_is_told_and_left_out(mfr, here):
    folder = planted.folder(here / "a", [planted.cell(), planted.cell("kb-ps")])
    next(folder.cells_path.glob("*.json")).write_text("{")
    ended = mfr("report", "a")
    assert ended.status == 0 and ".damaged" in ended.err
    assert (here / "report.html").read_text().count("<tr data-m=") == 1
