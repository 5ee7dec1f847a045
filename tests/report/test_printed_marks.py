"""Printed numbers of papers, as marks and guides among what was measured."""

from __future__ import annotations

import pytest

from .drawing import (
    all_texts,
    built,
)
from .planted import cell

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
