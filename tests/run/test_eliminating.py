"""Elimination within a run: the slow leave early, rows say so, and one that fails costs itself alone."""

import math

import pytest

from mfr_bench.methods import catalog
from mfr_bench.report import data
from mfr_bench.run import measuring
from mfr_bench.store import ResultFolder

from ..cli.conftest import here, mfr, on_device  # noqa: F401  fixtures

CONFIG = """\
name: race
scene: {size: [40, 32], depth_complexity: 24%s}
methods: [ab-array, peel-f2b, wboit, {id: kplus-array, k: 24}, {id: kb-ps, k: 24}]
measure: {eliminate: true, max_samples: 40, time_limit_s: 5, min_samples: 6%s}
"""


@pytest.fixture
def raced(mfr, on_device, here):  # noqa: F811
    def run(more="", scene="", status=0):
        (here / "race.yaml").write_text(CONFIG % (scene, more))
        ended = mfr("run", "race.yaml", "--out", "out")
        assert ended.status == status, ended.err
        return {p.method: p for p in data.load(ResultFolder(here / "out")).points}
    return run


def test_peeling_24_layers_leaves_early_and_its_row_says_to_whom(raced):
    points = raced(", max_error: 0.0001")
    gone = points["peel-f2b"]
    assert gone.status == "ok" and gone.row["stop_reason"].startswith("eliminated after ")
    assert "times the time of" in gone.row["stop_reason"] and gone.row["samples"] < 40
    assert gone.row["max_abs_error"] <= 1e-4
    assert points["wboit"].row["stop_reason"] == "error above measure.max_error (0.0001)"
    left = [p for name, p in points.items() if name not in ("floor", "wboit", "peel-f2b")]
    assert any(not p.row["stop_reason"].startswith("eliminated") for p in left)
    assert points["floor"].row["samples"] >= 6


def test_an_order_of_its_own_of_equal_depths_is_no_error_and_a_lost_fragment_is_one(raced):
    """kb-ps has another order than that of submission; peeling loses one of two fragments of a depth."""
    points = raced(", max_error: 0.0001", scene=", depth_copies: 2, copies: different", status=3)
    row = points["kb-ps"].row
    assert row["order_error"] > 0.01 and row["max_error_all"] <= 1e-4 and row["wrong_pixels_all"] == 0
    assert not row["stop_reason"].startswith("error above")
    assert points["peel-f2b"].row["max_error_all"] > 0.01


def test_without_a_bound_nothing_leaves_to_what_is_less_exact(raced):
    points = raced()
    exact = [name for name, p in points.items() if p.row["stop_reason"].startswith("eliminated")]
    assert all(catalog()[points[name].method].guarantee.startswith("exact") for name in exact)
    assert not any("WBOIT" in points[name].row["stop_reason"] for name in exact)


def test_a_method_that_breaks_costs_itself_alone(raced, plant):
    plant("methods/array/store.frag", "void main() {", "void main() { oops;")
    points = raced(", max_error: 0.0001", status=1)
    assert points["ab-array"].status == "crashed"
    assert points["kplus-array"].status == "ok"


def test_where_the_time_is_up_there_is_one_round_and_no_passes(monkeypatch, raced):
    monkeypatch.setattr(measuring, "_deadlines", lambda *_: (math.inf, -math.inf))
    points = raced(", max_error: 0.0001")
    for name in ("ab-array", "peel-f2b", "kplus-array"):
        row = points[name].row
        assert (points[name].status, row["stop_reason"], row["samples"]) == ("ok", "time limit", 1)
        assert row["max_abs_error"] <= 1e-4 and not points[name].passes_ms
    racing = [points[name].cell for name in ("ab-array", "peel-f2b", "kplus-array")]
    assert sum(len(cell["warmup_ms"]) for cell in racing) == 1  # it told that there is no time for more
