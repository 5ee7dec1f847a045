"""Shares of a run: every cell in one of them, a scene never in two, and none with much more to do than it must."""

from __future__ import annotations

import pytest

from mfr_bench.config import load
from mfr_bench.methods import catalog
from mfr_bench.plan import expand
from mfr_bench.plan.forecast import Forecast, Rates
from mfr_bench.plan.shards import cell_s, shards, split_lines, units_of


@pytest.fixture(scope="module")
def plans():
    named = (("kplus2015-fig6", "smoke"), ("gpupro5-fig5", "smoke"), ("smoke", None))
    experiments = [e for name, profile in named for e in load(name, catalog(), profile, ())]
    return [(e, expand(e, catalog(), None)) for e in experiments]


@pytest.mark.parametrize("count", [1, 2, 3, 7])
def test_every_cell_falls_to_one_share_with_its_scene(plans, count):
    shares = shards(plans, units_of(plans), count)
    for position, (_, cells) in enumerate(plans):
        found = [cell for share in shares for cell in share[position][1]]
        assert len(found) == len(cells) and {id(cell) for cell in found} == {id(cell) for cell in cells}
    scenes = [{cell.scene for _, cells in share for cell in cells} for share in shares]
    assert sum(map(len, scenes)) == len(set().union(*scenes))


def test_no_share_has_more_than_it_must(plans):
    forecast = Forecast((), Rates())

    def spent(share):
        return sum(cell_s(forecast, cell) for _, cells in share for cell in cells)

    loads = list(map(spent, shards(plans, units_of(plans), 4)))
    scenes = {}
    for _, cells in plans:
        for cell in cells:
            scenes[cell.scene] = scenes.get(cell.scene, 0.0) + cell_s(forecast, cell)
    assert max(loads) <= sum(loads) / 4 + max(scenes.values())


def test_shares_are_the_same_on_every_machine(plans):
    first, again = (shards(plans, units_of(plans), 3) for _ in range(2))
    assert first == again


@pytest.mark.parametrize("most_s", [0.5, 3.0, 1e9])
def test_a_scene_that_takes_too_long_is_split_by_methods(plans, most_s):
    units = units_of(plans, most_s)
    shares = shards(plans, units_of(plans, most_s), 3)
    for position, (_, cells) in enumerate(plans):
        found = [id(cell) for share in shares for cell in share[position][1]]
        assert sorted(found) == sorted(map(id, cells))
    alone = {unit: {cell.method for _, cells in plans for cell in cells if units.of(cell) == unit} for unit in
             units.seconds}
    for (scene, number), seconds in units.seconds.items():
        whole = sum(spent for (other, _), spent in units.seconds.items() if other == scene)
        if whole <= most_s:
            assert number == 0 and (scene, 1) not in units.seconds  # what fits draws in turns, all of it
        assert seconds <= most_s or len(alone[scene, number]) == 1
    together = {}
    for unit, methods in alone.items():
        for method in methods:
            together.setdefault((unit[0], method), []).append(unit)
    for (scene, method), where in together.items():
        spent = sum(cell_s(Forecast((), Rates()), cell) for _, cells in plans for cell in cells
                    if (cell.scene, cell.method) == (scene, method))
        assert len(where) == 1 or spent > most_s
    assert bool(units.splits) == (most_s < 1e9) and len(split_lines(units.splits)) == len(units.splits)


def test_without_a_limit_no_scene_is_split(plans):
    assert not units_of(plans).splits and shards(plans, units_of(plans), 2) == shards(plans, units_of(plans, 1e9), 2)
