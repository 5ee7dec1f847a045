"""Maps and histograms: scales, orientation, places, and cells without what they show."""

from __future__ import annotations

import numpy as np
import pytest

from mfr_bench.report import figures

from .drawing import (
    MAPS,
    built,
    mapped,
    texts_of,
    undrawn,
)
from .planted import cell


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
    assert undrawn(tmp_path, MAPS, {}, made=mapped) == "no cell was measured"
    assert undrawn(tmp_path, MAPS, {("KB", 8): {}}, made=mapped) == "no cell keeps the array error"


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


@pytest.mark.parametrize("label", ["KB", "KB with bounds of the geometry in 128 intervals, and more that is said"])
def test_no_heading_is_cut_or_lies_on_the_panel_above(tmp_path, label):
    kept = {(f"{label} {i}", 8): {"discarded": np.full((8, 8), 3)} for i in range(7)}
    figure = mapped(tmp_path, MAPS | {"y": "discarded"}, kept, values={"fragments": 8 * 8 * 4})
    figure.draw_without_rendering()
    panels = [axes for axes in figure.axes if axes.images]
    for i, axes in enumerate(panels):
        assert " ".join(axes.get_title(loc="left").split()) == f"{label} {i}, 75.0 %"
        above = [other for other in panels if other.get_position().y0 > axes.get_position().y1]
        top = axes._left_title.get_window_extent().y1
        assert all(top <= other.get_window_extent().y0 for other in above)


FRAMES = [{"frame": 0, "chosen_k": 8, "histogram": [10, 4, 2, 1]}, {"frame": 1, "chosen_k": 3, "histogram": [9, 8]}]


def histograms(tmp_path, *frames, **options):
    cells = [cell("kplus-sb-dynamic", "dynamic", 4.0, params={"memory_mb": mb}, point={"memory_mb": mb}, frames=f)
             for mb, f in zip((50.0, 200.0), frames, strict=False)]
    return built(tmp_path, cells, {"kind": "histogram", "x": "memory_mb", "log": "y", "log_base": 2} | options,
                 sweep={"memory_mb": [50.0, 200.0][:len(frames)]})


def test_a_histogram_counts_pixels_and_marks_the_chosen_k(tmp_path):
    one, other = [FRAMES[0]], [FRAMES[0] | {"chosen_k": 12}]
    axes, = histograms(tmp_path, one, other).axes
    assert [list(p.get_data().values) for p in axes.patches] == [[4, 2, 1]] and axes.get_yscale() == "log"
    assert texts_of(axes) == ["k = 8 by M_b 50", "k = 12 by M_b 200"]


def test_an_animation_has_a_panel_for_each_frame(tmp_path):
    figure = histograms(tmp_path, FRAMES)
    assert [axes.get_title(loc="left") for axes in figure.axes] == ["frame 0", "frame 1"]
    assert [texts_of(axes)[0] for axes in figure.axes] == ["k = 8", "k = 3"]


@pytest.mark.parametrize("frames", [None, [], [{"histogram": []}], [{"histogram": [1, -2]}]], ids=str)
def test_a_histogram_that_is_none_is_named(tmp_path, frames):
    assert "No histogram of dynamic" in undrawn(tmp_path, frames, made=histograms)


@pytest.mark.parametrize("options", [MAPS, MAPS | {"y": "image"}])
def test_maps_are_the_same_bytes_each_time(tmp_path, options):
    rng = np.random.default_rng(1)
    arrays = {("KB", 8): {"error": rng.random((64, 64)), "image": rng.integers(0, 255, (64, 64, 4))}}
    first = figures.render(mapped(tmp_path / "a", options, arrays))
    assert first == figures.render(mapped(tmp_path / "b", options, arrays))
