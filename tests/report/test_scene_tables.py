"""Figures over scenes: the ratio to the best other method, and where the work goes."""

import pytest

from mfr_bench.errors import StoreError
from mfr_bench.report.data import load
from mfr_bench.report.figures import build
from mfr_bench.report.figures.kind import NothingToDraw
from mfr_bench.report.figures.kinds.heat import Heat
from mfr_bench.report.figures.kinds.work import totals

from . import planted

HEAT = {"kind": "heat", "x": "depth_complexity", "rows": "pixel_density", "y": "best_ratio", "methods": ["adaptive"]}
WORK = {"store": {"rasterized": 40, "invocations": 30, "stored": 20, "atomics": 20, "words_written": 60},
        "resolve": {"rasterized": 0, "invocations": 100, "loaded": 20, "moved": 7, "empty": 90, "words_read": 50}}


def cells(times, n, density=1.0, **parts):
    scene = {"depth_complexity": n, "pixel_density": density}
    point = {"scene.depth_complexity": n, "scene.pixel_density": density}
    return [planted.cell(method, time_ms=ms, scene=scene, point=point, **parts) for method, ms in times.items()]


def built(tmp_path, made, options):
    folder = planted.folder(tmp_path, made, [options], sweep={"scene.depth_complexity": [1, 8]})
    return build(load(folder), options)


def texts(figure):
    return {text.get_text() for axes in figure.axes for text in axes.texts}


def test_the_fastest_other_method_is_what_counts_in_each_scene(tmp_path):
    made = [*cells({"adaptive": 2.0, "ab-sb": 4.0, "ab-ll": 5.0, "floor": 1.0}, 1),
            *cells({"adaptive": 6.0, "ab-sb": 8.0, "ab-ll": 5.0, "floor": 1.0}, 8)]
    figure = built(tmp_path, made, HEAT)
    assert texts(figure) >= {"0.50", "1.20"}
    said = " ".join(text.get_text() for text in figure.texts)
    assert "below 1 in 1 of 2 scenes" in said.replace("\n", " ") and "above 1.1 in 1" in said.replace("\n", " ")


def test_a_wrong_image_is_no_rival_and_has_no_ratio(tmp_path):
    made = [*cells({"adaptive": 2.0, "ab-sb": 4.0}, 1), *cells({"ab-ll": 1.0}, 1, status="wrong"),
            *cells({"adaptive": 3.0}, 8, status="wrong"), *cells({"ab-sb": 3.0}, 8)]
    chart = Heat(load(planted.folder(tmp_path, made)), HEAT)
    assert list(chart.values.values()) == [pytest.approx(0.5)]


def test_the_ratio_to_the_floor_can_be_drawn_instead(tmp_path):
    made = [*cells({"adaptive": 3.0, "floor": 1.0}, 1), *cells({"adaptive": 8.0, "floor": 2.0}, 8)]
    assert texts(built(tmp_path, made, HEAT | {"y": "floor_ratio"})) >= {"3.00", "4.00"}


def test_a_panel_for_each_value_of_other_axes(tmp_path):
    made = [cell for order in ("random", "front_to_back") for n in (1, 8)
            for cell in (planted.cell(method, time_ms=1.0, scene={"depth_complexity": n, "order": order},
                                      point={"scene.depth_complexity": n, "scene.order": order})
                         for method in ("adaptive", "ab-sb"))]
    assert [axes.get_title(loc="left") for axes in built(tmp_path, made, HEAT).axes] == [
        "order random", "order front_to_back"]


def test_a_panel_tells_only_what_is_not_as_in_most(tmp_path):
    scenes = [("random", 0.5), ("random", 0.2), ("front_to_back", 0.5), ("random", 0.5)]
    made = [planted.cell(method, time_ms=1.0, scene={"depth_complexity": n, "order": order, "slant": slant},
                         point={"scene.depth_complexity": n, "scene.order": order, "scene.slant": slant})
            for n, (order, slant) in enumerate(scenes, 1) for method in ("adaptive", "ab-sb")]
    assert [axes.get_title(loc="left") for axes in built(tmp_path, made, HEAT).axes] == [
        "order random, slant 0.5", "slant 0.2", "order front_to_back"]


def test_rows_are_asked_for(tmp_path):
    with pytest.raises(StoreError, match="rows: missing"):
        built(tmp_path, cells({"adaptive": 1.0}, 1), HEAT | {"rows": None})


def test_work_adds_up_by_kind():
    assert totals(WORK) == {"stored": 20, "loaded": 20, "moved": 7, "atomics": 20, "empty": 90, "geometry": 30,
                            "pixels": 100, "words": 110}


def test_work_against_the_limits_of_the_device(tmp_path):
    """440 bytes at 1 MB/s are 0.44 ms of 2 ms; 130 shaded at 1e6 a second 0.13 ms."""
    made = cells({"adaptive": 2.0}, 1, work=WORK)
    folder = planted.folder(tmp_path, made, calibration={"rates": {"copy_bytes_per_s": 1e6, "fill_pixels_per_s": 1e6}})
    counts, limits = build(load(folder), {"kind": "work", "x": "depth_complexity"}).axes
    drawn = {line.get_label(): line.get_xdata()[0] for line in counts.lines}
    assert drawn["fragments shaded"] == 30 and drawn["words read and written"] == 110
    assert {text.get_text() for text in limits.texts} == {"22.0 %", "6.50 %"}


def test_work_says_what_to_ask_for_where_nothing_was_counted(tmp_path):
    with pytest.raises(NothingToDraw, match=r"no cell has counted its work, as measure\.counters asks for"):
        built(tmp_path, cells({"adaptive": 2.0}, 1), {"kind": "work", "x": "depth_complexity"})
