"""The page of all that is committed to results/: small enough to be sent, whole, and silent in a browser."""

from pathlib import Path

from mfr_bench.page import write_page
from mfr_bench.page.write import MOST_BYTES
from mfr_bench.report import data
from mfr_bench.report.figures import figure_paths
from mfr_bench.store import ResultFolder, find_results

from .conftest import CHROMIUM, DRIVER

ROOT = Path(__file__).resolve().parents[2]
ROOM = 0.75  # of the most bytes: sets that are measured anew or beside these keep below it
MADE = {"smoke"}  # by `make bench`, and not committed


def test_the_page_of_all_committed_sets_can_be_sent_and_opened(request, tmp_path):
    """It takes no more bytes than a page should, and has every set and figure; in one test, since it takes seconds."""
    folders, path = [folder for found in find_results([str(ROOT / "results")])
                     if (folder := ResultFolder(found)).path.name not in MADE], tmp_path / "all.html"
    assert write_page(folders, path, draw=False) is None
    text = path.read_text()
    figures = [figure for folder in folders for figure in figure_paths(data.load(folder))]
    assert len(text.encode()) <= ROOM * MOST_BYTES and MOST_BYTES == 5 * 2**20
    assert text.count('class="experiment"') == len(folders) > 40
    assert all(figure.is_file() for figure in figures) and text.count("<img ") >= len(figures) > 80
    if CHROMIUM and DRIVER:
        opened = request.getfixturevalue("browser")
        opened.get(path.as_uri())
        assert opened.execute_script("return document.readyState") == "complete"
        assert opened.execute_script("return document.querySelectorAll('details.explore:not([hidden])').length") > 40
        assert opened.get_log("browser") == []


def test_a_page_that_is_a_little_too_large_is_not_told_as_one_that_is_not(monkeypatch, tmp_path):
    monkeypatch.setattr("mfr_bench.page.write.page_text", lambda *_: "x" * (MOST_BYTES + 1))
    assert write_page([], tmp_path / "all.html").startswith(f"{tmp_path}/all.html: 5.01 MiB; a page of up to 5 MiB ")
