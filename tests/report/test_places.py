"""The table of methods whose place changes along the axis of a figure."""

import pytest

from mfr_bench.report.tables import terminal_table

from .planted import cell, folder

TIMES = {"peel-f2b": (3.0, 8.0), "ab-array": (4.0, 4.0), "ab-ll": (6.0, 6.0), "kb-ps": (9.0, 9.0)}


@pytest.fixture
def table(tmp_path):
    def made(times=TIMES, places=True):
        cells = [cell(method, time_ms=ms, scene={"shading": steps} if steps else {}, point={"scene.shading": steps})
                 for method, both in times.items() for steps, ms in zip((0, 64), both, strict=True)]
        figure = {"kind": "lines", "x": "scene.shading", "y": "time_ms", "places": places}
        return terminal_table(folder(tmp_path / "r", cells, [figure], {"scene.shading": [0, 64]}))
    return made


def test_it_lists_who_overtakes_whom_and_nobody_else(table):
    lines = table().partition("Places that change")[2].splitlines()
    rows = [line.split() for line in lines if line.startswith(tuple(TIMES))][:3]
    assert rows == [["peel-f2b", "1", "3", "ab-array,", "ab-ll"], ["ab-array", "2", "1", "peel-f2b"],
                    ["ab-ll", "3", "2", "peel-f2b"]]


def test_what_noise_explains_is_no_change(table):
    assert "Places that change" not in table({"peel-f2b": (4.0, 4.001), "ab-array": (4.001, 4.0)})


def test_only_a_figure_that_asks_has_it(table):
    assert "Places that change" not in table(places=False)
