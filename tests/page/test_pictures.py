"""The figures of the page: fewer colours, and each line and bar in its own."""

import base64
import io

import numpy as np
import pytest
from PIL import Image, ImageDraw
from PIL.PngImagePlugin import PngInfo

from mfr_bench.errors import StoreError
from mfr_bench.page.pictures import APART, figure_picture
from mfr_bench.report import style
from mfr_bench.report.figures import render, sheet


def shown(uri):
    with Image.open(io.BytesIO(base64.b64decode(uri.partition(",")[2]))) as image:
        return np.asarray(image.convert("RGB"), dtype=int)


def figure(path, colours):
    """Thin lines of many colours, a pale band, and much text, drawn four times as large for smooth edges."""
    image = Image.new("RGB", (1600, 1600), "white")
    draw = ImageDraw.Draw(image)
    draw.rectangle((0, 1200, 1600, 1300), fill=style.BAND)
    for place, colour in enumerate(colours):
        draw.line((40, 40 + 40 * place, 1500, 80 + 40 * place), fill=colour, width=8)
    for place in range(12):
        draw.text((20, 1310 + 24 * place), "small print " * 22, fill=style.QUIET)
    image.resize((400, 400), Image.Resampling.BOX).save(path)
    return path


def test_every_line_keeps_its_colour(tmp_path):
    colours = [*style.FAMILY_COLOURS, style.BAND]
    path = figure(tmp_path / "a.png", style.FAMILY_COLOURS)
    uri, width, height, said = figure_picture(path)
    with Image.open(path) as image:
        before = np.asarray(image.convert("RGB"), dtype=int)
    after = shown(uri)
    assert after.shape == before.shape == (height, width, 3) and said == ()
    assert np.sqrt(((after - before) ** 2).sum(axis=2)).max() <= APART
    for colour in colours:
        exact = np.array([int(colour[i:i + 2], 16) for i in (1, 3, 5)])
        of_line = (before == exact).all(axis=2)
        assert of_line.any() and (after[of_line] == exact).all(), colour


def test_smooth_edges_take_few_colours(tmp_path):
    path = figure(tmp_path / "a.png", style.FAMILY_COLOURS)
    with Image.open(path) as image:
        before = len(image.convert("RGB").getcolors(2**24))
    after = len(np.unique(shown(figure_picture(path)[0]).reshape(-1, 3), axis=0))
    assert after <= 256 and after < before / 4


def test_a_colour_that_a_legend_names_is_kept_however_little_there_is_of_it(tmp_path):
    """Those of two passes are near each other: what shows `referencing` was shown in the colour of `resolve`."""
    colours = [style.PASS_COLOURS[name] for name in ("resolve", "referencing")]
    image = Image.new("RGB", (400, 400), "white")
    draw = ImageDraw.Draw(image)
    draw.rectangle((0, 0, 200, 200), fill=colours[0])
    draw.rectangle((300, 300, 309, 301), fill=colours[1])
    image.save(tmp_path / "a.png")
    after = shown(figure_picture(tmp_path / "a.png")[0])
    for (x, y), colour in zip(((100, 100), (305, 300)), colours, strict=True):
        assert tuple(after[y, x]) == tuple(int(colour[i:i + 2], 16) for i in (1, 3, 5))


def test_small_print_that_a_file_has_as_text_is_left_out_of_its_picture(tmp_path):
    """Small print takes half of the bytes of a page as pixels, and nobody can copy it."""
    said = ["Bars: 95 % interval of the median.", "K⁺B-Array; k = 4 … 64", "after kplus2015, Fig. 6 · llvmpipe"]
    with sheet.styled():
        figure = sheet.FigureSheet(3.0, ("A title",), ("Bars: 95 % interval", "of the median.", *said[1:]), 1.0,
                                   tuple(said)).figure()
    content = render(figure, "drawn from nothing")["png"]
    (tmp_path / "a.png").write_bytes(content)
    uri, width, height, found = figure_picture(tmp_path / "a.png")
    assert found == tuple(said)
    whole = np.asarray(Image.open(io.BytesIO(content)))
    dark = (whole < 200).any(axis=(1, 2)).nonzero()[0]
    assert dark.max() > height and shown(uri).shape == (height, width, 3)
    title = dark[dark < 40]
    assert len(title) > 5 and (dark[dark < height] == title).all()


@pytest.mark.parametrize("told", ["x", "-5", "40", "9999"])
def test_a_picture_whose_rows_of_small_print_are_no_number_of_its_rows_is_whole(tmp_path, told):
    texts = PngInfo()
    texts.add_text("Description", "one\ntwo")
    texts.add_text("Description-Rows", told)
    Image.new("RGB", (30, 40), "white").save(tmp_path / "a.png", pnginfo=texts)
    assert figure_picture(tmp_path / "a.png")[1:] == (30, 40, ("one", "two"))


@pytest.mark.parametrize("left", [0, 20, -30])
def test_a_damaged_figure_is_named_with_the_command_that_draws_it_again(tmp_path, left):
    path = tmp_path / "figures" / "a.png"
    path.parent.mkdir()
    Image.effect_noise((60, 60), 90).save(path)
    path.write_bytes(path.read_bytes()[:left])
    with pytest.raises(StoreError, match=f"a.png: no picture .*; mfr-bench plot {tmp_path} draws it again"):
        figure_picture(path)
