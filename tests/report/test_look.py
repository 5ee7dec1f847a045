"""Figures of a given width and text size in every format, tables for LaTeX, the manual page, the citation."""

import re
import struct
import subprocess
import sys
import zlib
from dataclasses import replace
from pathlib import Path

import pytest
import yaml

import mfr_bench
from mfr_bench.report import style, write_for_paper, write_scaled
from mfr_bench.report.latex import booktabs, escaped
from mfr_bench.report.look import STYLES
from mfr_bench.report.tables.paper import uncertain

from . import planted

ROOT = Path(mfr_bench.__file__).parents[1]
FIGURES = [{"kind": "stacked_passes", "x": "k", "y": "time_ms", "log": "y"},
           {"kind": "lines", "x": "k", "y": "time_ms", "log": "xy", "title": "100 % & more_of #1"}]
WIDTH_IN, FONT_PT, DPI = 5.0, 6.0, 100


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return planted.folder(tmp_path_factory.mktemp("look"), planted.sweep((4, 64)), FIGURES, {"k": [4, 64]})


@pytest.fixture(scope="module")
def written(folder):
    look = replace(STYLES["paper"], width_in=WIDTH_IN, font_pt=FONT_PT, dpi=DPI, formats=("png", "svg", "pdf", "pgf"))
    return {(path.stem, path.suffix): path for path in write_scaled(folder, look)}


@pytest.mark.parametrize("name", ["planted-1", "planted-2"])
def test_every_format_has_the_width(written, name):
    """Pixels, points of a viewer, points of a page, inches of TeX."""
    png = written[name, ".png"].read_bytes()
    assert struct.unpack(">I", png[16:20])[0] == pytest.approx(WIDTH_IN * DPI, abs=1)
    width, = re.findall(r'<svg [^>]*?width="([\d.]+)pt"', written[name, ".svg"].read_text())
    assert float(width) == pytest.approx(72 * WIDTH_IN, rel=1e-5)
    box = re.search(rb"/MediaBox \[ 0 0 ([\d.]+) ([\d.]+) \]", written[name, ".pdf"].read_bytes())
    assert float(box[1]) == pytest.approx(72 * WIDTH_IN, rel=1e-5)
    box_of_pgf = r"pgfpathrectangle\{\\pgfpointorigin\}\{\\pgfqpoint\{([\d.]+)in\}"
    shown = re.search(box_of_pgf, written[name, ".pgf"].read_text())
    assert float(shown[1]) == pytest.approx(WIDTH_IN, rel=1e-5)


def test_lines_of_a_page_reach_its_end(written):
    """Straight lines, which are stroked and not filled, go as far to the right as the layout has them."""
    content = written["planted-2", ".pdf"].read_bytes()
    streams = [zlib.decompress(found) for found in re.findall(rb"stream\n(.*?)\nendstream", content, re.DOTALL)
               if found[:1] == b"x"]
    ends = [float(x) for found in streams for x in re.findall(rb"[\d.]+ [\d.]+ m\n([\d.]+) [\d.]+ l\n+S", found)]
    assert 72 * WIDTH_IN < max(ends) < 72 * WIDTH_IN * 8 / FONT_PT  # in units that are scaled afterwards


def test_turned_texts_end_at_their_bars_in_every_font(written):
    """The names under bars end at the axis, and the axis's own name is centred, however wide TeX's font is."""
    turned = re.findall(r"\\pgftext\[[^]]*?,(\w*),(\w*),rotate=90[^]]*\].*\}(.+)\}\}%$",
                        written["planted-1", ".pgf"].read_text(), re.MULTILINE)
    places = {name: (along, across) for along, across, name in turned}
    assert places["time (ms)"][0] == ""
    below = {place for name, place in places.items() if "B-" in name}
    assert below == {("right", "")} and len(places) > len(planted.METHODS)


def test_text_has_the_size_that_is_asked_for(written):
    """Labels are laid out at 8 points, and all is scaled by what makes them FONT_PT."""
    text = written["planted-1", ".pgf"].read_text()
    scale, = map(float, re.findall(r"pgftransformscale\{([\d.]+)\}", text))
    sizes = {round(float(size) * scale, 2) for size in re.findall(r"\\fontsize\{([\d.]+)\}", text)}
    assert FONT_PT in sizes
    assert style.WIDTH_IN == 7.2


def test_pgf_is_what_tex_can_read(written):
    """Braces balance, special characters are escaped, no length is beyond TeX's."""
    for name in ("planted-1", "planted-2"):
        text = written[name, ".pgf"].read_text()
        bare = re.sub(r"\\[{}]", "", text)
        assert bare.count("{") == bare.count("}")
        assert max(abs(float(length)) for length in re.findall(r"(-?[\d.]+)in\}", text)) < 200
        assert len(text) < 2e6
    assert r"100 \% \& more\_of \#1" in written["planted-2", ".pgf"].read_text()


def test_files_are_the_same_each_time(folder, written):
    before = {path: path.read_bytes() for path in written.values()}
    look = replace(STYLES["paper"], width_in=WIDTH_IN, font_pt=FONT_PT, dpi=DPI, formats=("png", "svg", "pdf", "pgf"))
    write_scaled(folder, look)
    assert {path: path.read_bytes() for path in before} == before


def test_tables_for_latex_and_siunitx(folder, tmp_path):
    tex, csv = write_for_paper([folder], tmp_path / "out")
    assert [tex, csv] == [tmp_path / "out" / f"{folder.path.name}.{ending}" for ending in ("tex", "csv")]
    text, rows = tex.read_text(), csv.read_text().splitlines()
    assert text.count(r"\toprule") == text.count(r"\bottomrule") == 1
    measured = sum(cell["values"].get("time_ms") is not None for cell in folder.cells())
    assert len(rows) == measured + 1
    assert rows[0] == "method,k,time / ms,time / floor,memory / MiB,largest error"
    assert all(re.fullmatch(r"\d+\.\d+(\(\d+\))?", row.split(",")[2]) for row in rows[1:])
    assert r"KB-MDT\textsubscript{3}\textsubscript{2}" in text and r"K\textsuperscript{+}B-Array" in text


def test_tables_for_latex_of_several_results_leave_these_as_they_are(tmp_path):
    for device in ("here", "there"):
        planted.folder(tmp_path / "results" / device / "one", planted.sweep((4,)), [], {"k": [4]})
    before = sorted(tmp_path.rglob("*"))
    done = command("table", tmp_path / "results", "--latex", tmp_path / "out")
    assert done.returncode == 0 and done.stderr == ""
    names = [f"{device}-one.{ending}" for device in ("here", "there") for ending in ("tex", "csv")]
    assert [Path(line).name for line in done.stdout.splitlines()] == names
    assert sorted(set(tmp_path.rglob("*")) - set(before)) == sorted([tmp_path / "out", *(tmp_path / "out" / name
                                                                                       for name in names)])


@pytest.mark.parametrize(("interval", "said"), [
    ((4.94, 5.06, 5.18), "5.06(12)"), ((99.0, 100.0, 101.0), "100.0(10)"), ((0.5, 50.0, 99.5), "50(50)"),
    ((None, 5.0625, None), "5.06"), ((1.0, 1.0, 1.0), "1.00"), ((None, None, None), ""),
    ((0.0123, 0.0125, 0.0127), "0.01250(20)"),
])
def test_uncertainties_are_in_units_of_the_last_digit(interval, said):
    assert uncertain(*interval) == said


def test_a_table_formats_its_numbers_alike():
    text = booktabs("A & B", ["name", "t"], [["x_1", "10.5(12)"], ["y", "3.25(4)"], ["z", ""]])
    assert r"\centering\footnotesize" in text and r"\begin{tabular}{lS[table-format=2.2(2)]}" in text
    assert r"\caption{A \& B}" in text and r"x\_1 & 10.5(12) \\" in text
    assert escaped(r"a\b{c}") == r"a\textbackslash{}b\{c\}"


def command(*arguments):
    return subprocess.run([sys.executable, "-m", "mfr_bench", *map(str, arguments)], capture_output=True, text=True,
                          check=False, cwd=ROOT)


@pytest.mark.parametrize(("options", "said"), [
    (["--width", "89mm"], "allowed: --style paper or --style slides with them"),
    (["--style", "paper", "--width", "wide"], "'wide' is no width; allowed: 1in to 100in"),
    (["--style", "paper", "--width", "89mm", "--font-size", "12"], "--font-size up to 6.1, or a larger --width"),
    (["--style", "papr"], "nearest: 'paper'"), (["--style", "paper", "--format", "svgz"], "nearest: 'svg'"),
])
def test_a_look_that_cannot_be_had_is_one_line(folder, options, said):
    done = command("plot", folder.path, *options)
    line, = done.stderr.splitlines()
    assert done.returncode == 2 and said in line


def test_the_manual_page_has_every_command_and_option():
    from mfr_bench.cli.main import cli

    page = command("--man").stdout
    assert page.startswith(".TH MFR-BENCH 1 ")
    for name, each in cli.commands.items():
        assert f"\n.SS mfr-bench {name} " in page.replace("\\-", "-")
        for param in each.params:
            for option in (o for o in param.opts if o.startswith("--")):
                assert option.replace("-", "\\-") in page
    assert not re.search(r"^[.'](?!TH|SH|SS|TP|PP|nf|fi|B\b)", page, re.MULTILINE)


def test_the_citation_has_the_version_and_a_date():
    cited = yaml.safe_load((ROOT / "CITATION.cff").read_text())
    assert cited["version"] == mfr_bench.__version__
    assert re.fullmatch(r"\d{4}-\d{2}-\d{2}", str(cited["date-released"]))
