"""Every figure: its small print, its files, the same bytes each time; and results that are not whole."""

from __future__ import annotations

import subprocess
import sys

import numpy as np
import pytest

from mfr_bench.errors import StoreError
from mfr_bench.report import data, figures, write_together

from . import planted
from .drawing import (
    KINDS,
    LINES,
    MAPS,
    STACKED,
    all_texts,
    built,
    curves,
    drawn_texts,
    mapped,
    texts_of,
    two_methods,
    undrawn,
)
from .planted import cell


@pytest.mark.parametrize("options", KINDS, ids=lambda o: o["kind"])
def test_the_small_print_says_where_it_comes_from(tmp_path, options):
    texts = " ".join(all_texts(built(tmp_path, two_methods(), options))).replace("\n", " ")
    for part in ("llvmpipe (LLVM 15.0.6, 256 bits)", "Mesa 22.3.6", "timer: wall", "2024-05-06", "kplus2015", "Fig. 6"):
        assert part in texts


@pytest.mark.parametrize("cells", [[], [cell("kb", "KB", None, status="unsupported", reason="needs x")]],
                         ids=["nothing", "unsupported"])
@pytest.mark.parametrize("options", KINDS, ids=lambda o: o["kind"])
def test_a_figure_without_a_value_is_not_drawn_and_its_line_says_why(tmp_path, options, cells):
    """A picture of empty axes tells less than a line; one that an earlier run left is of other cells."""
    folder = planted.folder(tmp_path, cells, [options])
    stale = tmp_path / "figures" / "planted.png"
    stale.parent.mkdir(exist_ok=True)
    stale.write_bytes(b"of other cells")
    with pytest.warns(UserWarning, match="not drawn") as told:
        assert figures.write_figures(folder) == []
    line, = (str(each.message) for each in told)
    assert line.startswith(f"{tmp_path / 'figures' / 'planted'}: not drawn ({options['kind']} of ")
    assert line.endswith("Unsupported: KB (needs x)" if cells else "no cell was measured")
    assert not stale.exists()
    drawn, = figures.write_all([folder])
    assert (drawn.paths, drawn.empty) == ([], [line])


@pytest.mark.parametrize(("options", "cells", "why"), [
    ({"methods": ["ab-ll", "SB, 1"]}, [cell("kb", "KB")], "no cell is of a method of this figure: ab-ll and SB, 1"),
    ({}, [cell("floor", "floor")], "no cell is of another method than the floor"),
    ({"y": "memory_bytes"}, [cell("kb", "KB", values={"memory_bytes": None})], "no cell has memory_bytes")],
    ids=["methods", "floor", "memory"])
@pytest.mark.parametrize("kind", ["lines", "bars"])
def test_a_figure_without_a_value_names_what_is_lacking(tmp_path, kind, options, cells, why):
    """A run of other methods was said to have no times, and one without memory no column of the table's."""
    assert undrawn(tmp_path, cells, {"kind": kind, "x": "k"} | options) == why


MESH = {"depth_complexity": None, "pixel_density": None}


@pytest.mark.parametrize(("options", "drawn"), [
    ({"kind": "lines", "x": "n"}, False), ({"kind": "lines", "x": "order", "panels": "n"}, True),
    ({"kind": "bars", "x": "n", "panels": "p_d"}, True), ({"kind": "stacked_passes", "x": "n"}, True),
    ({"kind": "heat", "x": "n", "rows": "order", "y": "time_ms"}, False)], ids=str)
def test_a_scene_that_lacks_an_axis_is_drawn_without_it(tmp_path, options, drawn):
    """A mesh has no n: figures by n had axes without a line, or nothing at all, between title and small print."""
    cells = [cell(m, m, 2.0, {"store": 2.0}, scene=MESH) for m in ("kb", "ab-ll")]
    if not drawn:
        assert undrawn(tmp_path, cells, options).startswith("no cell ")
        return
    axes, = built(tmp_path, cells, options).axes
    assert axes.patches or axes.lines
    assert not [text for text in all_texts(axes.figure) if "any n" in text]


@pytest.mark.parametrize("options", KINDS, ids=lambda o: o["kind"])
@pytest.mark.parametrize("scale", [1e-4, 1, 1e4])
def test_no_text_leaves_the_figure_or_runs_into_the_axis_label(tmp_path, options, scale):
    cells = [cell("y", "Y", scale, {"store": scale}, params={"k": 8}, point={"k": 8})]
    long = "A label that is much longer than any label should be (culling off)"
    cells += [*planted.sweep((4, 8, 64)), cell("x", long, 9.0, {"store": 9.0}, params={"k": 4}, point={"k": 4})]
    figure = built(tmp_path, cells, options, title="A long title " * 12)
    figure.canvas.draw()
    width, height = figure.get_size_inches() * figure.dpi
    for text in drawn_texts(figure):
        box = text.get_window_extent()
        assert box.x0 >= -1 and box.y0 >= -1 and box.x1 <= width + 1 and box.y1 <= height + 1, text
    for axes in figure.axes:
        right = axes.yaxis.label.get_window_extent().x1
        ticks = [t for t in drawn_texts(figure) if t in axes.get_yticklabels() and t.get_text()]
        assert all(t.get_window_extent().x0 > right for t in ticks)


def test_a_dollar_sign_is_no_mathematics(tmp_path):
    figure = built(tmp_path, [cell("kb", "cost $x_{", 2.0, params={"k": 4}, point={"k": 4})], STACKED)
    assert figures.render(figure)["png"].startswith(b"\x89PNG")


def test_an_option_that_cannot_be_drawn_is_one_line(tmp_path):
    for wrong in ({"kind": "pie", "x": "k"}, {"kind": "lines", "x": "k", "y": "time"}, {"kind": "lines"}):
        with pytest.raises(StoreError) as caught:
            built(tmp_path, two_methods(), wrong)
        assert "\n" not in str(caught.value) and "allowed" in str(caught.value)


def test_files_are_numbered_and_the_same_each_time(tmp_path):
    folder = planted.folder(tmp_path, two_methods(), [STACKED, KINDS[1]], name="a/b c")
    written = figures.write_figures(folder)
    assert [path.name for path in written] == ["a-b-c-1.png", "a-b-c-1.svg", "a-b-c-2.png", "a-b-c-2.svg"]
    before = [path.read_bytes() for path in written]
    figures.write_figures(folder, force=True)
    assert [path.read_bytes() for path in written] == before


def test_two_processes_write_the_same_files(tmp_path):
    folder = planted.folder(tmp_path, two_methods(), KINDS)
    before = [path.read_bytes() for path in figures.write_figures(folder)]
    for path in (tmp_path / "figures").iterdir():
        path.unlink()
    assert [path.read_bytes() for path in figures.write_figures(folder, processes=2)] == before


def test_an_error_in_the_other_process_is_told(tmp_path):
    folder = planted.folder(tmp_path, two_methods(), [STACKED, {"kind": "pie", "x": "k"}])
    with pytest.raises(StoreError, match="pie"):
        figures.write_figures(folder, processes=2)


def test_without_figures_nothing_is_asked_of_their_font(tmp_path, monkeypatch):
    """matplotlib takes longer to import than a small run takes otherwise."""
    monkeypatch.setattr("mfr_bench.report.figures.files.lacking_glyphs", lambda text: pytest.fail("asked"))
    assert figures.write_figures(planted.folder(tmp_path, [planted.cell()])) == []


def test_the_users_own_matplotlib_settings_change_nothing(tmp_path):
    import matplotlib as mpl
    before = figures.render(built(tmp_path, two_methods(), STACKED))
    with mpl.rc_context({"font.size": 30, "axes.facecolor": "red", "svg.hashsalt": None}):
        assert figures.render(built(tmp_path, two_methods(), STACKED)) == before


def test_another_process_draws_the_same_bytes(tmp_path):
    folder = planted.folder(tmp_path, two_methods(), [STACKED])
    here = [path.read_bytes() for path in figures.write_figures(folder)]
    code = f"from mfr_bench import store, report; report.write_figures(store.ResultFolder({str(tmp_path)!r}))"
    subprocess.run([sys.executable, "-c", code], check=True)
    assert [path.read_bytes() for path in sorted((tmp_path / "figures").iterdir())] == here


def test_tables_load_neither_matplotlib_nor_pandas_nor_gl(tmp_path):
    planted.folder(tmp_path, two_methods(), [STACKED])
    code = ("import sys; from mfr_bench import store, report; "
            f"f = store.ResultFolder({str(tmp_path)!r}); report.write_tables(f); store.derive(f); "
            "print({'matplotlib', 'pandas', 'moderngl', 'numpy'} & set(sys.modules))")
    done = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True)
    assert done.stdout.strip() == "set()"


def test_drawing_loads_no_pyplot_and_no_pandas(tmp_path):
    planted.folder(tmp_path, two_methods(), [STACKED])
    code = ("import sys; from mfr_bench import store, report; "
            f"report.write_figures(store.ResultFolder({str(tmp_path)!r})); "
            "print({'matplotlib.pyplot', 'pandas', 'moderngl'} & set(sys.modules))")
    done = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True)
    assert done.stdout.strip() == "set()"


def spoilt(tmp_path, figures_wanted, **manifest):
    """Six planned cells: one gone, one cut off, one of an older schema, one that another program wrote."""
    cells = [cell("kb", "KB", k / 2, {"store": k / 3}, params={"k": k}, point={"k": k}) for k in (2, 4, 8, 16, 32)]
    foreign = cell("someones-own", "Own", 3.0, params={"depth": "?"}, values={"memory_bytes": None})
    folder = planted.folder(tmp_path, [*cells, foreign], figures_wanted, sweep={"k": [2, 4, 8, 16, 32]}, **manifest)
    paths = [folder.cells_path / f"{c['key']}.json" for c in cells]
    paths[0].unlink()
    paths[1].write_text(paths[1].read_text()[:100])
    paths[2].write_text(paths[2].read_text().replace('"schema": 1', '"schema": 0'))
    return planted.store.ResultFolder(tmp_path)


@pytest.mark.parametrize("options", KINDS, ids=lambda o: o["kind"])
def test_what_can_be_drawn_is_drawn_and_what_is_missing_is_named(tmp_path, options):
    folder = spoilt(tmp_path, [options])
    written = figures.write_figures(folder)
    assert all(path.stat().st_size for path in written)
    text = " ".join(all_texts(figures.build(data.load(folder), options))).replace("\n", " ")
    assert "3 planned cells have no record; 2 files could not be used" in text
    assert len(folder.damaged) == 2


def test_what_is_left_of_a_line_is_drawn_at_its_place(tmp_path):
    axes, = figures.build(data.load(spoilt(tmp_path, [])), {"kind": "lines", "x": "k"}).axes
    assert list(curves(axes)["KB"].get_xdata()) == [16, 32]
    assert list(curves(axes)["KB"].get_ydata()) == pytest.approx([8, 16])


@pytest.mark.parametrize("odd", [{"figures": 7}, {"figures": [3, None]}, {"source": "a paper"}, {"sweep": [1]},
                                 {"zip": "k"}, {"device": "a card"}], ids=str)
def test_a_manifest_of_another_program_is_used_as_far_as_it_goes(tmp_path, odd):
    folder = planted.folder(tmp_path, two_methods(), [STACKED])
    folder.write_manifest(folder.manifest() | odd)
    figures.write_figures(folder)
    assert figures.build(data.load(folder), LINES | {"x": "k"}).axes
    assert odd in ({"figures": [3, None]}, {"device": "a card"}) or "not of its type" in folder.damaged[0]


@pytest.mark.parametrize("content", [b"", b"PK", b"no archive", b"\x00" * 4000])
def test_an_array_that_cannot_be_read_is_named_and_not_drawn(tmp_path, content):
    arrays = {("KB", 8): {"error": np.ones((4, 4))}, ("KB-SR", 8): {"error": np.ones((4, 4))}}
    mapped(tmp_path, MAPS, arrays)
    folder = planted.store.ResultFolder(tmp_path)
    path = folder.arrays_path(folder.cells()[0]["key"])
    path.write_bytes(content)
    figures.write_figures(folder, processes=2)
    assert folder.damaged[0].startswith(f"{path}: cannot be read")
    figure = figures.build(data.load(planted.store.ResultFolder(tmp_path)), MAPS)
    assert "error not measured" in texts_of(figure.axes[0]) and figure.axes[1].images


def test_devices_stand_side_by_side(tmp_path):
    devices = [planted.DEVICE, planted.DEVICE | {"slug": "h200", "renderer": "NVIDIA H200", "version": "4.6"}]
    folders = [planted.folder(tmp_path / d["slug"], [c | {"device": d} for c in two_methods()], [STACKED], device=d)
               for d in devices]
    written = write_together(folders, tmp_path / "out")
    names = [f"planted{part}.{kind}" for part in ("", "-ratios", "-ranks") for kind in ("png", "svg")]
    assert [path.name for path in written] == [*names, "planted-devices.md"]
    joined = data.join([data.load(f) for f in folders])
    figure = figures.build(joined, STACKED | {"panels": "device"})
    assert [axes.get_title(loc="left") for axes in figure.axes] == ["device = llvmpipe", "device = h200"]
    assert "NVIDIA H200" in " ".join(all_texts(figure)) and "llvmpipe" in " ".join(all_texts(figure))


def test_an_experiment_of_one_folder_is_not_drawn_together(tmp_path):
    folders = [planted.folder(tmp_path / name, two_methods(), [STACKED], name=name) for name in ("a", "b")]
    assert write_together(folders, tmp_path / "out") == []


def test_figures_of_an_earlier_config_do_not_stay(tmp_path):
    folder = planted.folder(tmp_path, two_methods(), figures=[LINES])
    kept = folder.path / "figures" / "mine.png"
    assert {path.name for path in figures.write_figures(folder)} == {"planted.png", "planted.svg"}
    kept.write_bytes(b"a user's own")
    folder.write_manifest({**folder.manifest(), "figures": [LINES, STACKED]})
    figures.write_figures(folder)
    assert {path.name for path in kept.parent.iterdir()} == {
        "mine.png", "planted-1.png", "planted-1.svg", "planted-2.png", "planted-2.svg"}
