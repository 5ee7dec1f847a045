"""The time left of a run, foretold anew with each cell: of runs that were recorded, and of planted ones."""

import json
from dataclasses import replace
from pathlib import Path

import pytest

from mfr_bench.config.model import Measure, Scene
from mfr_bench.plan import Cell
from mfr_bench.plan.forecast import Forecast, Rates
from mfr_bench.plan.time_left import TimeLeft

RECORDED = sorted(Path(__file__).with_name("recorded").glob("*.json"))
SCENE = Scene(size=(64, 64), depth_complexity=32)
MEASURE = Measure(target_rel_ci=1e-9, min_samples=10, max_samples=100, time_limit_s=1.0)


def cell(method, scene=SCENE, measure=MEASURE, **params):
    return Cell("planted", method, method, params, scene, measure, {})


def row(of, time_ms, fragments, low=None, high=None, samples=10):
    values = {"time_ms": time_ms, "time_ms_low": low or time_ms, "time_ms_high": high or time_ms}
    return {"method": of.method, "params": dict(of.params), "scene": of.scene.as_dict(),
            "values": values | {"fragments": fragments}, "samples_ms": [time_ms] * samples}


def scene_of(record):
    return Scene(**{key: tuple(value) if isinstance(value, list) else value for key, value in record.items()})


def replayed(run):
    """The elapsed time of each event of a recorded run, and the time left then."""
    cells = {key: cell(c["method"], scene_of(c["scene"]), Measure(**c["measure"]), **c["params"])
             for key, c in run["cells"].items()}
    ahead = TimeLeft(Forecast((), Rates(**run["rates"])), cells, run["end_s"])
    yield 0.0, ahead.left_s(0.0)
    for what, elapsed_s, of, *values in run["events"]:
        if what == "hold":
            ahead.hold(of, elapsed_s)
        else:
            time_ms, low, high, fragments, samples = values
            ahead.done(of, row(cells[of], time_ms, fragments, low, high, samples), elapsed_s)
        yield elapsed_s, ahead.left_s(elapsed_s)


@pytest.mark.parametrize("path", RECORDED, ids=lambda p: p.stem)
def test_after_a_fifth_of_a_recorded_run_the_time_left_is_within_a_factor_of_1_5(path):
    run = json.loads(path.read_text())
    fifth_s = run["ended_s"] / 5
    elapsed_s, left_s = [seen for seen in replayed(run) if seen[0] <= fifth_s][-1]
    assert 1 / 1.5 <= (left_s - (fifth_s - elapsed_s)) / (run["ended_s"] - fifth_s) <= 1.5


def test_runs_are_recorded():
    assert RECORDED


def started(cells):
    return TimeLeft(Forecast((), Rates(compile_s=0.1, pixel_s=0, store_s=0)), cells, end_s=0.0)


def test_a_slower_machine_is_learned_from_what_is_done():
    """Every cell takes 5 s, ten times what was foretold."""
    cells = {str(i): cell("a", measure=replace(MEASURE, time_limit_s=0.4), k=i) for i in range(10)}
    ahead = started(cells)
    foretold_s = ahead.left_s(0.0)
    assert foretold_s < 10
    for i in range(5):
        ahead.hold({str(i): 0.0}, 5.0 * i + 0.1)
        ahead.hold({str(i): 1.0}, 5.0 * i + 4.0)
        ahead.done(str(i), row(cells[str(i)], None, 1), 5.0 * (i + 1))
    assert ahead.share == pytest.approx(0.5)
    assert ahead.left_s(25.0) == pytest.approx(25.0, rel=0.3)
    assert ahead.left_s(27.0) == pytest.approx(ahead.left_s(25.0) - 2.0)


def test_a_method_s_larger_scenes_are_foretold_by_its_smaller_ones():
    large = replace(SCENE, depth_complexity=128)
    cells = {"small": cell("a"), "large": cell("a", large), "other": cell("b", large)}
    ahead = started(cells)
    before = dict(ahead._left)
    ahead.done("small", row(cells["small"], 4.0, 64 * 64 * 32), 1.0)
    assert ahead._left["other"] == before["other"]
    assert ahead._left["large"] != before["large"]


def test_what_is_in_hand_counts_by_its_share():
    cells = {name: cell(name) for name in "ab"}
    ahead = started(cells)
    ahead.hold({"a": 0.0, "b": 0.0}, 0.2)
    left = []
    for step in (1, 2, 3):
        ahead.hold({"a": 0.3 * step, "b": 0.3 * step}, 0.2 + step)
        left.append(ahead.left_s(0.2 + step))
    assert left[0] > left[1] > left[2] > 0


def test_a_row_of_no_foretold_cell_changes_nothing():
    ahead = started({"a": cell("a")})
    left_s = ahead.left_s(0.0)
    ahead.done("unsupported", {}, 0.0)
    assert ahead.left_s(0.0) == left_s


def test_a_run_without_cells_has_only_its_end_ahead():
    ahead = TimeLeft(Forecast((), Rates()), {}, end_s=2.0)
    assert (ahead.left_s(0.0), ahead.share) == (2.0, 1.0)
