"""The first level that breaks a method is found, whatever breaks it, and none where nothing does."""

import pytest

from mfr_bench.report import breaking, breaking_text, data, write_figures
from mfr_bench.report.figures.kinds import DRAW
from mfr_bench.report.figures.sheet import styled

from .planted import cell, folder

AXIS = "scene.depth_gap_log2"
LEVELS = (-4, -12, -24)
GOOD = {"max_abs_error": 1e-7, "error_bound": 1e-6, "lost_fragments": 0}


def ladder_of(tmp_path, *states, levels=LEVELS):
    """The ladder of one method whose cells have these statuses and values, along the levels."""
    cells = []
    for level, (status, values) in zip(levels, states, strict=True):
        measured = status in ("ok", "wrong")
        cells.append(cell("kb-mdt32", time_ms=5.0 if measured else None, status=status,
                          reason=None if status == "ok" else "because", scene={"depth_gap_log2": level},
                          point={AXIS: level}, values=GOOD | values if measured else {}))
    result = data.load(folder(tmp_path, cells, sweep={AXIS: list(levels)}))
    (found,) = breaking.ladders(result, result.points, AXIS, None)
    return found


OK = ("ok", {})


@pytest.mark.parametrize(("fault", "state"), [
    (("wrong", {"max_abs_error": 0.3}), "image"),
    (("wrong", {"lost_fragments": 3}), "lost"),
    (("ok", {"lost_fragments": 1}), "lost"),
    (("ok", {"max_abs_error": 2e-6}), "bound"),
    (("ok", {"max_abs_error": 2e-4, "error_bound": None}), "differs"),
    (("crashed", {}), "crashed"), (("out_of_memory", {}), "crashed"), (("timeout", {}), "hung"),
    (("unsupported", {}), "refused"), (("over_budget", {}), "refused"), (("overflow", {}), "refused"),
])
@pytest.mark.parametrize("at", [0, 1, 2])
def test_the_first_level_that_breaks_is_found(tmp_path, fault, state, at):
    found = ladder_of(tmp_path, *(OK if i < at else fault for i in range(3)))
    level, point = found.first
    assert (level, breaking.state(point)) == (LEVELS[at], state)
    assert breaking.first_break(found).startswith(f"{LEVELS[at]}: {state}, ")


def test_a_method_that_holds_breaks_nowhere(tmp_path):
    found = ladder_of(tmp_path, OK, ("ok", {"max_abs_error": 9e-7}), OK)
    assert found.first is None
    assert breaking.first_break(found) == "holds up to -24"
    assert found.worst.row["max_abs_error"] == 9e-7


@pytest.mark.parametrize(("states", "said"), [
    ((OK, None, None), "holds up to -4 (of 3 levels 2 not measured)"),
    ((OK, None, OK), "holds up to -24 (of 3 levels 1 not measured)"),
    ((None, ("ok", {"lost_fragments": 1}), None), "-12: lost, 1 fragments (1 milder not measured)"),
    ((("ok", {"lost_fragments": 1}), None, None), "-4: lost, 1 fragments")])
def test_levels_that_no_time_was_left_for_are_told(tmp_path, states, said):
    """A method "holds up to 4096" where the levels between had not been measured."""
    cells = [cell("kb-mdt32", scene={"depth_gap_log2": level}, point={AXIS: level}, values=GOOD | state[1])
             for level, state in zip(LEVELS, states, strict=True) if state]
    made = folder(tmp_path, cells, [{"kind": "breaking", "x": AXIS}], sweep={AXIS: list(LEVELS)})
    missing = states.count(None)
    made.write_manifest(made.manifest() | {"cells": [*made.manifest()["cells"], *map(str, range(missing))],
                                           "left_out": {"KB": missing}})
    result = data.load(made)
    (found,) = breaking.ladders(result, result.points, AXIS, None)
    assert breaking.first_break(found) == said
    assert "no record yet, left out for the time budget" in " ".join(breaking_text(made, 60).split())


def test_an_approximate_method_within_the_limit_holds(tmp_path):
    assert ladder_of(tmp_path, *[("ok", {"max_abs_error": 9e-5, "error_bound": None})] * 3).first is None


def test_levels_keep_the_order_of_the_config(tmp_path):
    """From mild to harsh is not always upwards: here the smallest number is the harshest."""
    found = ladder_of(tmp_path, OK, ("wrong", {"max_abs_error": 1.0}), OK)
    assert list(found.points) == list(LEVELS)
    assert found.first[0] == -12
    text = ladder_of(tmp_path / "b", OK, OK, ("wrong", {"max_abs_error": 1.0}), levels=("none", "zero", "nan"))
    assert text.first[0] == "nan"


@pytest.mark.parametrize(("status", "values", "state", "said"), [
    ("ok", {"order_error": 0.3}, "ties", "0.30 from the order of submission"),
    ("ok", {"order_error": 1e-6}, "holds", None),
    ("wrong", {"order_error": 0.3, "max_abs_error": 0.2}, "image", "error 0.20"),
    ("ok", {"order_error": 0.3, "max_abs_error": 2e-6}, "bound", "error 2e-06"),
    ("ok", {"order_error": 0.3, "max_abs_error": 0.2, "error_bound": None}, "differs", "error 0.20"),
])
def test_another_order_of_equal_depths_is_no_loss(tmp_path, status, values, state, said):
    made = cell("ab-ll", status=status, reason="because", values=GOOD | values)
    (point,) = data.load(folder(tmp_path, [made])).points
    assert breaking.state(point) == state
    assert said is None or breaking.detail(point) == said


def test_panels_are_told_apart(tmp_path):
    cells = [cell("ab-ll", "A", scene={"depth_at": at, "depth_gap_log2": gap},
                  point={"scene.depth_at": at, AXIS: gap},
                  status="wrong" if at and gap == -12 else "ok", values=GOOD | {"max_abs_error": 0.5 * bool(at)})
             for at in (0, 1) for gap in LEVELS[:2]]
    made = folder(tmp_path, cells, figures=[{"kind": "breaking", "x": AXIS, "panels": "scene.depth_at"}],
                  sweep={"scene.depth_at": [0, 1], AXIS: [-4, -12]})
    text = breaking_text(made)
    assert "holds up to -12" in text
    assert "-4: bound, error 0.50" in text
    written = write_figures(made)
    assert any(path.suffix == ".png" and path.stat().st_size > 1000 for path in written)
    assert write_figures(made)


def test_every_status_has_a_state():
    from mfr_bench.store import STATUSES

    assert {name for name, status in STATUSES.items() if not status.breaks} == {"ok", "wrong"}
    assert {status.breaks for status in STATUSES.values()} - {""} < set(breaking.FAULTS)


def test_long_names_of_levels_stand_above_the_small_print(tmp_path):
    names = [f"meshes/a-mesh-with-a-long-name-{i}.obj" for i in range(12)]
    cells = [cell("ab-array", time_ms=1.0, scene={"file": name}, point={"scene.file": name}) for name in names]
    made = folder(tmp_path, cells, figures=[{"kind": "breaking", "x": "scene.file"}], sweep={"scene.file": names})
    with styled():
        figure = DRAW["breaking"](data.load(made), {"kind": "breaking", "x": "scene.file"})
        figure.canvas.draw()
        small = max(text.get_window_extent().y1 for text in figure.texts if "Scene" in text.get_text())
        (axes,) = figure.axes
        assert all(label.get_window_extent().y0 > small for label in (*axes.get_xticklabels(), axes.xaxis.label))
