"""One drawing gives both files: what stands in them, and where."""

from __future__ import annotations

import io
import re
import subprocess
import sys
import xml.etree.ElementTree as ET

import numpy as np
import pytest

from mfr_bench.report import figures, style
from mfr_bench.report.figures import sheet
from mfr_bench.report.figures.glyphs import EM, face_of

from .drawing import STACKED, built, two_methods


def font(weight="normal"):
    from matplotlib.font_manager import FontProperties

    sheet._register_fonts()
    return FontProperties(family=style.FONT, weight=weight, size=EM)


def blank(width_in=2.0, height_in=1.0):
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    with sheet.styled():
        figure = Figure(figsize=(width_in, height_in))
        FigureCanvasAgg(figure)
    return figure


def pixels_of(content):
    from PIL import Image

    return np.asarray(Image.open(io.BytesIO(content["png"])))


def test_a_figure_is_drawn_once(tmp_path, monkeypatch):
    from matplotlib.figure import Figure

    drawn, draw = [], Figure.draw
    monkeypatch.setattr(Figure, "draw", lambda self, renderer: drawn.append(renderer) or draw(self, renderer))
    assert set(figures.render(built(tmp_path, two_methods(), STACKED))) == {"png", "svg"} and len(drawn) == 1


def test_both_files_have_the_figures_size_and_bear_the_mark(tmp_path):
    from PIL import Image

    figure = built(tmp_path, two_methods(), STACKED)
    width, height = figure.get_size_inches()
    content = figures.render(figure, "a mark")
    image = Image.open(io.BytesIO(content["png"]))
    assert image.size == (int(width * style.DPI), int(height * style.DPI)) and image.info["Source"] == "a mark"
    assert image.info["dpi"][0] == pytest.approx(style.DPI, abs=0.1) and image.mode == "RGB"
    found = re.search(rb'width="([\d.]+)pt" height="([\d.]+)pt"', content["svg"])
    assert [float(each) for each in found.groups()] == pytest.approx([72 * width, 72 * height], abs=1e-4)
    assert b"<dc:source>a mark</dc:source>" in content["svg"]


def test_the_small_print_is_there_as_text_and_its_rows_hold_nothing_else(tmp_path):
    from PIL import Image

    image = Image.open(io.BytesIO(figures.render(built(tmp_path, two_methods(), STACKED), "a mark")["png"]))
    image.load()
    said, rows = image.info["Description"].split("\n"), int(image.info["Description-Rows"])
    assert said[0].startswith("Bar and number: the whole frame's median (ms)") and "llvmpipe" in said[-1]
    dark = (np.asarray(image) < 250).any(axis=(1, 2))[::-1]
    assert dark[:rows].any() and dark[rows:].any() and not dark[rows - 1:rows + 3].any()


def test_lines_images_and_clipping_stand_at_their_place_in_pixels():
    """An image of four colours fills axes of 150 by 75 pixels, whose lower left corner is at 75, 30 from below."""
    figure = blank()
    axes = figure.add_axes((0.25, 0.2, 0.5, 0.5))
    axes.set_axis_off()
    axes.imshow(np.array([[[255, 0, 0], [0, 255, 0]], [[0, 0, 255], [0, 0, 0]]], dtype=np.uint8), origin="lower",
                interpolation="nearest", aspect="auto")
    axes.plot([-9, 9], [0, 0], color="#ffff00", linewidth=4.0)  # ends where the axes do
    axes.set_xlim(-0.5, 1.5)
    found = pixels_of(figures.render(figure))
    rows = found[::-1]
    assert rows[40, 100].tolist() == [255, 0, 0] and rows[40, 200].tolist() == [0, 255, 0]
    assert rows[90, 100].tolist() == [0, 0, 255] and rows[90, 200].tolist() == [0, 0, 0]
    line = 30 + 75 / 4
    assert rows[int(line), 80].tolist() == rows[int(line), 220].tolist() == [255, 255, 0]
    assert rows[int(line), 70].tolist() == rows[int(line), 230].tolist() == [255, 255, 255]
    assert (rows[:, 150] == [255, 255, 0]).all(axis=1).sum() == pytest.approx(4.0 * style.DPI / 72, abs=1.5)


@pytest.mark.parametrize("angle", [0, 90])
def test_text_stands_where_its_box_says(angle):
    figure = blank()
    text = figure.text(0.5, 0.5, "HH", fontsize=20, rotation=angle, color="black", ha="center", va="center")
    dark = np.argwhere(pixels_of(figures.render(figure))[::-1].min(axis=2) < 128)
    low, high = dark.min(axis=0), dark.max(axis=0) + 1
    width, height = face_of(font()).setting("HH").width, face_of(font()).setting("HH").top
    along, across = (1, 0) if angle == 0 else (0, 1)
    assert (low + high)[along] / 2 == pytest.approx([75, 150][along], abs=1.5), text
    assert (high - low)[along] == pytest.approx(20 / 72 * style.DPI * (width / EM - 0.2), abs=3)
    assert (high - low)[across] == pytest.approx(20 / 72 * style.DPI * height / EM, abs=1.5)


def test_a_glyph_of_an_svg_file_is_defined_once_and_used_wherever_it_stands():
    figure = blank()
    figure.text(0.1, 0.6, "abba <&> --", fontsize=8)
    figure.text(0.1, 0.2, "ab", fontsize=12, fontweight="bold")
    svg = figures.render(figure)["svg"].decode()
    names = re.findall(r'<path id="(DejaVuSans(?:-Bold)?-[0-9a-f]+)" d="M', svg)
    assert len(names) == len(set(names)) == 6 + 2
    assert re.findall(r'<use xlink:href="#([^"]+)"', svg).count(names[0]) == 2
    ET.fromstring(svg)


def test_a_line_is_as_wide_as_its_words_and_the_gaps_between_them():
    face = face_of(font())
    gap = face.setting("a b").width - face.setting("a").width - face.setting("b").width
    assert face.setting("mfr-bench draws figures").width == pytest.approx(
        sum(face.setting(word).width for word in ("mfr-bench", "draws", "figures")) + 2 * gap)
    assert face.setting("AVAV").width < 4 * face.setting("A").width  # A and V stand closer
    assert face_of(font("bold")).setting("a").width > face.setting("a").width
    assert face.setting("").width == 0 and face.setting("日").glyphs[0][0].name.endswith("-0")


@pytest.mark.parametrize("text", ["mfr-bench 0.1.0 · K⁺B-SB, k = 8", "Scene: 128×128 pixels; opacity 0.1–0.6"])
def test_widths_are_those_of_matplotlib(text):
    from matplotlib.textpath import text_to_path

    expected = text_to_path.get_text_width_height_descent(text, font(), False)[0]
    assert face_of(font()).setting(text).width == pytest.approx(expected, rel=2e-3)


def test_a_script_that_joins_its_letters_is_set_as_matplotlib_does():
    found = face_of(font()).setting("سلام abc")
    assert len(found.glyphs) == 1 and found.width > 0 and len(found.outline[0])


READS_IN_COPIES = """
from multiprocessing import get_context
from matplotlib import get_data_path
from mfr_bench.report.figures.glyphs import face

font = face(get_data_path() + "/fonts/ttf/DejaVuSans.ttf")
font.setting("A")

def outlines(_):
    glyphs = [font.setting(chr(code)).glyphs[0][0] for code in range(0x21, 0x500)]
    return [(glyph.advance, glyph.bottom, glyph.top) for glyph in glyphs]

with get_context("fork").Pool(4) as pool:
    copies = pool.map(outlines, range(4), 1)
assert copies == [outlines(0)] * 4
"""


def test_copies_of_a_process_read_outlines_each_from_a_file_of_its_own():
    """The place in an open file is one for all copies: they read wrong outlines, or ended in 'invalid outline'."""
    run = subprocess.run([sys.executable, "-c", READS_IN_COPIES], capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stderr
