"""Time budgets: what is measured first, and when measuring has to stop."""

from dataclasses import replace
from types import SimpleNamespace

import pytest

from mfr_bench.cli.interruption import Interruption
from mfr_bench.cli.session import Choices, Session
from mfr_bench.config.model import Measure, Scene
from mfr_bench.methods import catalog
from mfr_bench.plan import Cell
from mfr_bench.plan.budget import PARTS, TimeBudget, bisection, coarseness
from mfr_bench.plan.ending import SAFE, ending_s, measurable, reports_s
from mfr_bench.run.jobs import jobs
from mfr_bench.run.ledger import Ledger
from mfr_bench.run.sheet import Sheet
from mfr_bench.store import ResultFolder

from ..run.fake_worker import DEVICE


def cell(n, method="ab-array", **point):
    return Cell("test", method, method, catalog()[method].complete({}), Scene(size=(8, 8), depth_complexity=n),
                Measure(), point)


@pytest.mark.parametrize(("count", "depths"), [
    (0, []), (1, [0]), (2, [0, 0]), (3, [0, 1, 0]), (5, [0, 2, 1, 2, 0]), (9, [0, 3, 2, 3, 1, 3, 2, 3, 0])])
def test_the_ends_come_first_then_the_middles_of_what_is_left(count, depths):
    assert bisection(count) == depths


def test_a_point_is_as_fine_as_the_finest_of_its_places():
    cells = [cell(n, k=k, **{"scene.depth_complexity": n}) for n in (1, 2, 3) for k in (4, 8, 16)]
    assert coarseness(cells) == [0, 1, 0, 1, 1, 1, 0, 1, 0]
    assert coarseness([cell(4)]) == [0]  # the floor has no place on an axis of k
    assert coarseness([cell(4, size=[8, 8]), cell(5, size=[16, 16])]) == [0, 0]  # values that lists hold


def test_every_method_gets_its_coarse_points_before_any_gets_finer_ones(tmp_path):
    cells = [cell(n, method, **{"scene.depth_complexity": n}) for n in (1, 2, 3, 4, 5)
             for method in ("floor", "ab-array", "kplus-array")]
    ledger = Ledger([Sheet(ResultFolder(tmp_path), jobs(cells, catalog(), DEVICE, "wall"))], DEVICE)
    plain, coarse = ledger.groups(), ledger.groups(coarse_first=True)
    assert [group[0].cell.scene.depth_complexity for group in plain] == [1, 2, 3, 4, 5]
    assert [group[0].cell.scene.depth_complexity for group in coarse] == [1, 5, 3, 2, 4]
    assert all(len(group) == 3 for group in coarse)
    assert sorted(job.key for group in plain for job in group) == sorted(job.key for group in coarse for job in group)


def of_three(tmp_path, measure):
    """Three experiments, each with its ends and its middle, of ten methods; the first has the smallest scenes."""
    methods = [method for method in catalog() if catalog()[method].param("k") is None][:10]
    found = []
    for number, layers in enumerate(((1, 2, 3), (4, 6, 8), (16, 24, 32))):
        cells = [replace(cell(n, method, **{"scene.depth_complexity": n}), measure=measure) for n in layers
                 for method in methods]
        found.append(Sheet(ResultFolder(tmp_path / str(number)), jobs(cells, catalog(), DEVICE, "wall")))
    return Ledger(found, DEVICE)


def test_every_experiment_has_its_turn_before_any_has_its_next(tmp_path):
    """Ordered by their size alone, the scenes of one stressor took all of a budget that fourteen were given."""
    order = [group[0].cell.scene.depth_complexity for group in of_three(tmp_path, Measure()).groups(coarse_first=True)]
    assert order == [1, 4, 16, 3, 8, 32, 2, 6, 24]


def test_every_experiment_has_some_methods_before_any_has_all_where_one_sample_is_taken(tmp_path):
    ledger = of_three(tmp_path, Measure(min_samples=1, max_samples=1))
    groups = ledger.groups(coarse_first=True)
    found = [(group[0].cell.scene.depth_complexity, len(group)) for group in groups]
    first, second = PARTS
    assert found[:12] == [(n, count) for count in (first, 10 - first) for n in (1, 4, 16, 3, 8, 32)]
    assert first < 10 < first + second
    assert sorted(job.key for group in groups for job in group) == sorted(
        job.key for group in ledger.groups() for job in group)
    assert [len(group) for group in ledger.groups()] == [10] * 9  # without a budget no scene is made twice


@pytest.mark.parametrize(("seconds", "end_s", "deadline"), [
    (480, 4.0, 100 + 480 - 8.0),
    (10, 20.0, 100 + 5),  # never more than half is set aside
    (float("inf"), 4.0, float("inf")),
])
def test_reports_are_in_time(seconds, end_s, deadline):
    assert TimeBudget(seconds, 100.0).deadline(end_s) == pytest.approx(deadline)


@pytest.mark.parametrize(("processes", "experiments", "figures", "cells", "took_s"), [
    (1, 1, 2, 126, 0.23), (1, 1, 4, 150, 1.13), (1, 1, 4, 111, 1.23), (1, 1, 5, 87, 1.04), (1, 1, 2, 230, 0.92),
    (1, 1, 1, 3, 0.07), (1, 1, 2, 8, 1.07),  # the last with images of the scene, the slowest of all figures
    (1, 49, 91, 2495, 15.4), (2, 14, 16, 54, 2.2),  # all of the papers; the stressors, on two cores
])
def test_what_is_set_aside_is_what_reports_take_and_not_many_times_that(processes, experiments, figures, cells, took_s):
    """Seven times that was set aside, and half of a budget of 40 s left unused."""
    foretold_s = reports_s(experiments, figures, cells, processes)
    assert took_s <= SAFE * foretold_s <= 3 * took_s + 1.5


@pytest.mark.parametrize(("cells", "seconds", "slowness", "most"), [
    (2699, 30.0, 1.0, 300), (2699, 30.0, 3.0, 100), (40, 30.0, 1.0, 40), (0, 30.0, 1.0, 0)])
def test_no_more_cells_are_counted_than_can_be_measured(cells, seconds, slowness, most):
    assert measurable(cells, seconds, slowness) == most
    aside_s = SAFE * (ending_s(reports_s(1, 0, most), 0.0, slowness) - ending_s(reports_s(1, 0, 0), 0.0, slowness))
    assert aside_s <= seconds / 8 + 0.01  # so that cells take no more than an eighth of any budget


@pytest.mark.parametrize(("budget_s", "told", "empty", "rows"), [
    (0.2, 2, 1, 2),  # of the experiments whose turns come first
    (1.0, 3, 0, 10), (3600.0, 3, 0, 30)])
def test_the_end_is_foretold_by_the_cells_that_can_be_measured(tmp_path, monkeypatch, budget_s, told, empty, rows):
    scenes = [[Scene(size=(8, 8), depth_complexity=n, seed=seed) for seed in range(10)] for n in (1, 2, 3)]
    sheets = [Sheet(ResultFolder(tmp_path / str(n)), jobs([replace(cell(n), scene=scene) for scene in found], catalog(),
                                                          DEVICE, "wall")) for n, found in enumerate(scenes)]
    parts = [SimpleNamespace(sheet=sheet, experiment=SimpleNamespace(figures=[1, 2])) for sheet in sheets]
    session = Session(SimpleNamespace(ready=lambda: SimpleNamespace(calibrated_s=0.0)), Interruption(),
                      Choices(None, False, False, False, budget_s=budget_s), 0.0)
    session.slowness, asked = 1.0, []
    monkeypatch.setattr("mfr_bench.plan.ending.reports_s", lambda *given, empty: asked.append((*given, empty)) or 0.0)
    session._deadlines(Ledger(sheets, DEVICE).groups(coarse_first=True), parts)
    assert asked == [(told, 2 * told, rows, 1, empty)]
