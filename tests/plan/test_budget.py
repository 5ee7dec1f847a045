"""Time budgets: what is measured first, and when measuring has to stop."""

import pytest

from mfr_bench.config.model import Measure, Scene
from mfr_bench.methods import catalog
from mfr_bench.plan import Cell
from mfr_bench.plan.budget import TimeBudget, bisection, coarseness
from mfr_bench.plan.ending import SAFE, ending_s, reports_s
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


@pytest.mark.parametrize(("seconds", "end_s", "deadline"), [
    (480, 4.0, 100 + 480 - 10.0),
    (10, 20.0, 100 + 5),  # never more than half is set aside
    (float("inf"), 4.0, float("inf")),
])
def test_reports_are_in_time(seconds, end_s, deadline):
    assert TimeBudget(seconds, 100.0).deadline(end_s) == pytest.approx(deadline)


@pytest.mark.parametrize(("calibrated_s", "slowness", "experiments", "figures", "cells", "least_s"), [
    (0.7, 1.0, 1, 3, 40, 1.5 + 2.0 + 40 * 0.03),
    (0.7, 1.0, 2, 6, 40, 1.5 + 2 * 2.0 + 40 * 0.03),
    (2.8, 4.0, 2, 6, 40, 6.0 + 4 * (2 * 2.0 + 40 * 0.03)),  # a machine that is four times as slow
])
def test_what_is_set_aside_is_no_less_than_reports_took_before_they_were_timed(calibrated_s, slowness, experiments,
                                                                               figures, cells, least_s):
    end_s = ending_s(reports_s(experiments, figures, cells), calibrated_s, slowness)
    assert SAFE * end_s >= least_s
