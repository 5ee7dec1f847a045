"""Bars: what stacks, what is a sign, what is written above; and shares and bytes of them."""

from __future__ import annotations

from itertools import combinations

import pytest

from mfr_bench.report import style

from . import planted
from .drawing import (
    STACKED,
    all_texts,
    bars_of,
    built,
    texts_of,
    two_methods,
    undrawn,
)
from .planted import cell


def test_segments_divide_the_whole_frame_as_the_passes_do(tmp_path):
    """Passes are timed in frames of their own, on a noisy host at a slower time: a stack that rose above the frame."""
    figure = built(tmp_path, two_methods(), STACKED)
    axes, = figure.axes
    found = [(pytest.approx(bottom), pytest.approx(height), label) for bottom, height, label in bars_of(axes)]
    here, there = 10 / 9.5, 5 / 4  # the whole frame over the sum of its passes
    of_one_group = [(0, here, "KB-PS: clear"), (here, 6 * here, "KB-PS: store"), (7 * here, 2.5 * here,
                    "KB-PS: resolve"), (0, 0.5 * there, "K⁺B-SB: clear"), (0.5 * there, 1.5 * there, "K⁺B-SB: count"),
                    (2 * there, 2 * there, "K⁺B-SB: store")]
    assert found == of_one_group * 2
    assert axes.get_yscale() == "log" and axes.get_ylabel() == "time (ms)"
    assert "add up to 0.80 to 0.95 times the whole frame" in " ".join(" ".join(all_texts(figure)).split())


def test_groups_are_headed_and_bars_are_named_in_the_configs_order(tmp_path):
    texts = texts_of(built(tmp_path, two_methods(), STACKED).axes[0])
    assert [t for t in texts if t.startswith("k =")] == ["k = 4", "k = 8"]
    assert [t for t in texts if t in ("KB-PS", "K⁺B-SB")] == ["KB-PS", "K⁺B-SB"] * 2


def test_the_whole_frames_time_is_written_above_the_bar(tmp_path):
    texts = texts_of(built(tmp_path, two_methods(), STACKED).axes[0])
    assert texts.count("10.0") == 2 and texts.count("5.00") == 2


@pytest.mark.parametrize(("options", "count", "heights"), [
    (STACKED, 3, {10.0}), (STACKED | {"kind": "bars"}, 3, {10.0}), (STACKED | {"kind": "bars"}, 10, {5.0, 10.0})])
def test_a_time_that_is_not_the_height_of_its_bar_has_a_line(tmp_path, options, count, heights):
    """Also one of so few samples that it has no interval: else its number would stand in the air."""
    axes, = built(tmp_path, two_methods(count=count), options).axes
    lines = [segment for lines in axes.collections for segment in lines.get_segments()]
    assert {round(left[1], 6) for left, right in lines if left[1] == right[1]} == heights


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


def test_the_shortest_bar_of_a_logarithmic_axis_is_on_it(tmp_path):
    """However much longer the longest is: of 100,000 times as long nothing would be seen of it otherwise."""
    cells = [cell(m, m, ms, params={"k": 4}, point={"k": 4}) for m, ms in (("ab-ll", 0.01), ("mlab", 5000.0))]
    axes, = built(tmp_path, cells, {"kind": "bars", "x": "k", "y": "time_ms", "log": "y"}).axes
    assert axes.get_ylim()[0] == pytest.approx(0.007, rel=0.01)


def test_a_method_that_x_does_not_touch_is_drawn_once(tmp_path):
    cells = [*two_methods(), cell("ab-ll", "AB_LL", 7.0, {"store": 7.0})]
    axes, = built(tmp_path, cells, STACKED).axes
    assert texts_of(axes).count("AB_LL") == 1 and "any k" in texts_of(axes)


def test_an_x_that_nothing_has_heads_no_group(tmp_path):
    """A mesh has no n that its config gives."""
    cells = [cell("ab-ll", "AB_LL", 7.0), cell("ab-sb", "AB_SB", 5.0)]
    axes, = built(tmp_path, cells, {"kind": "bars", "x": "k", "y": "time_ms"}).axes
    assert {patch.get_label() for patch in axes.patches} >= {"AB_LL", "AB_SB"}
    assert not [text for text in texts_of(axes) if text.startswith("any")]


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


def test_shares_stack_to_one(tmp_path):
    axes, = built(tmp_path, two_methods(), {"kind": "stacked_passes", "x": "k", "y": "share"}).axes
    tops = [bottom + height for bottom, height, label in bars_of(axes) if label == "KB-PS: resolve"]
    assert tops == pytest.approx([1, 1])


def test_bytes_are_drawn_as_mib(tmp_path):
    cells = [cell("kb", "KB", 4.0, params={"k": 4}, point={"k": 4}, values={"memory_bytes": 3 * 2**20})]
    axes, = built(tmp_path, cells, {"kind": "bars", "x": "k", "y": "memory_bytes"}).axes
    assert [p.get_height() for p in axes.patches if p.get_label() == "KB"] == [3] and "MiB" in axes.get_ylabel()


@pytest.mark.parametrize("panels", [{}, {"panels": "scene.depth_range"}])
@pytest.mark.parametrize("kind", ["bars", "stacked_passes"])
def test_a_chart_without_cells_is_not_drawn(tmp_path, kind, panels):
    """A run whose time budget ended before any cell of a figure was measured leaves such a chart."""
    assert undrawn(tmp_path, [], {"kind": kind, "x": "k", "y": "time_ms"} | panels) == "no cell was measured"


def test_sorted_bars_stand_from_the_lowest_to_the_highest(tmp_path):
    """Nobody finds the fastest of 45 methods in the catalog's order; those without a time stand last."""
    cells = [cell("kb", "KB", None, status="unsupported", reason="needs x"), *(cell(m, m, ms) for m, ms in (
        ("ab-ll", 3.0), ("ab-array", 1.0), ("wboit", 2.0)))]
    options = {"kind": "bars", "x": "n", "y": "time_ms"}
    texts = texts_of(built(tmp_path / "as-planned", cells, options).axes[0])
    assert [t for t in texts if t in ("KB", "ab-ll", "ab-array", "wboit")] == ["KB", "ab-ll", "ab-array", "wboit"]
    texts = texts_of(built(tmp_path / "sorted", cells, options | {"sorted": True}).axes[0])
    assert [t for t in texts if t in ("KB", "ab-ll", "ab-array", "wboit")] == ["ab-array", "wboit", "ab-ll", "KB"]


def named(axes, start: str) -> int:
    """How many bars have a name that starts so."""
    return sum(text.startswith(start) for text in texts_of(axes))


def test_a_group_of_many_bars_goes_on_in_the_rows_below(tmp_path):
    cells = [cell("ab-array", f"AB {i}", 1.0 + i) for i in range(113)]
    figure = built(tmp_path, cells, {"kind": "bars", "x": "n", "y": "time_ms"})
    assert [named(axes, "AB ") for axes in figure.axes] == [38, 38, 37]
    assert len({axes.get_ylim() for axes in figure.axes}) == 1


@pytest.mark.parametrize(("late", "signs"), [(8, 8), (9, 0)])
def test_of_many_sorted_bars_those_without_a_value_are_counted(tmp_path, late, signs):
    cells = [*(cell("ab-array", f"AB {i}", 1.0 + i) for i in range(40)),
             *(cell("ab-ll", f"LL {i}", None, status="timeout") for i in range(late))]
    figure = built(tmp_path, cells, {"kind": "bars", "x": "n", "y": "time_ms", "sorted": True})
    axes, = figure.axes
    assert (named(axes, "AB "), named(axes, "LL "), named(axes, "timeout")) == (40, signs, signs)
    assert ("Without a bar: 9 timeout." in " ".join(all_texts(figure))) == (not signs)


def test_the_answer_of_a_decision_is_framed_and_told(tmp_path):
    """It is the likeliest to be the fastest, which the least median of few frames need not be."""
    cells = [cell(m, m, ms) for m, ms in (("ab-array", 1.0), ("ab-ll", 1.1))]
    figure = built(tmp_path, cells, {"kind": "bars", "x": "n", "y": "time_ms", "sorted": True},
                   answer={"key": cells[1]["key"], "confidence": 0.734})
    axes, = figure.axes
    assert [t.get_text() for t in axes.texts if t.get_fontweight() == "bold" and t.get_rotation() == 90] == ["ab-ll"]
    frames = [p for p in axes.patches if p.get_facecolor()[3] == 0 and p.get_edgecolor()[3] and not p.get_hatch()]
    assert [round(p.get_x() + p.get_width() / 2) for p in frames] == [1]
    assert "Framed: the answer, ab-ll, the fastest with a chance of 73 %." in " ".join(all_texts(figure))


def test_bars_that_are_alike_in_grey_differ_in_hatching():
    """Whatever stands side by side: any two methods of the catalog, and the variants of one."""
    colours = style.method_colours()
    found = style.hatches({m: m for m in colours}, coloured=True)
    alike = [(a, b) for a, b in combinations(colours, 2)
             if abs(style.lightness(colours[a]) - style.lightness(colours[b])) < style.ALIKE]
    assert len(alike) > 200 and all(found[a] != found[b] for a, b in alike)
    variants = style.hatches({f"KB {i}": "kb" for i in range(len(style.HATCHES))}, coloured=True)
    assert len(set(variants.values())) == len(style.HATCHES)
    assert set(style.hatches({"Z-buffer": "z-buffer", "Adaptive": "adaptive"}, coloured=True).values()) == {""}


def test_a_label_has_one_hatching_in_all_figures_of_a_set(tmp_path):
    """Stacks, whose colours are all alike, have the patterns of bars, of which some need none."""
    cells = planted.sweep(ks=(8,))
    charts = [built(tmp_path / kind, cells, STACKED | {"kind": kind}).axes[0] for kind in ("stacked_passes", "bars")]
    stacked, bars = ({p.get_x(): p.get_hatch() for p in axes.patches if p.get_hatch()} for axes in charts)
    assert len(stacked) == 13 and 1 < len(bars) <= 13
    assert bars.items() <= stacked.items()
