"""Fits and gains of lines, and cells without memory."""

from __future__ import annotations

import pytest

from mfr_bench.report import style

from .drawing import (
    all_texts,
    built,
    curves,
    texts_of,
    two_methods,
)
from .planted import cell


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


@pytest.mark.parametrize("log", ["", "y", "xy"])
def test_equations_cover_no_data(tmp_path, log):
    methods = ("kb", "kb-ps", "kplus-array", "ab-ll", "ab-sb")
    cells = [cell(method, method, 9 - i + 0.01 * n, scene={"depth_complexity": n}, point={"scene.depth_complexity": n})
             for i, method in enumerate(methods) for n in (4, 8, 16, 32)]
    figure = built(tmp_path, cells, {"kind": "lines", "x": "depth_complexity", "fit": "linear", "log": log})
    figure.canvas.draw()
    axes, = figure.axes
    equations = [t for t in axes.texts if "R²" in t.get_text()]
    lowest = min(t.get_window_extent().y0 for t in equations)
    highest = max(axes.transData.transform(line.get_xydata())[:, 1].max() for line in curves(axes).values())
    assert len(equations) == len(methods) and highest < lowest
