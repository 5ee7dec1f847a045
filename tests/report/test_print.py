"""Figures as they go to print: what they say of the scene, and what must not hide or mislead."""

from __future__ import annotations

import re

import numpy as np
import pytest

from mfr_bench.report import data, figures
from mfr_bench.report.figures import sheet
from mfr_bench.report.figures.kinds.work import NEAR, _spread
from mfr_bench.report.tables import markdown

from . import planted
from .drawing import FRAMES, WORK, keep_arrays
from .planted import cell

LINES = {"kind": "lines", "x": "n", "y": "time_ms", "log": "xy", "log_base": 2}


def built(folder, options):
    return figures.build(data.load(folder), options)


def small_print(figure):
    return " ".join(figure.texts[1].get_text().split())


def at(k, n, status="ok", method="kb-sr", time_ms=4.0, **scene):
    return cell(method, method.upper(), time_ms if status == "ok" else None, status=status, params={"k": k},
                point={"k": k, "scene.depth_complexity": n}, scene={"depth_complexity": n, **scene})


@pytest.mark.parametrize("kind", [{"kind": "stacked_passes", "x": "k"}, LINES,
                                  {"kind": "pareto", "x": "time_ms", "y": "rmse"},
                                  {"kind": "bars", "x": "k", "y": "memory_mib"}], ids=lambda o: o["kind"])
def test_size_profile_and_scene_are_said_and_symbols_spelt_out(tmp_path, kind):
    folder = planted.folder(tmp_path, [at(4, 16), at(8, 64)], [kind], profile="smoke")
    said = small_print(built(folder, kind))
    for part in ("Scene: 64×64 pixels", "depth complexity n = 16 … 64 (fragments per covered pixel)",
                 "k = 4 … 8 (fragments kept per pixel)", "pixel density p_d = 1", "fragment probability f_p = 1",
                 "layout block", "profile smoke"):
        assert part in said
        assert part in markdown(data.load(folder))


@pytest.mark.parametrize("kind", [
    {"kind": "stacked_passes", "x": "n"}, LINES, {"kind": "bars", "x": "n", "y": "memory_mib"},
    {"kind": "maps", "x": "n", "y": "error"},
    {"kind": "heat", "x": "n", "rows": "order", "y": "time_ms"}, {"kind": "breaking", "x": "n"},
    {"kind": "histogram", "x": "n"}, {"kind": "work", "x": "n"}], ids=lambda o: o["kind"])
def test_the_scene_is_that_of_the_cells_of_the_figure(tmp_path, kind):
    """k is none of A-buffers, and no other method's n is theirs."""
    lists = [cell("ab-ll", "AB_LL", 4.0, scene={"depth_complexity": n}, point={"scene.depth_complexity": n},
                  work=WORK, frames=FRAMES) for n in (16, 32)]
    options = kind | {"methods": ["ab-ll"]}
    folder = keep_arrays(planted.folder(tmp_path, [*lists, at(4, 64), at(31, 64)], [options]), error=np.zeros((4, 4)))
    said = small_print(built(folder, options))
    assert "depth complexity n = 16 … 32 (" in said and "k = " not in said


def test_a_mesh_is_told_with_the_depth_and_the_coverage_that_it_has(tmp_path):
    """It has no n and no p_d, and k is of the methods."""
    mesh = {"kind": "mesh", "size": [10, 8], "file": "meshes/knot.obj", "order": "file", "alpha": "material",
            "fragment_probability": 1.0, "depth_complexity": None, "pixel_density": None, "layout": None}
    counted = {"max_fragments": 6, "covered_pixels": 20}
    cells = [cell(m, m, 1.0, scene=mesh, params={"k": k}, values=counted) for m, k in (("kb", 4), ("kplus-array", 16))]
    options = {"kind": "bars", "x": "order", "y": "time_ms"}
    said = small_print(built(planted.folder(tmp_path, cells, [options], profile="smoke"), options))
    assert ("Scene: 10×8 pixels; up to 6 fragments per pixel; 25 % of the pixels covered; mesh; order file; opacity "
            "material; knot.obj; profile smoke. Methods: k = 4 … 16 (fragments kept per pixel).") in said


def test_a_cell_that_is_drawn_is_not_called_not_drawn(tmp_path):
    """A method that is refused in one panel only is named with that panel."""
    cells = [at(4, 16), at(4, 64), at(16, 16, "unsupported"), at(16, 64, "unsupported"), at(32, 16),
             at(32, 64, "over_budget")]
    options = LINES | {"panels": "k"}
    said = small_print(built(planted.folder(tmp_path, cells, [options]), options))
    assert "KB-SR: unsupported at k = 16;" in said
    assert "KB-SR: over budget at k = 32, n = 64" in said


def test_values_of_x_that_nearly_meet_share_a_tick(tmp_path):
    cells = [cell("kb", "KB", 1.0 + i, values={"fragments": f}, point={"scene.seed": i}, scene={"seed": i})
             for i, f in enumerate((8000, 16128, 16200, 24500, 24510))]
    axes, = built(planted.folder(tmp_path, cells), {"kind": "lines", "x": "fragments", "y": "time_ms"}).axes
    assert list(axes.get_xticks()) == [8000, 16128, 24500]


@pytest.mark.parametrize("log", [None, "y"])
def test_the_chosen_k_is_written_above_the_bars(tmp_path, log):
    pixels = [0, *([400] * 30)]
    frames = [{"frame": 0, "fragments": 1, "covered_pixels": 1, "max_fragments": 30, "chosen_k": 20, "kept": 1,
               "histogram": pixels}]
    folder = planted.folder(tmp_path, [cell("kplus-array", "K", 1.0) | {"frames": frames}])
    options = {"kind": "histogram", "x": "k", "log": log, "log_base": 2}
    figure = built(folder, options)
    figure.canvas.draw()
    axes = figure.axes[0]
    text, = [t for t in axes.texts if t.get_text().startswith("k = ")]
    top = axes.transData.transform((20, 400))[1]
    assert text.get_window_extent().y0 > top


def test_variants_of_a_method_differ_in_more_than_dashes(tmp_path):
    cells = [cell(m, m, 1.0 + n, point={"scene.depth_complexity": n, "scene.pixel_density": d},
                  scene={"depth_complexity": n, "pixel_density": d})
             for m in ("kb-ps", "kb") for n in (4, 8) for d in (0.25, 0.75)]
    axes, = built(planted.folder(tmp_path, cells), LINES).axes
    looks = {(line.get_color(), line.get_markerfacecolor(), line.get_marker()) for container in axes.containers
             for line in [container.lines[0]]}
    colours = [line.lines[0].get_color() for line in axes.containers]
    assert len(looks) == 4 and len(set(colours)) == 4


def test_markers_of_work_that_would_hide_each_other_stand_apart():
    places = _spread({"a": 1000, "b": 1001, "c": 1050, "d": 5000})
    assert places["d"] == 0 and len({places[n] for n in "abc"}) == 3 and NEAR * 1001 > 1050


def test_black_maps_say_why(tmp_path):
    folder = keep_arrays(planted.folder(tmp_path, [cell("kb", "KB", 1.0)]), error=np.full((8, 8), 1e-7))
    said = small_print(built(folder, {"kind": "maps", "x": "k", "y": "error"}))
    assert "less than one step of 8 bits" in said and "because the images are right" in said


def test_glyphs_come_from_the_font_that_matplotlib_brings(tmp_path, monkeypatch):
    """A system's own DejaVu of another version gives other glyph numbers, which stand in SVG files."""
    from matplotlib import font_manager, get_data_path

    folder = planted.folder(tmp_path, [at(4, 16), at(8, 64)])
    before = figures.render(built(folder, LINES))
    system = [font_manager.FontEntry(fname="/nowhere/DejaVuSans.ttf", name="DejaVu Sans")]
    monkeypatch.setattr(font_manager.fontManager, "ttflist", [*system, *font_manager.fontManager.ttflist])
    with sheet.styled():
        assert font_manager.findfont(font_manager.FontProperties()).startswith(get_data_path())
    assert figures.render(built(folder, LINES)) == before
    assert re.search(rb'id="DejaVuSans-[0-9a-f]+"', before["svg"])


def test_folders_drawn_side_by_side_have_the_same_files(tmp_path):
    folders = [planted.folder(tmp_path / name, [at(4, 16), at(8, 64)], [LINES], name=name) for name in "abc"]
    alone = {path: path.read_bytes() for folder in folders for path in figures.write_figures(folder)}
    for path in alone:
        path.unlink()
    written = [path for drawn in figures.write_all(folders, processes=2) for path in drawn.paths]
    assert written == list(alone)
    assert {path: path.read_bytes() for path in written} == alone


@pytest.mark.parametrize(("renderer", "y", "said"), [
    ("llvmpipe (LLVM 15)", "rmse", True), ("NVIDIA H100", "rmse", False), ("llvmpipe (LLVM 15)", "memory_mib", False)])
def test_a_software_driver_shows_no_race_and_the_figure_says_so(tmp_path, renderer, y, said):
    options = {"kind": "bars", "x": "k", "y": y}
    folder = planted.folder(tmp_path, [at(4, 16), at(8, 64)], [options], device={"renderer": renderer})
    assert ("errors by races between them" in small_print(built(folder, options))) is said


def test_characters_that_the_font_lacks_are_told_once(tmp_path):
    folder = planted.folder(tmp_path, [cell("ab-array", "日本 ☃ k⁺", 4.0, params={"k": k}) for k in (1, 2)],
                            [{"kind": "lines", "x": "k", "y": "time_ms"}])
    with pytest.warns(UserWarning, match="font") as told:
        figures.write_figures(folder)
    assert [str(each.message).partition(": ")[2] for each in told] == [
        "the font of the figures lacks 日 本; boxes stand for them"]
