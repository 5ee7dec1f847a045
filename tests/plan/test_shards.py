"""Shares of a run: every cell in one of them, a scene never in two, and none with much more to do than it must."""

from __future__ import annotations

import pytest

from mfr_bench.config import load
from mfr_bench.methods import catalog
from mfr_bench.plan import expand
from mfr_bench.plan.forecast import Forecast, Rates
from mfr_bench.plan.shards import cell_s, shard


@pytest.fixture(scope="module")
def plans():
    named = (("kplus2015-fig6", "smoke"), ("gpupro5-fig5", "smoke"), ("smoke", None))
    experiments = [e for name, profile in named for e in load(name, catalog(), profile, ())]
    return [(e, expand(e, catalog(), None)) for e in experiments]


@pytest.mark.parametrize("count", [1, 2, 3, 7])
def test_every_cell_falls_to_one_share_with_its_scene(plans, count):
    shares = [shard(plans, number, count) for number in range(1, count + 1)]
    for position, (_, cells) in enumerate(plans):
        found = [cell for share in shares for cell in share[position][1]]
        assert len(found) == len(cells) and {id(cell) for cell in found} == {id(cell) for cell in cells}
    scenes = [{cell.scene for _, cells in share for cell in cells} for share in shares]
    assert sum(map(len, scenes)) == len(set().union(*scenes))


def test_no_share_has_more_than_it_must(plans):
    forecast = Forecast((), Rates())

    def spent(share):
        return sum(cell_s(forecast, cell) for _, cells in share for cell in cells)

    loads = [spent(shard(plans, number, 4)) for number in range(1, 5)]
    scenes = {}
    for _, cells in plans:
        for cell in cells:
            scenes[cell.scene] = scenes.get(cell.scene, 0.0) + cell_s(forecast, cell)
    assert max(loads) <= sum(loads) / 4 + max(scenes.values())


def test_shares_are_the_same_on_every_machine(plans):
    first, again = (shard(plans, 2, 3) for _ in range(2))
    assert first == again
