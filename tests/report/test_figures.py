"""Figures by what they show: heights, values, labels, signs; and that they never change by themselves."""

from __future__ import annotations

import subprocess
import sys
from itertools import combinations

import numpy as np
import pytest

from mfr_bench.config import columns
from mfr_bench.errors import StoreError
from mfr_bench.methods import catalog
from mfr_bench.report import data, figures, style
from mfr_bench.stats import median_interval
from mfr_bench.store.arrays import write_arrays

from . import planted
from .planted import cell

STACKED = {"kind": "stacked_passes", "x": "k", "y": "time_ms", "log": "y"}
LINES = {"kind": "lines", "x": "n", "y": "time_ms", "log": "xy", "log_base": 2}


def built(tmp_path, cells, options, **manifest):
    return figures.build(data.load(planted.folder(tmp_path, cells, [options], **manifest)), options)


def bars_of(axes):
    """Bottom, height and label of each drawn piece of a bar, in drawing order."""
    return [(p.get_y(), p.get_height(), p.get_label()) for p in axes.patches
            if ": " in p.get_label() and not p.get_label().startswith("hatch")]


def texts_of(axes):
    return [text.get_text() for text in axes.texts]


def all_texts(figure):
    from matplotlib.text import Text
    return [t.get_text() for t in figure.findobj(Text) if t.get_text()]


def drawn_texts(figure):
    """Texts that are seen: of ticks only those within the limits."""
    for axes in figure.axes:
        yield from (*axes.texts, axes.xaxis.label, axes.yaxis.label)
        for axis, (low, high) in ((axes.xaxis, axes.get_xlim()), (axes.yaxis, axes.get_ylim())):
            yield from (t.label1 for t in axis.get_major_ticks() if low <= t.get_loc() <= high)
    yield from figure.texts
    yield from (text for legend in figure.legends for text in legend.get_texts())


def two_methods(**parts):
    return [cell("kb-ps", "KB-PS", 10.0, {"clear": 1.0, "store": 6.0, "resolve": 2.5}, params={"k": k}, point={"k": k})
            for k in (4, 8)] + [
        cell("kplus-sb", "K⁺B-SB", 5.0, {"clear": 0.5, "count": 1.5, "store": 2.0}, params={"k": k}, point={"k": k},
             **parts) for k in (4, 8)]


# --- stacked passes ------------------------------------------------------------------------------


def test_segments_stack_to_the_sum_of_the_passes(tmp_path):
    axes, = built(tmp_path, two_methods(), STACKED).axes
    found = [(pytest.approx(bottom), pytest.approx(height), label) for bottom, height, label in bars_of(axes)]
    of_one_group = [(0, 1, "KB-PS: clear"), (1, 6, "KB-PS: store"), (7, 2.5, "KB-PS: resolve"),
                    (0, 0.5, "K⁺B-SB: clear"), (0.5, 1.5, "K⁺B-SB: count"), (2, 2, "K⁺B-SB: store")]
    assert found == of_one_group * 2
    assert axes.get_yscale() == "log" and axes.get_ylabel() == "time (ms)"


def test_groups_are_headed_and_bars_are_named_in_the_configs_order(tmp_path):
    texts = texts_of(built(tmp_path, two_methods(), STACKED).axes[0])
    assert [t for t in texts if t.startswith("k =")] == ["k = 4", "k = 8"]
    assert [t for t in texts if t in ("KB-PS", "K⁺B-SB")] == ["KB-PS", "K⁺B-SB"] * 2


def test_the_whole_frames_time_is_written_above_the_bar(tmp_path):
    texts = texts_of(built(tmp_path, two_methods(), STACKED).axes[0])
    assert texts.count("10.0") == 2 and texts.count("5.00") == 2


def test_a_pass_has_one_colour_and_the_legend_names_it_once(tmp_path):
    figure = built(tmp_path, two_methods(), STACKED)
    colours = {}
    for patch in figure.axes[0].patches:
        name = patch.get_label().split(": ")[-1]
        colours.setdefault(name, set()).add(patch.get_facecolor())
    assert all(len(colours[name]) == 1 for name in ("clear", "count", "store", "resolve"))
    assert len({min(colours[name]) for name in ("clear", "count", "store", "resolve")}) == 4
    assert [t.get_text() for t in figure.legends[0].get_texts()] == ["clear", "count", "store", "resolve"]


def test_methods_differ_in_hatching(tmp_path):
    axes, = built(tmp_path, planted.sweep(ks=(8,)), STACKED).axes
    hatches = [p.get_hatch() for p in axes.patches if p.get_label().startswith("hatch")]
    assert len(set(hatches)) == len(hatches) == 13  # the first of 14 drawn bars is plain


@pytest.mark.parametrize("status", ["unsupported", "over_budget", "timeout", "out_of_memory"])
def test_a_cell_without_a_time_is_a_sign_and_no_bar(tmp_path, status):
    cells = [*two_methods()[:2], cell("kb", "KB", None, status=status, params={"k": 4}, point={"k": 4})]
    axes, = built(tmp_path, cells, STACKED).axes
    assert not any(label.startswith("KB:") for _, _, label in bars_of(axes))
    assert status.replace("_", " ") in texts_of(axes)
    assert "not measured" in texts_of(axes)  # KB at k = 8 has no cell at all


def test_a_wrong_image_is_pale_and_has_no_number(tmp_path):
    axes, = built(tmp_path, two_methods(status="wrong"), STACKED).axes
    pale = {p.get_label() for p in axes.patches if p.get_alpha() == 0.35}
    assert pale == {"K⁺B-SB: clear", "K⁺B-SB: count", "K⁺B-SB: store"}
    assert texts_of(axes).count("wrong image") == 2 and "5.00" not in texts_of(axes)


def test_a_method_that_x_does_not_touch_is_drawn_once(tmp_path):
    cells = [*two_methods(), cell("ab-ll", "AB_LL", 7.0, {"store": 7.0})]
    axes, = built(tmp_path, cells, STACKED).axes
    assert texts_of(axes).count("AB_LL") == 1 and "any k" in texts_of(axes)


def test_without_pass_times_the_bar_is_the_whole_frame(tmp_path):
    axes, = built(tmp_path, [cell("kb", "KB", 4.0, params={"k": 4}, point={"k": 4})], STACKED).axes
    (bottom, height, label), = bars_of(axes)
    assert (bottom, height, label) == (0, pytest.approx(4.0), "KB: whole frame")


def test_many_bars_go_into_rows_of_the_same_scale(tmp_path):
    figure = built(tmp_path, planted.sweep(), STACKED)
    assert len(figure.axes) == 2
    assert figure.axes[0].get_ylim() == figure.axes[1].get_ylim()
    headings = [[t for t in texts_of(axes) if t.startswith("k = ")] for axes in figure.axes]
    assert headings == [["k = 4", "k = 8", "k = 16"], ["k = 32", "k = 64"]]


def test_the_floor_is_a_dashed_line_and_no_bar(tmp_path):
    cells = [cell("floor", "floor", 2.0), *two_methods()]
    axes, = built(tmp_path, cells, STACKED | {"floor": True}).axes
    line, = [line for line in axes.lines if line.get_label() == "floor"]
    assert list(line.get_ydata()) == pytest.approx([2.0, 2.0])
    assert "floor" not in texts_of(axes)


def test_only_the_named_methods_are_drawn(tmp_path):
    axes, = built(tmp_path, two_methods(), STACKED | {"methods": ["kplus-sb"]}).axes
    assert {label.split(":")[0] for _, _, label in bars_of(axes)} == {"K⁺B-SB"}


def test_bars_show_one_measure(tmp_path):
    cells = [cell("kb", "KB", 4.0, params={"k": k}, point={"k": k}, values={"memory_bytes": k * 2**20}) for k in (4, 8)]
    axes, = built(tmp_path, cells, {"kind": "bars", "x": "k", "y": "memory_mib"}).axes
    assert [p.get_height() for p in axes.patches if p.get_label() == "KB"] == [4, 8]
    assert axes.get_yscale() == "linear" and axes.get_ylim()[0] == 0


# --- lines ---------------------------------------------------------------------------------------


def curves(axes):
    return {c.get_label(): c.lines[0] for c in axes.containers}


def test_lines_hold_medians_and_intervals(tmp_path):
    cells = [cell("kb", "KB", n / 2, scene={"depth_complexity": n}, point={"scene.depth_complexity": n})
             for n in (32, 8, 16)]
    axes, = built(tmp_path, cells, LINES).axes
    line = curves(axes)["KB"]
    assert list(line.get_xdata()) == [8, 16, 32] and list(line.get_ydata()) == pytest.approx([4, 8, 16])
    segments = axes.collections[0].get_segments()
    low, _, high = median_interval(planted.spread(4.0))
    assert [y for _, y in segments[0]] == pytest.approx([low, high])


def test_log_axes_have_plain_ticks(tmp_path):
    figure = built(tmp_path, planted.sweep((8, 16, 32), planted.METHODS[:2], "n"), LINES)
    axes, = figure.axes
    assert [t.get_text() for t in axes.get_xticklabels()] == ["8", "16", "32"]
    figure.canvas.draw()
    assert all(t.get_text().replace(",", "").isdigit() for t in axes.get_yticklabels())


def test_each_method_has_its_own_look(tmp_path):
    axes, = built(tmp_path, planted.sweep((8, 16), planted.METHODS, "n"), LINES).axes
    looks = [(line.get_color(), line.get_marker(), str(line.get_linestyle())) for line in curves(axes).values()]
    assert len(looks) == 14 and len(set(looks)) == 14 and len({look[1] for look in looks}) == 14


def test_a_method_keeps_its_colour_whatever_it_is_drawn_with(tmp_path):
    few = built(tmp_path / "a", planted.sweep((8, 16), planted.METHODS[7:8], "n"), LINES)
    many = built(tmp_path / "b", planted.sweep((8, 16), planted.METHODS, "n"), LINES)
    assert curves(few.axes[0])["K⁺B-Array"].get_color() == curves(many.axes[0])["K⁺B-Array"].get_color()


def test_variants_of_one_method_have_colours_of_their_own(tmp_path):
    cells = [cell("ab-sb", f"sort {i}", 2.0 + i, scene={"depth_complexity": n}, params={"sort": str(i)},
                  point={"scene.depth_complexity": n}) for i in range(8) for n in (8, 16)]
    axes, = built(tmp_path, cells, LINES).axes
    assert len({line.get_color() for line in curves(axes).values()}) == 8


def test_a_missing_value_breaks_the_line_and_is_told(tmp_path):
    axes, = (figure := built(tmp_path, planted.sweep((8, 16, 64), planted.METHODS[5:7], "n"), LINES)).axes
    ys = list(curves(axes)["KB-LL"].get_ydata())
    assert len(ys) == 1  # 16 was never measured and 64 is over the budget
    assert any("KB-LL: over budget at n = 64" in text for text in all_texts(figure))


def test_a_gap_inside_a_line_is_not_bridged(tmp_path):
    cells = list(planted.sweep((8, 16, 32), planted.METHODS[6:7], "n"))
    line = curves(built(tmp_path, [*cells, cell("kb", "KB", 3.0, scene={"depth_complexity": 16},
                                                point={"scene.depth_complexity": 16})], LINES).axes[0])["KB-LL"]
    assert list(line.get_xdata()) == [8, 16, 32] and line.get_ydata()[1] != line.get_ydata()[1]


def test_a_method_that_x_does_not_touch_is_a_level_line(tmp_path):
    cells = [*two_methods(), cell("ab-ll", "AB_LL", 7.0)]
    axes, = built(tmp_path, cells, {"kind": "lines", "x": "k", "y": "time_ms"}).axes
    line = curves(axes)["AB_LL"]
    assert list(line.get_xdata()) == [4, 8] and list(line.get_ydata()) == pytest.approx([7, 7])
    assert line.get_marker() in ("", "None")


def test_panels_share_their_axes(tmp_path):
    cells = [cell("kb", "KB", k * d, params={"k": k}, scene={"pixel_density": d},
                  point={"k": k, "scene.pixel_density": d}) for k in (4, 8) for d in (0.25, 0.75)]
    figure = built(tmp_path, cells, {"kind": "lines", "x": "k", "panels": "scene.pixel_density"})
    assert [axes.get_title(loc="left") for axes in figure.axes] == ["p_d = 0.25", "p_d = 0.75"]
    assert [list(curves(axes)["KB"].get_ydata()) for axes in figure.axes] == [
        pytest.approx([1, 2]), pytest.approx([3, 6])]
    assert figure.axes[0].get_ylim() == figure.axes[1].get_ylim()


def test_a_further_axis_is_told_in_the_labels(tmp_path):
    cells = [cell("ab-sb", "S-buffer", s * d, params={"counters": s}, scene={"pixel_density": d},
                  point={"counters": s, "scene.pixel_density": d}) for s in (1, 2) for d in (0.25, 0.75)]
    axes, = built(tmp_path, cells, {"kind": "lines", "x": "counters", "y": "time_ms"}).axes
    assert list(curves(axes)) == ["S-buffer, p_d 0.25", "S-buffer, p_d 0.75"]


def test_zipped_axes_do_not_split_a_line(tmp_path):
    cells = [cell("kplus", "K⁺", k, params={"k": k}, scene={"depth_complexity": k},
                  point={"k": k, "scene.depth_complexity": k}) for k in (8, 16)]
    axes, = built(tmp_path, cells, LINES).axes
    assert list(curves(axes)) == ["K⁺"]


def test_frames_per_second_turn_the_interval_round(tmp_path):
    result = data.load(planted.folder(tmp_path, [cell("kb", "KB", 10.0)]))
    low, middle, high = result.points[0].measure("fps")
    assert middle == pytest.approx(100) and low < middle < high


def test_measures_by_memory(tmp_path):
    point = data.load(planted.folder(tmp_path, [cell("kb", "KB", 10.0)])).points[0]
    mib = point.row["memory_bytes"] / 2**20
    assert point.measure("ms_per_mib")[1] == pytest.approx(10 / mib)
    assert point.measure("fps_per_mib")[1] == pytest.approx(100 / mib)
    pixels = point.row["width"] * point.row["height"]
    assert point.measure("words_per_pixel")[1] == pytest.approx(point.row["memory_bytes"] / 4 / pixels)


def test_a_config_may_draw_every_derived_measure():
    assert set(data.MEASURES) >= set(columns.MEASURED)
    assert {"fps", "floor_ratio", "ms_per_mib", "fps_per_mib", "words_per_pixel"} <= set(columns.MEASURED)


# --- every figure --------------------------------------------------------------------------------

KINDS = [STACKED, LINES | {"x": "k"}, {"kind": "bars", "x": "k", "y": "memory_mib", "log": "y"}]


@pytest.mark.parametrize("options", KINDS, ids=lambda o: o["kind"])
def test_the_small_print_says_where_it_comes_from(tmp_path, options):
    texts = " ".join(all_texts(built(tmp_path, two_methods(), options))).replace("\n", " ")
    for part in ("llvmpipe (LLVM 15.0.6, 256 bits)", "Mesa 22.3.6", "timer: wall", "2024-05-06", "kplus2015", "Fig. 6"):
        assert part in texts


@pytest.mark.parametrize("cells", [[], [cell("kb", "KB", None, status="unsupported", reason="needs x")]],
                         ids=["nothing", "unsupported"])
@pytest.mark.parametrize("options", KINDS, ids=lambda o: o["kind"])
def test_a_figure_without_times_is_still_drawn(tmp_path, options, cells):
    assert set(figures.render(built(tmp_path, cells, options))) == {"png", "svg"}


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
    figures.write_figures(folder)
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


# --- style ---------------------------------------------------------------------------------------


def test_every_method_has_a_colour_of_its_own_by_family_and_place():
    """No method is named: a new one takes the next shade of its family, and a foreign one a colour from its id."""
    colours = style.method_colours()
    assert set(colours) == set(catalog()) and len(set(colours.values())) == len(colours)
    assert style.method_colour("brand-new") == style.method_colour("brand-new") != style.method_colour("other-new")


def test_families_share_no_colour_and_a_new_one_changes_none():
    colours = style.family_colours(families())
    assert len(set(colours.values())) == len(colours) == len(families())
    more = style.family_colours([*families(), "brand-new"])
    assert {family: more[family] for family in colours} == colours


def test_more_families_than_colours_repeat_them():
    many = [f"family {i}" for i in range(3 * len(style.FAMILY_COLOURS))]
    assert list(style.family_colours(many)) and set(style.family_colours(many)) == set(many)


def families():
    return dict.fromkeys(method.family for method in catalog().values())


def test_methods_of_one_figure_can_be_told_apart():
    """The k-buffers of Figs. 6 and 8 and the A-buffers of Fig. 9 of kplus_2015, with normal sight and without red or
    green cones (Machado et al. 2009), in CIE Lab."""
    for together in (("kplus-array", "kplus-heap", "kplus-sb", "kb-ps", "kb-mdt32", "kb-ab-array", "kb-ab-sb", "kb-ll"),
                     ("peel-f2b", "peel-dual", "ab-array", "ab-ll", "ab-sb", "kplus-array", "kplus-sb"),
                     ("lin-post", "lin-pre", "open-post", "open-pre")):
        for sight in (None, PROTAN, DEUTAN):
            seen = {m: lab(style.method_colour(m), sight) for m in together}
            closest = min((np.linalg.norm(seen[a] - seen[b]), a, b) for a, b in combinations(seen, 2))
            assert closest[0] > (12 if sight is None else 6), (sight is not None, closest)


PROTAN = np.array([[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]])
DEUTAN = np.array([[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.011820, 0.042940, 0.968881]])


def lab(colour, sight):
    srgb = np.array([int(colour[i:i + 2], 16) for i in (1, 3, 5)]) / 255
    linear = np.where(srgb <= 0.04045, srgb / 12.92, ((srgb + 0.055) / 1.055) ** 2.4)
    linear = linear if sight is None else np.clip(sight @ linear, 0, 1)
    xyz = np.array([[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]]) @ linear
    f = np.cbrt(np.maximum(xyz / (0.9505, 1.0, 1.089), 1e-6))
    return np.array([116 * f[1] - 16, 500 * (f[0] - f[1]), 200 * (f[1] - f[2])])


def test_variants_of_a_pass_are_lighter_and_unknown_passes_have_a_colour():
    colours = style.pass_colours(["sweep", "store depth", "store", "clear"])
    assert list(colours) == ["clear", "store", "store depth", "sweep"]
    assert len(set(colours.values())) == 4


def test_shares_stack_to_one(tmp_path):
    axes, = built(tmp_path, two_methods(), {"kind": "stacked_passes", "x": "k", "y": "share"}).axes
    tops = [bottom + height for bottom, height, label in bars_of(axes) if label == "KB-PS: resolve"]
    assert tops == pytest.approx([1, 1])


def test_bytes_are_drawn_as_mib(tmp_path):
    cells = [cell("kb", "KB", 4.0, params={"k": 4}, point={"k": 4}, values={"memory_bytes": 3 * 2**20})]
    axes, = built(tmp_path, cells, {"kind": "bars", "x": "k", "y": "memory_bytes"}).axes
    assert [p.get_height() for p in axes.patches if p.get_label() == "KB"] == [3] and "MiB" in axes.get_ylabel()


# --- what papers print -----------------------------------------------------------------------------

MEMORY_2012 = {"source": {"paper": "sbuffer2012", "figure": "§4", "prints": ["memory", "memory_saved"]}}


def memory_cells(*sizes):
    return [cell(m, label, 4.0, scene={"size": list(size), "pixel_density": 0.45}, point={"scene.size": list(size)},
                 values={"memory_bytes": 20 * size[0] * size[1]})
            for size in sizes for m, label in (("ab-sb", "AB_SB"), ("ab-ll", "AB_LL"))]


def diamonds(axes):
    return [(line.get_ydata()[0], line.get_label()) for line in axes.lines if line.get_marker() == "D"
            and line.get_label().startswith("printed")]


@pytest.mark.parametrize(("size", "scale", "words"), [((640, 480), 1, "printed, GTX 480"), (
    (80, 60), 64, "printed, GTX 480 (viewport 8 times as wide by pixels)")])
def test_printed_numbers_stand_as_diamonds_at_their_bars(tmp_path, size, scale, words):
    """At the paper's viewport as they are; at a whole fraction of it, memory by pixels, and the legend says so."""
    options = {"kind": "bars", "x": "width", "y": "memory_mib", "log": "y", "printed": "memory"}
    sizes = [size, (1600 * size[0] // 640, 1200 * size[1] // 480)]
    figure = built(tmp_path, memory_cells(*sizes), options, **MEMORY_2012)
    assert diamonds(figure.axes[0])[:2] == [(pytest.approx(6.99 / scale), words), (pytest.approx(8.73 / scale), words)]
    assert words in [t.get_text() for t in figure.legends[0].get_texts()]


def test_printed_numbers_of_other_viewports_are_only_quoted(tmp_path):
    options = {"kind": "bars", "x": "width", "y": "memory_mib", "printed": "memory"}
    figure = built(tmp_path, memory_cells((50, 50)), options, **MEMORY_2012)
    assert diamonds(figure.axes[0]) == []
    text = " ".join(all_texts(figure)).replace("\n", " ")
    assert "The paper prints memory on GTX 480 (p_d 0.45, n 25): FreePipe 60.94 MB (640×480)" in text
    assert "159 MB (slip: 156 follows)" in text


def test_printed_times_are_marks_beside_the_pass(tmp_path):
    cells = [cell("ab-precalc-fixed", "PreCalc_Fixed", 4.0, {"scan": 0.5, "store": 3.0},
                  scene={"size": [640, 480], "pixel_density": 0.45}, point={"scene.size": [640, 480]})]
    options = {"kind": "bars", "x": "width", "passes": ["referencing", "scan"], "printed": "referencing_time"}
    axes, = built(tmp_path, cells, options, source=MEMORY_2012["source"] | {"prints": ["referencing_time"]}).axes
    assert [p.get_height() for p in axes.patches if p.get_label() == "PreCalc_Fixed"] == [pytest.approx(0.5)]
    assert diamonds(axes) == [(0.027, "printed, GTX 480")]
    assert axes.get_ylabel() == "time of the referencing pass (ms)"


def guides(axes):
    return {line.get_label(): (list(line.get_xdata()), list(line.get_ydata())) for line in axes.lines
            if line.get_label().startswith("printed: ")}


def gaining(n=64):
    return [cell("ab-array", f"AB {s}", ms, params={"sort": s}, scene={"depth_complexity": d},
                 point={"scene.depth_complexity": d}) for d in (32, n) for s, ms in (("hybrid", 6.0), ("lplus", 4.0))]


@pytest.mark.parametrize(("source", "options", "shown"), [
    ({"paper": "occupancy2015", "figure": "4", "prints": ["gain_of_occupancy"]},
     {"x": "n", "gain_of": "sort", "printed": "gain_of_occupancy"},
     {"printed: from 20 %, GTX 780 Ti": ([0, 1], [20, 20]), "printed: to 50 %, GTX 780 Ti": ([0, 1], [50, 50])}),
    ({"paper": "kplus2015", "figure": "§5.1.2", "prints": ["speedup"]},
     {"x": "n", "gain_of": "sort", "printed": "speedup"},
     {"printed: 3.1 ×": ([64], [pytest.approx(210)]),
      "printed: 4.64 ×": ([128], [pytest.approx(364)])}),
    ({"paper": "sbuffer2012", "figure": "3", "prints": ["best_counters"]},
     {"x": "counters", "y": "fps", "printed": "best_counters"},
     {"printed: about 30 shared counters, GTX 480": ([30, 30], [0, 1])})], ids=["share", "speed-up", "place"])
def test_printed_numbers_of_an_axis_are_guides(tmp_path, source, options, shown):
    """Gains as heights, speed-ups as gains at their n, places on x as such; the legend names the device."""
    cells = gaining() if "gain_of" in options else [
        cell("ab-sb", "AB_SB", 3.0, params={"counters": c}, point={"counters": c}) for c in (1, 32)]
    figure = built(tmp_path, cells, {"kind": "lines", **options}, source=source)
    assert guides(figure.axes[0]) == shown
    told = [t.get_text().replace("\n", " ") for t in figure.legends[0].get_texts()]
    assert set(shown) <= set(told)


# --- fits, gains, lack of memory ---------------------------------------------------------------------


def test_a_fit_says_its_coefficients_and_how_well_it_fits(tmp_path):
    cells = [cell("kb", "KB", 2 + 0.25 * n**2, scene={"depth_complexity": n}, point={"scene.depth_complexity": n})
             for n in (4, 8, 16, 32)]
    axes, = built(tmp_path, cells, {"kind": "lines", "x": "depth_complexity", "fit": "quadratic"}).axes
    text, = (t for t in texts_of(axes) if "R²" in t)
    constant, slope, square = (float(part.split("·")[0]) for part in text.split(": ")[1].split(", ")[0]
                               .replace("− ", "+ -").split(" + "))
    assert (constant, square) == (pytest.approx(2, abs=0.01), pytest.approx(0.25)) and abs(slope) < 1e-6
    assert text.endswith("R² 1.0000")


def test_too_few_points_have_no_fit(tmp_path):
    cells = [cell("kb", "KB", n, scene={"depth_complexity": n}, point={"scene.depth_complexity": n}) for n in (4, 8)]
    axes, = built(tmp_path, cells, {"kind": "lines", "x": "depth_complexity", "fit": "linear"}).axes
    assert not any("R²" in t for t in texts_of(axes))


def test_a_gain_is_the_speed_over_the_first_value_with_its_interval(tmp_path):
    cells = [cell("kplus-array", f"K⁺B {d}", ms, params={"k": k, "occupancy": d}, point={"k": k})
             for k in (4, 8) for d, ms in ((0, 6.0), (32, 4.0))]
    axes, = built(tmp_path, cells, {"kind": "lines", "x": "k", "gain_of": "occupancy"}).axes
    line = curves(axes)["K⁺B 32"]
    assert list(curves(axes)) == ["K⁺B 32"] and list(line.get_ydata()) == pytest.approx([50, 50])
    (_, low), (_, high) = axes.collections[0].get_segments()[0]
    assert 45 < low < 50 < high < 55 and axes.get_ylabel() == "gain by occupancy (%)"


@pytest.mark.parametrize("status", ["over_budget", "out_of_memory", "overflow"])
def test_cells_without_memory_are_crosses_on_the_axis(tmp_path, status):
    cells = [*two_methods(), cell("kb-ll", "KB-LL", None, status=status, params={"k": 8}, point={"k": 8})]
    figure = built(tmp_path, cells, {"kind": "lines", "x": "k", "y": "time_ms"})
    cross, = (line for line in figure.axes[0].lines if line.get_marker() == "X" and len(line.get_xdata()) == 1
              and line.get_label() == status.replace("_", " "))
    assert list(cross.get_xdata()) == [8] and cross.get_color() == style.method_colour("kb-ll")
    assert status.replace("_", " ") in [t.get_text() for t in figure.legends[0].get_texts()]
    assert any("KB-LL" in text and status.replace("_", " ") in text for text in all_texts(figure))


# --- maps and histograms ----------------------------------------------------------------------------

MAPS = {"kind": "maps", "x": "k", "y": "error"}


def mapped(tmp_path, options, arrays, **more):
    """A folder of one cell for each entry of `arrays`, which maps (label, k) to arrays; the figure of it."""
    cells = [cell("kb", label, 4.0, params={"k": k}, point={"k": k}, **more) for label, k in arrays]
    folder = planted.folder(tmp_path, cells, [options])
    for record, kept in zip(cells, arrays.values(), strict=True):
        write_arrays(folder, record["key"], kept)
    return figures.build(data.load(folder), options)


def test_maps_share_a_scale_and_stand_upright(tmp_path):
    low, high = np.zeros((4, 6)), np.zeros((4, 6))
    low[0, 0], high[3, 5] = 0.25, 0.5
    figure = mapped(tmp_path, MAPS, {("KB", 8): {"error": low}, ("KB-SR", 8): {"error": high}})
    images = [axes.images[0] for axes in figure.axes if axes.images]
    assert [image.get_clim() for image in images] == [(0, 0.5)] * 2
    assert images[0].get_array()[0, 0] == 0.25 and images[0].origin == "lower"
    assert [axes.get_title(loc="left") for axes in figure.axes[:2]] == ["KB, mean 0.0104", "KB-SR, mean 0.0208"]


def test_maps_of_nothing_say_so(tmp_path):
    """A run may be stopped before the first cell that keeps an array."""
    figure = mapped(tmp_path, MAPS, {})
    assert [text.get_text() for axes in figure.axes for text in axes.texts] == ["nothing measured"]


def test_maps_have_rows_by_label_and_columns_by_x(tmp_path):
    arrays = {(label, k): {"error": np.full((4, 4), k / 32)} for label in ("A", "B") for k in (4, 8)}
    figure = mapped(tmp_path, MAPS, arrays)
    places = {axes.get_title(loc="left").partition(", mean")[0]: axes.get_position() for axes in figure.axes
              if axes.images}
    assert list(places) == ["A, k = 4", "A, k = 8", "B, k = 4", "B, k = 8"]
    assert places["A, k = 4"].y0 == places["A, k = 8"].y0 > places["B, k = 4"].y0
    assert places["A, k = 4"].x0 == places["B, k = 4"].x0 < places["A, k = 8"].x0


def test_an_image_is_shown_over_a_checkerboard(tmp_path):
    image = np.zeros((32, 32, 4), dtype=np.uint8)
    image[:16] = (255, 0, 0, 255)
    figure = mapped(tmp_path, MAPS | {"y": "image"}, {("KB", 8): {"image": image}})
    shown = figure.axes[0].images[0].get_array()
    assert shown[0, 0].tolist() == [1, 0, 0] and len(np.unique(shown[16:].reshape(-1, 3), axis=0)) == 2


def test_a_cell_without_its_array_says_so(tmp_path):
    figure = mapped(tmp_path, MAPS, {("KB", 8): {"error": np.ones((4, 4))}, ("KB-SR", 8): {}})
    assert "error not measured" in texts_of(figure.axes[1])


def test_shares_of_discarded_fragments_stand_in_the_heading(tmp_path):
    figure = mapped(tmp_path, MAPS | {"y": "discarded"}, {("KB", 8): {"discarded": np.full((8, 8), 3)}},
                    values={"fragments": 8 * 8 * 4})
    assert figure.axes[0].get_title(loc="left") == "KB, 75.0 %"


FRAMES = [{"frame": 0, "chosen_k": 8, "histogram": [10, 4, 2, 1]}, {"frame": 1, "chosen_k": 3, "histogram": [9, 8]}]


def histograms(tmp_path, *frames, **options):
    cells = [cell("kplus-sb-dynamic", "dynamic", 4.0, params={"memory_mb": mb}, point={"memory_mb": mb}, frames=f)
             for mb, f in zip((50.0, 200.0), frames, strict=False)]
    return built(tmp_path, cells, {"kind": "histogram", "x": "memory_mb", "log": "y", "log_base": 2} | options,
                 sweep={"memory_mb": [50.0, 200.0][:len(frames)]})


def test_a_histogram_counts_pixels_and_marks_the_chosen_k(tmp_path):
    one, other = [FRAMES[0]], [FRAMES[0] | {"chosen_k": 12}]
    axes, = histograms(tmp_path, one, other).axes
    assert [p.get_height() for p in axes.patches] == [4, 2, 1] and axes.get_yscale() == "log"
    assert texts_of(axes) == ["k = 8 by M_b 50", "k = 12 by M_b 200"]


def test_an_animation_has_a_panel_for_each_frame(tmp_path):
    figure = histograms(tmp_path, FRAMES)
    assert [axes.get_title(loc="left") for axes in figure.axes] == ["frame 0", "frame 1"]
    assert [texts_of(axes)[0] for axes in figure.axes] == ["k = 8", "k = 3"]


@pytest.mark.parametrize("frames", [None, [], [{"histogram": []}], [{"histogram": [1, -2]}]], ids=str)
def test_a_histogram_that_is_none_is_named(tmp_path, frames):
    figure = histograms(tmp_path, frames)
    assert "nothing measured" in texts_of(figure.axes[0])
    assert any("No histogram of dynamic" in text for text in all_texts(figure))


@pytest.mark.parametrize("options", [MAPS, MAPS | {"y": "image"}])
def test_maps_are_the_same_bytes_each_time(tmp_path, options):
    rng = np.random.default_rng(1)
    arrays = {("KB", 8): {"error": rng.random((64, 64)), "image": rng.integers(0, 255, (64, 64, 4))}}
    first = figures.render(mapped(tmp_path / "a", options, arrays))
    assert first == figures.render(mapped(tmp_path / "b", options, arrays))


# --- results that are not whole --------------------------------------------------------------------


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


@pytest.mark.parametrize("options", [*KINDS, MAPS, {"kind": "histogram", "x": "k"}], ids=lambda o: o["kind"])
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


# --- several devices -----------------------------------------------------------------------------


def test_devices_stand_side_by_side(tmp_path):
    devices = [planted.DEVICE, planted.DEVICE | {"slug": "h200", "renderer": "NVIDIA H200", "version": "4.6"}]
    folders = [planted.folder(tmp_path / d["slug"], [c | {"device": d} for c in two_methods()], [STACKED], device=d)
               for d in devices]
    written = figures.write_together(folders, tmp_path / "out")
    assert [path.name for path in written] == ["planted.png", "planted.svg"]
    joined = data.join([data.load(f) for f in folders])
    figure = figures.build(joined, STACKED | {"panels": "device"})
    assert [axes.get_title(loc="left") for axes in figure.axes] == ["device = llvmpipe", "device = h200"]
    assert "NVIDIA H200" in " ".join(all_texts(figure)) and "llvmpipe" in " ".join(all_texts(figure))


def test_an_experiment_of_one_folder_is_not_drawn_together(tmp_path):
    folders = [planted.folder(tmp_path / name, two_methods(), [STACKED], name=name) for name in ("a", "b")]
    assert figures.write_together(folders, tmp_path / "out") == []
