"""What a reader must see in a figure: words that are whole, ticks that give a scale, reasons, lines that are hidden."""

from __future__ import annotations

import pytest
from matplotlib import colors

from mfr_bench.report import data, figures, style
from mfr_bench.report.figures.sheet import fitted

from . import planted
from .drawing import LINES, all_texts, built, curves, texts_of
from .planted import cell

BARS = {"kind": "bars", "x": "k", "y": "time_ms"}


def small_print(figure):
    return " ".join(figure.texts[1].get_text().split())


def boxes(figure, wanted):
    renderer = figure.canvas.get_renderer()
    figure.canvas.draw()
    return {t.get_text(): t.get_window_extent(renderer) for axes in figure.axes for t in axes.texts
            if t.get_text() in wanted}


def test_a_value_stays_on_the_line_of_its_name():
    lines = fitted("Scene: pixel density p_d = 0.25 … 0.75 (covered)", 7.0, 1.9)
    assert len(lines) > 1 and any("p_d = 0.25 … 0.75" in line for line in lines)
    assert fitted("a = 123456789012345678901234567890", 7.0, 0.5)[0] == "a ="  # wider than a line: broken all the same


def test_a_long_name_of_x_is_within_the_figure(tmp_path):
    """'depth copies' before the groups lost its first letter at the left edge."""
    cells = [cell("kb", "KB", 2.0, scene={"depth_copies": v}, point={"scene.depth_copies": v}) for v in range(1, 13)]
    figure = built(tmp_path, cells, BARS | {"x": "depth_copies"})
    assert boxes(figure, ["depth copies"])["depth copies"].x0 >= 0


def test_the_name_of_x_is_clear_of_the_highest_tick(tmp_path):
    cells = [cell("kb", "KB", 2.0, scene={"effect": v}, point={"scene.effect": v})
             for v in ("transparency", "translucency", "collision", "thickness", "layers", "csg", "coplanar")]
    figure = built(tmp_path, cells, BARS | {"x": "effect"})
    axes, = figure.axes
    axes.set_yticks([axes.get_ylim()[1]])
    name, = (t for t in axes.texts if t.get_text() == "effect")
    figure.canvas.draw()
    renderer = figure.canvas.get_renderer()
    tick = axes.get_yticklabels()[0].get_window_extent(renderer)
    assert name.get_window_extent(renderer).y0 >= tick.y1 - 1


def test_a_logarithmic_axis_has_two_ticks_at_least(tmp_path):
    """From 0.21 to 9.2 there is one power of ten."""
    cells = [cell(m, m, ms, params={"k": 4}, point={"k": 4}) for m, ms in (("ab-ll", 0.5), ("mlab", 4.2))]
    figure = built(tmp_path, cells, BARS | {"log": "y"})
    axes, = figure.axes
    axes.set_ylim(0.2, 9.2)
    from mfr_bench.report.figures.scales import log_axis
    log_axis(axes, "y", 10)
    assert [v for v in axes.get_yticks() if 0.2 <= v <= 9.2] == pytest.approx([0.2, 0.5, 1, 2, 5])


def test_a_label_longer_than_the_axis_is_broken(tmp_path):
    text = "share of the fragments not kept that is discarded before the lock of the pixel"
    cells = [cell("kb", "KB", 2.0, params={"k": 4}, point={"k": 4})]
    figure = built(tmp_path, cells, BARS | {"y_label": text})
    axes, = figure.axes
    assert axes.get_ylabel().replace("\n", " ") == text and "\n" in axes.get_ylabel()
    figure.canvas.draw()
    box = axes.yaxis.label.get_window_extent(figure.canvas.get_renderer())
    assert box.height <= axes.bbox.height * 1.02


def test_a_printed_mark_does_not_cover_the_words_below_it(tmp_path):
    source = {"paper": "kplus2015", "figure": "Table 1", "prints": ["words_per_pixel"]}
    cells = [cell("kplus-array", "K+B-Array", 4.0, params={"k": 8}, point={"k": 8},
                  values={"memory_bytes": 54 * 4 * 64 * 64, "max_fragments": 32, "fragments": 131072}),
             cell("kb-mdt64", "KB-MDT_64", None, status="unsupported", reason="needs shader_atomic_int64",
                  params={"k": 8}, point={"k": 8}, values={"max_fragments": 32, "fragments": 131072})]
    figure = built(tmp_path, cells, BARS | {"y": "words_per_pixel", "printed": "words_per_pixel"}, source=source)
    axes, = figure.axes
    figure.canvas.draw()
    word = boxes(figure, ["unsupported"])["unsupported"]
    marks = [line for line in axes.lines if line.get_marker() == "D"]
    assert len(marks) == 2
    for line in marks:
        x, y = axes.transData.transform((line.get_xdata()[0], line.get_ydata()[0]))
        assert not (word.x0 <= x <= word.x1 and word.y0 - 2 <= y <= word.y1 + 2)


def test_what_a_device_lacks_is_said_beside_the_figure(tmp_path):
    cells = [cell("kb", "KB", 2.0, params={"k": 4}, point={"k": 4}),
             *(cell("kb-mdt64", "KB-MDT64", None, status="unsupported", reason="needs shader_atomic_int64",
                    params={"k": k}, point={"k": k}) for k in (4, 8))]
    for options in (BARS, LINES | {"x": "k"}):
        assert ("Unsupported: KB-MDT64 (needs shader_atomic_int64)."
                in small_print(built(tmp_path / options["kind"], cells, options)))


def test_a_wrong_image_of_a_method_that_loses_ties_has_that_beside_it(tmp_path):
    cells = [cell(m, m.upper(), 2.0, status="wrong", params={"k": 4}, point={"k": 4}) for m in ("peel-f2b", "ab-ll")]
    said = small_print(built(tmp_path, cells, BARS))
    assert "Wrong image: PEEL-F2B (of fragments of equal depth it keeps one); AB-LL." in said


def test_lines_that_lie_on_each_other_are_named(tmp_path):
    errors = {"kb": 0.4, "kb-ps": 0.4, "kplus-array": 0.4, "kb-ab-array": 0.5}
    cells = [cell(m, m.upper(), 4.0, params={"k": k}, point={"k": k}, values={"rmse": error / k})
             for m, error in errors.items() for k in (2, 4, 8)]
    figure = built(tmp_path, cells, {"kind": "lines", "x": "k", "y": "rmse"})
    assert "On one line: KB, KB-PS, KPLUS-ARRAY." in small_print(figure)
    apart = built(tmp_path / "apart", cells[:3] + cells[9:], {"kind": "lines", "x": "k", "y": "rmse"})
    assert "On one line" not in small_print(apart)


def occupied(value, k, method="kplus-array"):
    return cell(method, method, 4.0 + value, params={"k": k, "occupancy": value}, point={"k": k, "occupancy": value})


def test_four_variants_beside_another_method_have_four_tints(tmp_path):
    cells = [*(occupied(v, k) for v in (0, 32, 64, 128) for k in (4, 8)), occupied(0, 4, "kb-ps")]
    axes, = built(tmp_path, cells, {"kind": "lines", "x": "k", "y": "time_ms"}).axes
    found = {colors.to_hex(line.get_color()) for name, line in curves(axes).items() if "kplus" in name}
    assert len(found) == 4


def test_a_variant_keeps_its_tint_in_a_figure_of_gains(tmp_path):
    cells = [occupied(v, k, m) for m in ("kplus-array", "kplus-heap") for v in (0, 32, 64) for k in (4, 8)]
    folder = planted.folder(tmp_path, cells)
    times, gains = (figures.build(data.load(folder), {"kind": "lines", "x": "k", "y": "time_ms"} | more).axes[0]
                    for more in ({}, {"gain_of": "occupancy"}))
    drawn = {name: line.get_color() for name, line in curves(gains).items()}
    assert len(drawn) == 4 and drawn.items() <= {n: line.get_color() for n, line in curves(times).items()}.items()


def test_a_label_has_no_word_that_tells_nothing_apart(tmp_path):
    """A label names an operation for csg alone: no other effect has any."""
    places = [("transparency", "union"), ("csg", "union"), ("csg", "difference")]
    cells = [cell("ab-ll", "LL", 4.0, scene={"effect": e, "operation": o},
                  point={"scene.effect": e, "scene.operation": o}) for e, o in places]
    axes, = built(tmp_path, cells, BARS | {"x": "width"}).axes
    assert [t.replace("\n", " ") for t in texts_of(axes) if t.startswith("LL")] == [
        "LL, effect transparency", "LL, effect csg, operation union", "LL, effect csg, operation difference"]


@pytest.mark.parametrize(("scene", "words"), [
    ({"layout": "mixed"}, "n = 32 (most fragments of a pixel)"),
    ({"layout": "random"}, "n = 32 (mean fragments per pixel of the block)"),
    ({"kind": "hairball"}, "n = 32 (most fragments of a pixel)"),
    ({"layout": "tiles"}, "n = 32 (fragments per covered pixel)")])
def test_the_scene_says_what_n_counts(tmp_path, scene, words):
    assert words in small_print(built(tmp_path, [cell("kb", "KB", 2.0, scene=scene)], BARS))


def test_the_scene_names_its_file_without_its_folder(tmp_path):
    scene = {"kind": "mesh", "file": "/home/somebody/models/torus.obj"}
    said = small_print(built(tmp_path, [cell("kb", "KB", 2.0, scene=scene)], BARS))
    assert "torus.obj" in said and "somebody" not in said


def test_k_of_an_animation_is_that_of_every_frame(tmp_path):
    frames = [{"frame": i, "histogram": [0, 4, 2], "chosen_k": k} for i, k in enumerate((26, 29, 27))]
    cells = [cell("kplus-array-dynamic", "dynamic", 2.0, params={"memory_mb": 4}, values={"chosen_k": 29},
                  frames=frames)]
    assert "k = 26 … 29" in small_print(built(tmp_path, cells, {"kind": "histogram", "x": "width"}))


def test_symbols_of_what_k_is_chosen_by_are_spelt_out(tmp_path):
    cells = [cell("kplus-array-dynamic", "dynamic", 2.0, params={"memory_mb": m}, point={"memory_mb": m},
                  frames=[{"frame": 0, "histogram": [0, 4, 2], "chosen_k": 2}]) for m in (4, 8)]
    figure = built(tmp_path, cells, {"kind": "histogram", "x": "memory_mb"})
    assert "M_b: memory budget (MiB)." in small_print(figure) and "R_h" not in small_print(figure)
    assert any("M_b 4" in text for text in all_texts(figure))


def test_tints_of_variants_are_seen_on_white():
    for colour in style.FAMILY_COLOURS:
        tints = [style.tint(colour, variant) for variant in range(4)]
        assert len(set(tints)) == 4 and tints[0] == colour
        assert max(map(style.lightness, tints[1:])) <= max(0.8, style.lightness(colour))


def test_a_lone_size_is_no_heading(tmp_path):
    cells = [cell(m, m.upper(), 2.0) for m in ("kb", "kb-ps")]
    axes, = built(tmp_path, cells, BARS | {"x": "width"}).axes
    assert texts_of(axes)[-2:] == ["KB", "KB-PS"] and not any("width" in text for text in texts_of(axes))
