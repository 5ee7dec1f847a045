"""Frontiers of planted cells: what beats what, and what figures and tables say of it."""

from itertools import combinations, pairwise

import pytest
from matplotlib.text import Text
from matplotlib.transforms import Bbox

from mfr_bench.report import data, figures, frontier
from mfr_bench.report.figures.kind import NothingToDraw

from . import planted

FIGURE = {"kind": "pareto", "x": "time_ms", "y": "rmse", "log": "xy"}


def point(label, time_ms, rmse, memory_mib=1.0, **more):
    values = {"rmse": rmse, "flip": 10 * rmse, "max_error_all": 5 * rmse, "memory_bytes": int(memory_mib * 2**20)}
    return planted.cell(label.split()[0].lower(), label, time_ms, values=values, **more)


CELLS = [point("Cheap", 1, 0.1), point("Middle", 2, 0.01, 4.0), point("Exact", 8, 3e-8, 2.0),
         point("Beaten", 4, 0.02, 4.0), point("AlsoExact", 9, 1e-8, 0.5), point("Tied", 8, 5e-8, 2.0),
         planted.cell("floor", "floor", 0.5, values={"rmse": None, "max_abs_error": None}),
         point("Wrong", 0.1, 1e-9, status="wrong"), planted.cell("none", "None", None, status="unsupported")]


def load(tmp_path, cells=None, **more):
    return data.load(planted.folder(tmp_path / "r", CELLS if cells is None else cells, [FIGURE], **more))


def labels(points):
    return [p.label for p in points]


def test_a_frontier_holds_what_nothing_beats(tmp_path):
    """Errors of rounding are equal: of exact methods the cheapest; what is wrong or no image is on none."""
    place, = frontier.places(load(tmp_path))
    assert labels(place.frontier("time_ms", "rmse")) == ["Cheap", "Middle", "Exact"]
    assert labels(place.frontier("memory_mib", "rmse")) == ["AlsoExact"]


def test_each_scene_has_its_own(tmp_path):
    deep = {"depth_complexity": 64, "alpha": [0.5, 0.9]}
    cells = [*CELLS, point("Cheap", 3, 0.3, scene=deep), point("Exact", 2, 1e-8, scene=deep)]
    shallow, deeper = frontier.places(load(tmp_path, cells))
    assert labels(deeper.frontier("time_ms", "rmse")) == ["Exact"]
    assert len(shallow.points) == 6
    assert "n = 64" in deeper.name
    assert "opacity 0.5–0.9" in deeper.name


def test_one_label_is_told_apart_by_what_was_swept(tmp_path):
    cells = [point("Kb", k, 1 / k, params={"k": k}, point={"k": k}) for k in (2, 8)]
    place, = frontier.places(load(tmp_path, cells, sweep={"k": [2, 8]}))
    assert labels(place.frontier("time_ms", "rmse")) == ["Kb, k 2", "Kb, k 8"]


def test_tables_name_the_fastest_and_the_most_accurate(tmp_path):
    on, fastest, closest = frontier.tables(load(tmp_path), "rmse")
    assert [row[:2] for row in on[3]] == [("Cheap", "time"), ("Middle", "time"), ("Exact", "time"),
                                          ("AlsoExact", "memory")]
    assert dict(fastest[3]) == {"0.1": "Cheap: 1.00", "0.03": "Middle: 2.00", "0.01": "Middle: 2.00",
                                "0.003": "Exact: 8.00 ≈"}
    assert dict(closest[3]) == {"1": "Cheap: 0.100", "2": "Middle: 0.0100", "5": "Middle: 0.0100",
                                "10": "Exact: 3e-08"}


@pytest.mark.parametrize(("time_ms", "alike"), [(2.01, True), (3.0, False)])
def test_the_fastest_is_marked_where_the_next_may_be_as_fast(tmp_path, time_ms, alike):
    _, fastest, _ = frontier.tables(load(tmp_path, [point("First", 2, 0.01), point("Next", time_ms, 0.01)]), "rmse")
    assert fastest[3][0][1] == ("First: 2.00 ≈" if alike else "First: 2.00")


def drawn(axes):
    """The places of a figure's points: those on no frontier together, those on one each by itself."""
    alone = [(line.get_xdata()[0], line.get_ydata()[0]) for line in axes.lines if line.get_marker() != "None"]
    return [*alone, *(tuple(place) for found in axes.collections for place in found.get_offsets() if found.get_paths()
                      and not hasattr(found, "get_segments"))]


def test_nothing_measured_is_no_mistake(tmp_path):
    empty = load(tmp_path, [])
    assert frontier.tables(empty, "rmse") == []
    with pytest.raises(NothingToDraw, match="no cell was measured"):
        figures.build(empty, FIGURE)


def test_a_frontier_is_that_of_the_figure_s_methods(tmp_path):
    """Those that the config leaves out of it beat none of them."""
    result = load(tmp_path)
    figure = figures.build(result, {**FIGURE, "methods": ["Beaten", "Exact"]})
    axes, = figure.axes
    assert "Solid: no cell of these methods is both cheaper" in " ".join(figure.texts[1].get_text().split())
    assert sorted(line.get_label() for line in axes.lines if line.get_marker() != "None") == ["Beaten", "Exact"]
    with pytest.raises(NothingToDraw, match="no cell has both memory_bytes and rmse"):
        figures.build(result, {**FIGURE, "x": "memory_bytes", "methods": ["None"]})
    with pytest.raises(NothingToDraw, match="no cell is of a method of this figure: Other"):
        figures.build(result, {**FIGURE, "methods": ["Other"]})


@pytest.mark.parametrize("x", ["time_ms", "memory_bytes"])
@pytest.mark.parametrize("y", ["rmse", "flip", "max_error_all"])
def test_the_figure_shows_every_cell_and_names_the_frontier(tmp_path, x, y):
    result = load(tmp_path)
    figure = figures.build(result, {**FIGURE, "x": x, "y": y})
    axes, = figure.axes
    assert axes.get_xscale() == axes.get_yscale() == "log"
    assert len(drawn(axes)) == 6
    named = [text.get_text() for text in figure.legends[0].get_texts()]
    expected = ["AlsoExact"] if x == "memory_bytes" else ["Cheap", "Middle", "Exact"]
    assert named == [*expected, "on no frontier"]


def test_points_on_no_frontier_have_a_number_that_the_small_print_names(tmp_path):
    """A hollow mark in the colour of a method says neither which variant it is nor which k."""
    figure = figures.build(load(tmp_path, [point("Best", 0.5, 1e-8), *(
        point(label, 2.0 + k / 8, 0.1 / k, params={"k": k}, point={"k": k}) for label in ("Kb", "Mlab (16-bit floats)")
        for k in (2, 8))], sweep={"k": [2, 8]}), FIGURE)
    assert sorted(text.get_text() for text in figure.axes[0].texts) == ["1", "2", "3", "4", "Best"]
    said = " ".join(figure.texts[1].get_text().split())
    assert "On no frontier, by number where there is room: 1–2 Kb, k 2, 8; 3–4 Mlab (16-bit floats), k 2, 8." in said


def test_names_and_numbers_hide_neither_each_other_nor_a_mark(tmp_path):
    many = [point(f"M{i}", 1.0 + 0.02 * i, 0.01 * (1 + i % 3)) for i in range(40)]
    figure = figures.build(load(tmp_path, many), FIGURE)
    axes, = figure.axes
    figure.canvas.draw()
    renderer = figure.canvas.get_renderer()
    boxes = [text.get_window_extent(renderer) for text in axes.texts]
    assert len(boxes) > 25
    for one, other in combinations(boxes, 2):
        assert Bbox.intersection(one, other) is None or not min(Bbox.intersection(one, other).size) > 2
    whole = axes.get_window_extent(renderer)
    assert all(whole.x0 - 1 <= box.x0 and box.x1 <= whole.x1 + 1 for box in boxes)


@pytest.mark.parametrize("apart", [1.05, 1.2, 2.0])
def test_no_name_or_number_stands_on_the_frontier(tmp_path, apart):
    """Names are longer than its steps, and other points lie close above it."""
    on = [point(f"On the frontier {i}", apart**i, 10.0**-i) for i in range(6)]
    others = [point(f"M{i}", 1.02 * apart**i, 1.1 * 10.0**-i) for i in range(6)]
    figure = figures.build(load(tmp_path, [*on, *others]), FIGURE)
    axes, = figure.axes
    figure.canvas.draw()
    renderer = figure.canvas.get_renderer()
    steps, = (line for line in axes.lines if line.get_drawstyle() == "steps-post")
    corners = axes.transData.transform([corner for (x, y), (right, below) in pairwise(steps.get_xydata())
                                        for corner in ((x, y), (right, y), (right, below))])
    assert len(corners) == 15 and len(axes.texts) > 6
    for text in axes.texts:
        left, bottom, right, top = Text.get_window_extent(text, renderer).padded(-1).extents
        assert not any(min(a[0], b[0]) < right and max(a[0], b[0]) > left and min(a[1], b[1]) < top
                       and max(a[1], b[1]) > bottom for a, b in pairwise(corners)), text.get_text()


def test_an_error_of_0_is_drawn_and_said(tmp_path):
    result = load(tmp_path, [point("Zero", 1, 0.0), point("Some", 0.5, 0.1)])
    figure = figures.build(result, FIGURE)
    assert any("An error of 0 is drawn at 1e-09" in text.get_text() for text in figure.texts)
    assert min(y for _, y in drawn(figure.axes[0])) == 1e-9
