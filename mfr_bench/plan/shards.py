"""Shares of a run for several machines: whole scenes, so that what a figure compares is measured in turns on one."""

from __future__ import annotations

from collections.abc import Sequence

from ..config.model import Experiment
from ..scene import Scene
from .cells import Cell
from .expected import expected_stats
from .forecast import Forecast, Rates, frames_s

MOST_SHARES = 10_000
Plans = list[tuple[Experiment, list[Cell]]]


def shard(plans: Plans, number: int, count: int) -> Plans:
    """The share `number`, from 1, of `count`: each scene of all experiments falls to one share, whatever the device is.

    Scenes go to the share that has least to do, the longest first, by a forecast that knows no device: every machine
    that is asked finds the same shares. An experiment without cells in the share stays, empty.
    """
    forecast = Forecast((), Rates())
    seconds: dict[Scene, float] = {}
    for _, cells in plans:
        for cell in cells:
            seconds[cell.scene] = seconds.get(cell.scene, 0.0) + cell_s(forecast, cell)
    mine = _shares(seconds, count)[number - 1]
    return [(experiment, [cell for cell in cells if cell.scene in mine]) for experiment, cells in plans]


def cell_s(forecast: Forecast, cell: Cell) -> float:
    """Seconds that a forecast gives a cell, with what surrounds its frames."""
    stats = expected_stats(cell.scene)
    return frames_s(forecast.frame(cell, stats), cell.measure) + forecast.rates.around_s(stats)


def _shares(seconds: dict[Scene, float], count: int) -> Sequence[set[Scene]]:
    shares: list[set[Scene]] = [set() for _ in range(count)]
    loads = [0.0] * count
    for scene, spent in sorted(seconds.items(), key=lambda item: -item[1]):  # equal ones in the order of the plans
        least = loads.index(min(loads))
        shares[least].add(scene)
        loads[least] += spent
    return shares
