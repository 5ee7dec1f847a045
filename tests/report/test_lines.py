"""Lines: medians and intervals, gaps, levels, panels, looks; and the measures that they may show."""

from __future__ import annotations

import pytest

from mfr_bench.config import columns
from mfr_bench.report import data
from mfr_bench.stats import median_interval

from . import planted
from .drawing import (
    LINES,
    all_texts,
    built,
    curves,
    two_methods,
)
from .planted import cell


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


def test_panels_along_a_zipped_axis_are_its_points(tmp_path):
    """A heading has only those of the values beside that tell panels apart, whatever else is zipped."""
    zipped = {"scene.effect": ["layers", "csg", "csg"], "scene.operation": ["union", "union", "difference"],
              "scene.files": [["file a"], ["file b"], ["file b"]]}
    places = [dict(zip(zipped, values, strict=True)) for values in zip(*zipped.values(), strict=True)]
    cells = [cell("kplus", "K⁺", k, params={"k": k}, scene={n.partition(".")[2]: v for n, v in at.items()},
                  point={"k": k, **at}) for k in (8, 16) for at in places]
    figure = built(tmp_path, cells, {"kind": "lines", "x": "k", "panels": "scene.effect"}, zip=zipped)
    assert [axes.get_title(loc="left") for axes in figure.axes] == [
        "effect = layers", "effect = csg,\noperation = union", "effect = csg,\noperation = difference"]
    assert all(list(curves(axes)) == ["K⁺"] for axes in figure.axes)


def test_a_column_that_goes_along_with_a_zipped_axis_is_drawn_along_it(tmp_path):
    """Fragments by density at two depth complexities: a line of three points in each of two panels, not six of one."""
    zipped = {"scene.depth_complexity": [5, 5, 5, 20, 20, 20],
              "scene.pixel_density": [0.1, 0.3, 0.5, 0.025, 0.075, 0.125]}
    places = [dict(zip(zipped, values, strict=True)) for values in zip(*zipped.values(), strict=True)]
    cells = [cell("lin-post", "POST", n * d, scene={"depth_complexity": n, "pixel_density": d}, point=at,
                  values={"fragments": round(1000 * n * d)})
             for at in places for n, d in [tuple(at.values())]]
    drawn = {"kind": "lines", "x": "fragments", "y": "time_ms", "panels": "depth_complexity"}
    figure = built(tmp_path, cells, drawn, zip=zipped)
    assert [axes.get_title(loc="left") for axes in figure.axes] == ["n = 5", "n = 20"]
    assert [list(curves(axes)["POST"].get_xdata()) for axes in figure.axes] == [[500, 1500, 2500]] * 2


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


def test_what_is_not_drawn_is_named_once_whatever_the_panels_that_lack_it(tmp_path):
    lacking = {("A", 16, 8), ("A", 64, 8), ("B", 16, 8), ("B", 64, 8), ("C", 4, 8)}
    cells = [cell("kb", label, None if (label, k, n) in lacking else 2.0, scene={"depth_complexity": n},
                  params={"k": k}, point={"k": k, "scene.depth_complexity": n},
                  **({"status": "unsupported", "reason": "needs x"} if (label, k, n) in lacking else {}))
             for label in "ABC" for k in (4, 16, 64) for n in ((8,) if label != "C" else (8, 16))]
    texts = " ".join(all_texts(built(tmp_path, cells, LINES | {"panels": "k"}))).replace("\n", " ")
    assert "Not drawn: A, B: unsupported at k = 16, 64; C: unsupported at k = 4, n = 8." in texts


def test_ticks_write_thousands_as_logarithmic_axes_do(tmp_path):
    cells = [cell("kb", "KB", 2.0, scene={"depth_complexity": n}, point={"scene.depth_complexity": n})
             for n in (8, 1024, 24500)]
    axes, = built(tmp_path, cells, LINES).axes
    assert [t.get_text() for t in axes.get_xticklabels()] == ["8", "1,024", "24,500"]
